"""How a key of the run file is declared: all that is known of it in one place.

The words of errors, the tables of docs/run_file.md, the labels of figures, the docstrings of the sections and the JSON
schema follow from it.
"""

from __future__ import annotations

import ast
import inspect
import json
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic.fields import FieldInfo

from warpgran.case.problems import CaseError, Problem

LEAST, MOST = 1e-30, 1e30
"""Smallest and largest size of a number in a run file, unless it is 0, whatever its unit."""
MM = ("mm", 1e3)
MM_PER_S = ("mm/s", 1e3)

_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def declare(
    default: Any,
    name: str,
    symbol: str = "",
    *,
    unit: str = "",
    display: tuple[str, float] | None = None,
    allowed: str = "",
    unset: str = "",
    order: int | None = None,
    **options: Any,
) -> Any:
    """A key of the run file as a field of its section, with a docstring below it that says what it means.

    Args:
        default: Its default; None for one that is no value.
        name: What figures call it.
        symbol: LaTeX, "" for none.
        unit: Unit in the run file, "" for none.
        display: Unit in figures and the factor to it, if not that of the run file.
        allowed: What is allowed, if the type and the bounds gt, ge, lt and le do not say it all.
        unset: What a default of None stands for, in Markdown.
        order: The order of the scheme that has it, None for both.
        options: The bounds, and what else pydantic's Field takes.
    """
    display_unit, factor = display or (unit, 1.0)
    extra: dict[str, Any] = {"symbol": symbol, "unit": unit, "display_unit": display_unit, "display_factor": factor}
    extra |= {word: text for word, text in (("allowed", allowed), ("unset", unset), ("order", order)) if text}
    return Field(default, title=name, json_schema_extra=extra, **options)


@dataclass(frozen=True)
class KeyInfo:
    """What is known of a key: what `declare` was given, and what follows from its type.

    Attributes:
        kind: float, int, bool or str; None for a table or a list.
        allowed: In words and without the unit; "" for any text, and for true or false.
        factor: From `unit` to `display_unit`.
        section: Where it is declared.
        attribute: Its name there.
    """

    default: Any
    unset: str
    kind: type | None
    allowed: str
    name: str
    symbol: str
    unit: str
    display_unit: str
    factor: float
    order: int | None
    section: type[Model]
    attribute: str

    @classmethod
    def of(cls, section: type[Model], attribute: str) -> KeyInfo:
        """The key that an attribute of a section is."""
        field = section.model_fields[attribute]
        extra: Any = field.json_schema_extra
        return cls(
            default=None if field.is_required() else field.default,
            unset=extra.get("unset", ""),
            kind=_kind(field.annotation),
            allowed=extra.get("allowed") or _allowed(field),
            name=field.title or "",
            symbol=extra["symbol"],
            unit=extra["unit"],
            display_unit=extra["display_unit"],
            factor=extra["display_factor"],
            order=extra.get("order"),
            section=section,
            attribute=attribute,
        )

    @property
    def meaning(self) -> str:
        """In Markdown."""
        return " ".join(meanings(self.section).get(self.attribute, "").split())

    @property
    def hint(self) -> str:
        """What is allowed, with the unit, as errors say it."""
        return f"{self.allowed}, in {self.unit}" if self.unit else self.allowed

    @property
    def limits(self) -> str:
        """What is allowed and what a default of None stands for, as sentences after the meaning; the type has words."""
        allowed = f" Allowed: {self.hint}." if self.hint and self.kind is not str else ""
        return f"{allowed} Default: {self.unset}." if self.unset else allowed


def _allowed(field: FieldInfo) -> str:
    """`> 0 and < 1` of bounds, `"f0", "f1" or "f2"` of a choice."""
    if get_origin(field.annotation) is Literal:
        *words, last = (json.dumps(word) for word in get_args(field.annotation))
        return f"{', '.join(words)} or {last}"
    bounds = [(sign, getattr(entry, name, None)) for entry in field.metadata for name, sign in _SIGNS.items()]
    return " and ".join(f"{sign} {value}" for sign, value in bounds if value is not None)


