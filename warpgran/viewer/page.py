"""One HTML page to look at results in a browser: offline, everything in the file, of a size that is asked for."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import xarray as xr

from warpgran.analysis.fields import parameter
from warpgran.analysis.units import Lengths
from warpgran.errors import OptionError, ResultError
from warpgran.figures.one_run import POSITION
from warpgran.figures.one_run import PROFILES as PROFILE_PANELS
from warpgran.figures.one_run import SERIES as SERIES_PANELS
from warpgran.figures.style import COLOURS, Panel, checked
from warpgran.files import MARK, replacing
from warpgran.printable import printable
from warpgran.viewer.profiles import packed_runs, runs_at_once
from warpgran.viewer.sixteen_bits import Packing
from warpgran.viewer.table import table
from warpgran.viewer.words import pieces

SCRIPTS = ("unpack.js", "chart.js", "flow.js", "batch.js", "viewer.js")
"""Parts of the script, in their order."""
MAX_SIZE = 20e6
"""Bytes of a page, at most."""
MOST_ROWS = 10_000
"""Runs in the table, at most."""
CELLS = (2000, 1000, 500, 250)
"""Most cells of a profile: the first of these with which all runs fit, or the last."""
TAG = 80
"""Bytes of the page around the profiles of a run."""
FOR_UNITS = 200
"""Runs that choose the units of lengths, at most."""
SPEED = Panel("v_flow", "max. speed $|v|$", "m/s", reference="time.rest_speed")
MORE_PROFILES = (Panel("mu", r"friction $\mu$", "-"), Panel("I", "inertial number $I$", "-"))
MORE_SERIES = (
    Panel("front_speed", r"front speed $\dot{x}_\mathrm{f}$", "m/s"),
    Panel("v_max", "max. speed, in films too", "m/s"),
    Panel("mass", "solid volume per width", "m²"),
    Panel("energy", r"energy per width and density", "m⁴/s²"),
    Panel("outflow", "solid that has left", "%", factor=100.0, span=0.1),
)
LOGARITHMIC = {"I", "v_flow", "front_speed", "v_max"}
"""Panels whose axis is logarithmic, unless the reader says otherwise."""
TAILS = {"phi", "psi", "mu", "I"}
"""Profiles that a thin front takes far from all others: their axes hold 99 % of their values."""


@dataclass
class View:
    """What goes into a page, and what is known of it when it is written.

    Attributes:
        results: by the name of their file, each with the runs of the table.
        runs: how many runs there are in the files.
        room: Bytes that profiles may take.
        cells: most cells of a profile.
        shown: rows of the table that have profiles.
    """

    results: Mapping[str, xr.Dataset]
    runs: int
    room: float
    cells: int = CELLS[0]
    shown: list[int] = field(default_factory=list)


def view(
    results: xr.Dataset | Mapping[str, xr.Dataset],
    path: str | Path,
    *,
    runs: Sequence[int] | None = None,
    max_size: float = MAX_SIZE,
) -> Path:
    """Write a page to look at results in a browser: profiles over time, series, and the runs of a batch.

    It needs no server and no network. Numbers are stored in 16 bits, each profile and series with its own step. Of
    large results some cells and runs are left out, which the page says.

    Args:
        results: A result, or several by name, as {"a.h5": wg.open_dataset("a.h5")}.
        path: The page to write, .html.
        runs: Numbers of the runs (coordinate `run`) to take from each result; by default all, or as many as fit.
        max_size: Bytes of the page, at most.

    Returns:
        The path of the page.

    Raises:
        OptionError: Another suffix, a run that is in no result, or a size in which not even one run fits.
        ResultError: A selection without the dimension `run`.
        StorageError: The page cannot be written, or a file is there that warpgran did not write.
    """
    path = checked(path, (".html",))
    named = {"": results} if isinstance(results, xr.Dataset) else dict(results)
    chosen = {printable(name): _chosen(data, runs) for name, data in named.items()}
    there = np.concatenate([data["run"].values for data in chosen.values()])
    if absent := [run for run in runs or () if run not in there]:
        raise OptionError(f"runs: {_few(absent)} {'is' if len(absent) == 1 else 'are'} in no result")
    everything = View(
        {name: _spread(data, MOST_ROWS // len(chosen)) for name, data in chosen.items()},
        runs=sum(data.sizes["run"] for data in chosen.values()),
        room=max_size,
    )
    with replacing(path, ours=MARK) as part:
        _write(everything, part, max_size)
    return path


def _chosen(data: xr.Dataset, runs: Sequence[int] | None) -> xr.Dataset:
    """The runs of a result that were asked for."""
    if "run" not in data.dims:
        raise ResultError("a view needs the dimension `run`: select one run with data.isel(run=[0])")
    return data if runs is None else data.isel(run=np.flatnonzero(np.isin(data["run"].values, runs)))


def _few(runs: Sequence[int]) -> str:
    return ", ".join(map(str, runs[:5])) + (", ..." if len(runs) > 5 else "")


def _spread(data: xr.Dataset, most: int) -> xr.Dataset:
    """At most so many runs of a result, evenly spread."""
    size = data.sizes["run"]
    return data if size <= most else data.isel(run=np.linspace(0, size - 1, most).round().astype(int))


def _write(page: View, part: Path, max_size: float) -> None:
    """Write the page piece by piece."""
    lengths = Lengths.of(*(_spread(data, FOR_UNITS).isel(time=slice(0, 1)) for data in page.results.values()))
    runs = Packing(table(page.results, lengths)).text()
    script, style = "".join(map(_asset, SCRIPTS)), _asset("viewer.css")
    head = _head(page, lengths)
    page.room = max_size - len(runs) - len(script.encode()) - len(style.encode()) - len(str(head)) - 20_000
    page.cells = _cells(page)
    stream = _template().stream(
        title=head["title"] or "warpgran",
        script=script,
        style=style,
        script_hash=_hash(script),
        style_hash=_hash(style),
        table=runs,
        profiles=_profiles(page),
        head=lambda: {**head, "shown": len(page.shown), "rows": _rows(page), "runs": page.runs},
    )
    with part.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(stream)
    if not page.shown:
        raise OptionError(f"max-size: {max_size / 1e6:.3g} MB is too small for the profiles of a single run")


def _head(page: View, lengths: Lengths) -> dict[str, Any]:
    """What the page knows of all runs together: titles, labels, units, colours."""
    first = [SPEED if panel.name == "v_flow" else panel for panel in SERIES_PANELS]
    titles = [parameter(data, "title", "").values.ravel()[:1].tolist() for data in page.results.values()]
    return {
        "title": " / ".join(dict.fromkeys(printable(str(text)) for (text,) in titles if text)),
        "files": list(page.results),
        "precision": [str(data.attrs.get("precision", "")) for data in page.results.values()],
        "version": version("warpgran"),
        "colours": COLOURS[:4],
        "position": _panel(POSITION.of(lengths)),
        "profiles": [_panel(panel.of(lengths)) for panel in (*PROFILE_PANELS, *MORE_PROFILES)],
        "series": [_panel(panel.of(lengths)) for panel in (*first, *MORE_SERIES)],
        "first_series": len(SERIES_PANELS),
    }


def _panel(panel: Panel) -> dict[str, Any]:
    reference = panel.reference.rpartition(".")[2] if isinstance(panel.reference, str) else panel.reference
    return {
        "name": panel.name, "label": pieces(panel.words), "unit": panel.unit, "factor": panel.factor,
        "span": panel.span, "reference": reference, "log": panel.name in LOGARITHMIC, "tails": panel.name in TAILS,
    }  # fmt: skip


def _rows(page: View) -> int:
    return sum(data.sizes["run"] for data in page.results.values())


def _cells(page: View) -> int:
    """The most cells with which all runs fit, judged by a few of them."""
    rows = _halving(_rows(page))
    for most in CELLS[:-1]:
        largest = max(len(text) for row in rows[:3] for text in _packed(page, [row], most).values())
        if largest * len(rows) <= page.room:
            return most
    return CELLS[-1]


def _profiles(page: View) -> Iterator[tuple[int, str]]:
    """Rows with their profiles, in such an order that those which fit are evenly spread, wherever it ends."""
    rows = _halving(_rows(page))
    together = min(map(runs_at_once, page.results.values()))
    for first in range(0, len(rows), together):
        block = rows[first : first + together]
        texts = _packed(page, sorted(block), page.cells)
        for row in block:
            page.room -= len(texts[row]) + TAG
            if page.room < 0:
                return
            page.shown.append(row)
            yield row, texts[row]


def _packed(page: View, rows: Sequence[int], most: int) -> dict[int, str]:
    """The profiles of rows of the table, ascending, on at most so many cells."""
    found: dict[int, str] = {}
    first = 0
    for data in page.results.values():
        here = [row for row in rows if first <= row < first + data.sizes["run"]]
        if here:
            places = [row - first for row in here]
            found |= zip(here, packed_runs(data.isel(run=places), here, most), strict=True)
        first += data.sizes["run"]
    return found


def _halving(size: int) -> list[int]:
    """0 to size - 1, the ends first, then always halfway between those before."""
    if size <= 2:
        return list(range(size))
    order, step = [0, size - 1], size - 1
    seen = set(order)
    while len(order) < size:
        step = max(1, (step + 1) // 2)
        new = [place for place in range(0, size, step) if place not in seen]
        seen.update(new)
        order += new
    return order


def _asset(name: str) -> str:
    return files("warpgran.viewer").joinpath(name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """By which the page names its own script and style, so that no other is run."""
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


def _template() -> Any:
    loader = jinja2.PackageLoader("warpgran.viewer", package_path="")
    environment = jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template("page.html")
