"""The tables of keys in docs/run_file.md: `python -m warpgran.case.key_tables docs/run_file.md` writes them anew."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from pathlib import Path

from warpgran.case.all_sections import ALL_SECTIONS
from warpgran.case.case import Case
from warpgran.case.distributions import Distribution
from warpgran.case.model import KeyInfo
from warpgran.case.toml import plain, toml_value


def with_tables(page: str) -> str:
    """The page with the table of keys under each of its headings made anew.

    Raises:
        ValueError: A heading or its table is missing.
    """
    sections = {f"`[{name}]`": model.described() for name, model in ALL_SECTIONS.items()}
    sections |= {
        "Top level": {"title": KeyInfo.of(Case, "title")},
        "Distributions": Distribution.described(),
    }
    for heading, keys in sections.items():
        before, mark, rest = page.partition(f"\n## {heading}\n")
        section, end, after = rest.partition("\n## ")
        tables = re.findall(r"(?m)^\| Key \|.*(?:\n\|.*)*", section)
        if len(tables) != 1:
            raise ValueError(f"the page has {len(tables)} tables of keys under the heading {heading}")
        section = section.replace(tables[0], _table(keys))
        page = before + mark + section + end + after
    return page


def _table(keys: Mapping[str, KeyInfo]) -> str:
    rows = [
        f"| `{name}` | {_default(key)} | {key.allowed or _OF_KIND[key.kind]} | {key.unit} | {_meaning(key)} |"
        for name, key in keys.items()
    ]
    rows = [row.replace("|  |", "| |") for row in rows]
    return "\n".join(["| Key | Default | Allowed | Unit | Meaning |", "|---|---|---|---|---|", *rows])


_OF_KIND: dict[type | None, str] = {str: "any text", bool: "true or false"}


def _default(key: KeyInfo) -> str:
    return key.unset if key.default is None else f"`{toml_value(plain(key.default))}`"


def _meaning(key: KeyInfo) -> str:
    return key.meaning if key.order is None else f"{key.meaning} With `order = {key.order}` alone."


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.write_text(with_tables(path.read_text(encoding="utf-8")), encoding="utf-8")