def _kind(annotation: Any) -> type | None:
    if get_origin(annotation) is Literal:
        return type(get_args(annotation)[0])
    while get_origin(annotation) in (Annotated, Union, UnionType):
        annotation = get_args(annotation)[0]
    return annotation if annotation in (float, int, bool, str) else None


@cache
def meanings(section: type[Model]) -> dict[str, str]:
    """The docstring below each key, read from the source when it is asked for: a run needs none."""
    try:
        source = textwrap.dedent(inspect.getsource(section))
    except (OSError, TypeError):  # made without a source
        return {}
    (body,) = (node.body for node in ast.parse(source).body if isinstance(node, ast.ClassDef))
    return {
        key.target.id: inspect.cleandoc(text.value.value)
        for key, text in pairwise(body)
        if isinstance(key, ast.AnnAssign) and isinstance(key.target, ast.Name)
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant) and isinstance(text.value.value, str)
    }


def _describe(schema: dict[str, Any], model: type[Model]) -> None:
    """The first paragraph of the docstring in a JSON schema, where each key has its own description."""
    schema["description"] = (model.__doc__ or "").partition("\n\n")[0]
    for name, meaning in meanings(model).items():
        schema["properties"][model.keys()[name]]["description"] = meaning


if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)


class _Concise(ModelMetaclass):
    """Shows, in `help` and where names are completed, what is ours, not what pydantic needs."""

    @property
    def __doc__(cls: type[Model]) -> str:  # type: ignore[override, misc]
        """The docstring with the keys added, and to that of a case its sections by their first lines."""
        lines = [inspect.cleandoc(vars(cls).get("__doc__") or ""), "", "Attributes:"]
        for name, field in cls.model_fields.items():
            meaning = meanings(cls).get(name) or (field.annotation.__doc__ or "").partition("\n")[0]
            limits = KeyInfo.of(cls, name).limits if field.json_schema_extra else ""
            lines.append(f"    {name}: {' '.join(meaning.split())}{limits}")
        return "\n".join(lines)

    def __dir__(cls) -> list[str]:
        ours = [base for base in cls.__mro__ if base.__module__.startswith("warpgran.")]
        return sorted({name for base in ours for name in vars(base) if not name.startswith(("_", "model_"))})


class Model(BaseModel, metaclass=_Concise):
    """Values by key: frozen, without unknown keys, numbers finite and only of numbers."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        allow_inf_nan=False,
        hide_input_in_errors=True,
        json_schema_extra=_describe,
    )

    @model_validator(mode="before")
    @classmethod
    def _numpy_values(cls, data: Any) -> Any:
        """NumPy's numbers and arrays as Python's, which are all that strict numbers take."""
        if not isinstance(data, Mapping):
            return data
        return {k: v.tolist() if isinstance(v, np.generic | np.ndarray) else v for k, v in data.items()}

    @model_validator(mode="after")
    def _sizes(self) -> Model:
        """Numbers whose products and quotients leave the range of floating point are no quantity in SI units."""
        wrong = []
        for name, held in self.__dict__.items():
            for value in held if isinstance(held, tuple) else (held,):
                if isinstance(value, float) and value and not LEAST <= abs(value) <= MOST:
                    message = f"{value} is out of range; allowed: 0, or a size from {LEAST:g} to {MOST:g}"
                    wrong.append(Problem(self.keys()[name], message))
        if wrong:
            raise CaseError(wrong)
        return self

    def __repr_args__(self) -> Any:
        """What differs from the defaults."""
        values = [(name, getattr(self, name), field.default) for name, field in type(self).model_fields.items()]
        return [(name, value) for name, value, default in values if value != default]

    def __dir__(self) -> list[str]:
        return sorted({*dir(type(self)), *type(self).model_fields})

    @classmethod
    def keys(cls) -> dict[str, str]:
        """Every key of the run file by the attribute that holds it."""
        return {name: field.alias or name for name, field in cls.model_fields.items()}

    @classmethod
    def described(cls) -> dict[str, KeyInfo]:
        """What is known of every key of this section."""
        return {key: KeyInfo.of(cls, name) for name, key in cls.keys().items()}
