"""What `repr` and a notebook show of a case and of a study: what differs from the defaults."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from warpgran.case.sections import KEYS
from warpgran.case.toml import toml_value

if TYPE_CHECKING:
    from warpgran.case.case import Case
    from warpgran.case.study import Study

LONGEST = 60
"""Characters of a value; longer ones, such as tables, are cut."""


def case_text(case: Case) -> str:
    """`<Case 'Dense column': slope.angle = 22.0, column.phi = 0.62>`."""
    title = f" {case.title!r}" if case.title else ""
    values = ", ".join(f"{key} = {value}" for key, value, _ in _differences(case))
    return f"<Case{title}{f': {values}' if values else ', all defaults'}>"


def case_table(case: Case) -> str:
    """HTML: a row a key that is not at its default."""
    rows = [(key, value, _unit(key), default) for key, value, default in _differences(case)]
    heading = f"Case {case.title}".rstrip()
    if not rows:
        return f"<b>{escape(heading)}</b>: all defaults"
    return _table(heading, ("key", "value", "unit", "default"), rows)


def study_table(study: Study) -> str:
    """HTML: a row a swept key, then those that all runs share and that are not at their default."""
    title = f" {study.base.title}" if study.base.title else ""
    rows = [(key, _span(study.values(key)), _unit(key), "varies") for key in study.keys]
    for key, value, _ in [] if study.given else _differences(study.base):  # given cases may differ in any key
        if key not in study.keys:
            rows.append((key, value, _unit(key), "all runs"))
    runs = "1 run" if len(study) == 1 else f"{len(study)} runs"
    return _table(f"Study{title}, {runs}", ("key", "value", "unit", ""), rows)


def _differences(case: Case) -> list[tuple[str, str, str]]:
    """Keys whose value is neither the default nor follows from others by default: key, value, default."""
    ours, usual, follow = case.flat(), type(case)().flat(), set(case.following)
    return [
        (key, _shown(ours[key]), _shown(usual[key]))
        for key in KEYS
        if ours[key] is not None and ours[key] != usual[key] and key not in follow
    ]


def _shown(value: Any) -> str:
    text = "none" if value is None else toml_value(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]} ..."


def _unit(key: str) -> str:
    return KEYS[key].unit


def _span(values: Sequence[Any]) -> str:
    """`0 to 22, 4 values`, or a few words."""
    different = list(dict.fromkeys(values))
    if len(different) <= 6:
        return ", ".join(_shown(value) for value in different)
    if isinstance(different[0], str | bool):
        return f"{len(different)} values"
    return f"{min(different):.6g} to {max(different):.6g}, {len(different)} values"


def _table(heading: str, columns: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    body = "".join(f"<tr>{_cells('td', row)}</tr>" for row in rows)
    return (
        f"<b>{escape(heading)}</b><table><thead><tr>{_cells('th', columns)}</tr></thead><tbody>{body}</tbody></table>"
    )


def _cells(kind: str, texts: Iterable[str]) -> str:
    return "".join(f"<{kind} style='text-align: left'>{escape(text)}</{kind}>" for text in texts)
