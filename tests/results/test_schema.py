"""What the documentation says of the result file is what the schema says."""

from __future__ import annotations

import re

from helpers.places import ROOT

from warpgran.schema import COORDINATES, FIELDS, GRID, PER_RUN, SERIES


def test_the_documentation_lists_every_variable() -> None:
    text = (ROOT / "docs" / "result_file.md").read_text()
    rows = re.findall(r"^\| (\w+) \| ([\w, ]+) \| ([^|]+) \| .+ \|$", text, flags=re.MULTILINE)
    listed = {name: (tuple(dims.split(", ")), unit) for name, dims, unit in rows if name != "dataset"}
    schema = COORDINATES | GRID | FIELDS | SERIES | PER_RUN
    assert listed == {name: (known.dims, known.units) for name, known in schema.items() if name != "cell"}


def test_where_grids_differ_cells_are_numbered_and_each_run_has_its_x_and_bed() -> None:
    assert FIELDS["h"].padded.dims == ("run", "time", "cell")
    assert {name: known.padded.dims for name, known in GRID.items()} == dict.fromkeys(GRID, ("run", "cell"))
    assert all(known.padded == known for known in (SERIES | PER_RUN).values())
