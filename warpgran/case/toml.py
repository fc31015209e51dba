"""Run files as text, and the nested dicts of keys that they hold."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from typing import Any

from warpgran.case.model import Model
from warpgran.case.problems import CaseError, Problem, shown, unknown_key
from warpgran.case.sections import ALLOWED, Every
from warpgran.case.tables import Table
from warpgran.files import read_text

VARYING = {"sweep": "sweep", "sensitivity": "design"}
"""Sections that make a file a batch, and what each is called; in their part `over`, dotted keys are single names."""
ASIDE = ("calibration",)
"""Sections that also have a part `over`, but that runs ignore: their own commands read and check them."""


def load(path: str) -> tuple[str, dict[str, Any]]:
    """The text of a run file and its keys.

    Raises:
        CaseError: It cannot be read, or is not TOML.
    """
    try:
        source = read_text(path)
        return source, tomllib.loads(source)
    except UnicodeDecodeError as error:
        message = f"is not UTF-8 text (byte {error.start})"
    except tomllib.TOMLDecodeError as error:
        message = f"is not valid TOML: {error}"
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        message = f"cannot be read: {getattr(error, 'strerror', None) or error}"
    except RecursionError:
        message = "is not valid TOML: nested too deeply"
    raise CaseError([Problem("", message)], path)


def override(data: dict[str, Any], text: str) -> Problem | None:
    """Set a key from `KEY=VALUE`; a value that is not TOML is taken as text."""
    key, equals, raw = text.partition("=")
    if not equals or not key.strip():
        return Problem("", f"override {shown(text)} is not KEY=VALUE")
    try:
        parsed = tomllib.loads(f"value = {raw}")
    except (ValueError, RecursionError):  # ValueError: no TOML, or a whole number of thousands of digits
        parsed = {}
    only_a_value = parsed.keys() == {"value"}  # a line break in the text could bring in more keys
    return set_key(data, key.strip(), parsed["value"] if only_a_value else raw.strip())


def set_key(data: dict[str, Any], key: str, value: Any) -> Problem | None:
    """Set one dotted key of nested dicts; None removes it."""
    *parents, last = _path(key)
    if key not in ALLOWED and not {*parents[:1]} & {*VARYING, *ASIDE}:  # those judge their own keys
        return unknown_key(key, ALLOWED)
    for parent in parents:
        if not isinstance(data.get(parent), dict):
            data[parent] = {}
        data = data[parent]
    if value is None:
        data.pop(last, None)
    else:
        data[last] = as_data(value)
    return None


def value_at(data: Mapping[str, Any], key: str) -> Any:
    """What nested dicts hold at a dotted key, None if nothing."""
    found: Any = data
    for name in _path(key):
        found = found.get(name) if isinstance(found, Mapping) else None
    return found


def _path(key: str) -> list[str]:
    """The nested names of a dotted key. Under `sweep.over` and the like dotted keys are single names."""
    parts = key.split(".")
    if parts[0] not in (*VARYING, *ASIDE) or parts[1:2] != ["over"] or len(parts) == 2:
        return parts
    section, *rest = key.replace('"', "").split(".")[2:]
    return [*parts[:2], ".".join([section, *rest[:1]]), *rest[1:]]


def as_data(value: Any) -> Any:
    """A model as a dict of the keys that were set in it; dicts are copied, so that they can be changed."""
    if isinstance(value, Model):
        return {k: as_data(getattr(value, name)) for name, k in value.keys().items() if name in value.model_fields_set}
    return {str(key): as_data(item) for key, item in value.items()} if isinstance(value, Mapping) else value


def without(data: Mapping[str, Any], keys: set[str]) -> dict[str, Any]:
    """The data without some sections and `section.key`s."""
    return {
        section: {key: item for key, item in value.items() if f"{section}.{key}" not in keys}
        if isinstance(value, dict)
        else value
        for section, value in data.items()
        if section not in keys
    }


def plain(value: Any) -> Any:
    """A value of a model as the numbers, words, lists and dicts that a run file can hold."""
    if isinstance(value, Table):
        return value.plain()
    if isinstance(value, Every):
        return value.model_dump()
    return list(value) if isinstance(value, tuple) else value


def text_of(values: Mapping[str, Any]) -> str:
    """A run file of plain values by dotted key, in the order of their sections; None leaves a key out."""
    lines = []
    section = ""
    for key, value in values.items():
        head, _, name = key.rpartition(".")
        if head != section:
            section = head
            lines += ["", f"[{section}]"]
        if value is not None:
            lines.append(f"{name} = {toml_value(value)}")
    return "\n".join(lines) + "\n"


def toml_value(value: Any) -> str:
    """A plain value in TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):  # JSON's strings are TOML's but for one character
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + " }"
    return repr(value)
