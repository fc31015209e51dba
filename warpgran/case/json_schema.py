"""The JSON schema of run files, by which editors check and complete them, from the declarations of the keys.

`python -m warpgran.case.json_schema` writes the file that ships.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pydantic import create_model

from warpgran.case.all_sections import ALL_SECTIONS
from warpgran.case.case import Case
from warpgran.case.model import KeyInfo, Model
from warpgran.case.sections import KEYS
from warpgran.case.sweep_section import KINDS
from warpgran.case.toml import plain, toml_value

SHIPPED = Path(__file__).with_name("run_file.schema.json")


def json_schema() -> dict[str, Any]:
    """The schema of a run file, draft 2020-12: each key with what it means, its unit, its range and its default."""
    title = (str, Case.model_fields["title"])
    fields: Any = {"title": title} | {name: (model, None) for name, model in ALL_SECTIONS.items()}
    raw = create_model("RunFile", __base__=Model, **fields).model_json_schema()
    properties = {"title": _key(raw["properties"]["title"], KeyInfo.of(Case, "title"))}
    for name, model in ALL_SECTIONS.items():
        section = raw["$defs"].pop(model.__name__)
        described = model.described()
        keys = {key: _key(schema, described[key]) for key, schema in section["properties"].items()}
        required = {"required": section["required"]} if "required" in section else {}
        properties[name] = {
            "description": section["description"],
            "type": "object",
            "properties": keys,
            "additionalProperties": False,
            **required,
        }
    for section in properties.values():
        if "over" in section.get("properties", {}):
            section["properties"]["over"] = _over(section["properties"]["over"], properties)
    definitions = {name: _plainer(definition) for name, definition in raw["$defs"].items()}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Run file of warpgran",
        "description": "Every key is optional.",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "$defs": definitions,
    }


def _key(schema: dict[str, Any], known: KeyInfo) -> dict[str, Any]:
    """The schema of a key, with all that is known of it in the one text that editors show."""
    found: dict[str, Any] = _plainer(schema)
    words = [known.meaning]
    if known.order is not None:
        words.append(f"With `order = {known.order}` alone.")
    if known.hint:
        words.append(f"Allowed: {known.hint}.")
    default = known.unset or ("" if known.default is ... else f"`{toml_value(plain(known.default))}`")
    found["description"] = " ".join([*words, *([f"Default: {default}."] if default else [])])
    return found


_OURS = ("symbol", "display_unit", "display_factor", "allowed", "unset", "order")


def _plainer(schema: Any) -> Any:
    """A schema without what only figures need, and without null, which TOML does not have."""
    if isinstance(schema, list):
        return [_plainer(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    forms = [form for form in schema.get("anyOf", []) if form != {"type": "null"}]
    if len(forms) == 1:
        schema = {name: value for name, value in schema.items() if name != "anyOf"} | forms[0]
    without = {*_OURS, *(name for name, nothing in (("unit", ""), ("default", None)) if schema.get(name, 0) == nothing)}
    return {
        name: {key: _plainer(item) for key, item in value.items()} if name == "properties" else _plainer(value)
        for name, value in schema.items()
        if name == "properties" or name not in without
    }


def _over(over: dict[str, Any], properties: dict[str, Any]) -> dict[str, Any]:
    """What can vary, by key, dotted in quotes or nested; each value of a list must be as good as a single one."""
    forms = over.pop("additionalProperties", True)
    if forms is True:  # a section whose distributions are read apart
        forms = {"$ref": "#/$defs/Distribution"}
    dotted: dict[str, Any] = {}
    nested: dict[str, Any] = {}
    for key in KINDS:
        section, _, name = key.partition(".")
        single = properties[section]["properties"][name]
        values = json.loads(json.dumps(forms))
        for form in values.get("oneOf", []):
            if form.get("type") == "array":
                form["items"] = {word: single[word] for word in single if word not in ("title", "description", "unit")}
        if "oneOf" not in forms and KINDS[key] not in (float, int):
            continue
        values["description"] = f"{KEYS[key].meaning} Allowed: {KEYS[key].hint or 'true or false'}."
        dotted[key] = values
        part = nested.setdefault(section, {"type": "object", "properties": {}, "additionalProperties": False})
        part["properties"][name] = values
    return over | {"properties": dotted | nested, "additionalProperties": False}


def text() -> str:
    """The schema as text."""
    return json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    SHIPPED.write_text(text(), encoding="utf-8")
