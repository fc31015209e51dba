"""A run file to start from, made of what the keys say of themselves."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

from warpgran.case.case import Case
from warpgran.case.model import KeyInfo
from warpgran.case.sections import KEYS, SECTIONS
from warpgran.case.toml import plain, toml_value

WIDTH = 100
FIRST = (
    "rheology.grain_diameter", "slope.angle", "column.height", "column.length", "column.phi", "grid.left", "grid.right",
    "grid.cells", "time.end",
)  # fmt: skip
"""What a first run of one's own changes."""
OPENING = """\
# A run of warpgran. Each key stands here with its default, and all others have theirs: `warpgran new --full` lists
# them, docs/run_file.md explains them. Check this file by `warpgran check {name}`, compute it by `warpgran run {name}`.
# With the JSON schema of `warpgran schema > run_file.schema.json` an editor completes and checks it: the line
# `#:schema run_file.schema.json` at the top tells Tombi and Even Better TOML where it is.
"""


def starter(name: str, *, full: bool = False) -> str:
    """A commented run file, which runs as it is.

    Args:
        name: Name of the file.
        full: Every key, not only those that one changes first. Those that the default scheme does not have, and those
            whose default is no value, are commented out.
    """
    lines = [OPENING.format(name=name), f"title = {toml_value(name.removesuffix('.toml'))}"]
    for section, model in SECTIONS.items():
        keys = [f"{section}.{key}" for key in model.described() if full or f"{section}.{key}" in FIRST]
        if keys:
            summary = (model.__doc__ or "").partition("\n")[0]
            lines += ["", f"[{section}]", *_comment(summary)]
            lines += [line for key in keys for line in _key(key, KEYS[key])]
    return "\n".join(lines) + "\n"


def _key(key: str, known: KeyInfo) -> Iterator[str]:
    """A key and a comment that says what it means; the comment alone where the key has no value to show."""
    name = key.partition(".")[2]
    other = known.order not in (None, Case().scheme.order)
    order = f" With `order = {known.order}` alone." if known.order is not None else ""
    allowed = f" Allowed: {known.hint}." if known.hint else ""
    unset = f" Default: {known.unset}." if known.unset else ""
    yield ""
    yield from _comment(known.meaning + order + allowed + unset)
    value = "" if known.default is None else toml_value(plain(known.default))
    yield f"{'# ' if other or known.default is None else ''}{name} = {value}".rstrip()


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent="# ", subsequent_indent="# ", break_long_words=False)
