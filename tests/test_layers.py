"""Who may import whom. What judges the kernels shares no code with them, and layers look downward only."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from helpers.places import ROOT
from helpers.rooms import arrows, imported_modules, imports, modules

LEAVES = {"schema", "files", "errors", "arrays", "printable"}
"""Modules of the top, which import no room."""
MAY_IMPORT: dict[str, set[str]] = {
    "errors": set(),
    "printable": set(),
    "arrays": set(),
    "schema": set(),
    "files": {"errors"},
    "kernels": set(),
    "case": {"schema", "files", "errors", "arrays"},
    "physics": {"arrays"},
    "solve": {"case", "physics", "kernels", "schema", "errors", "arrays"},
    "analysis": {"case", "physics", "schema", "files", "errors", "arrays"},
    "results": {"case", "solve", "analysis", "schema", "files", "errors", "arrays"},
    "figures": {"case", "analysis", *LEAVES},
    "run": {"case", "solve", "results", "analysis", *LEAVES},
    "studies": {"run", "figures", "analysis", "results", "case", *LEAVES},
    "calibration": {"run", "solve", "figures", "analysis", "results", "case", *LEAVES},
    "sensitivity_analysis": {"run", "figures", "analysis", "results", "case", *LEAVES},
    "viewer": {"figures", "analysis", "case", *LEAVES},
    "verification": {"run", "figures", "analysis", "results", "solve", "physics", "case", *LEAVES},
    "paper": {"run", "figures", "analysis", "results", "solve", "physics", "case", *LEAVES},
}
"""What each room may import beside itself. The command line may import anything, and nothing imports it."""
ARROWS = arrows()


def test_kernels_import_warp_alone() -> None:
    allowed = {"warp", "warpgran.kernels", "typing", "enum", "functools", "dataclasses"}
    for path in (ROOT / "kernels").rglob("*.py"):
        assert imports(path, typing_too=True) <= allowed, path.name


@pytest.mark.parametrize(
    "judge", ["arrays", "physics/laws", "physics/reference", "physics/second_order", "verification/exact"]
)
def test_what_judges_imports_numpy_alone(judge: str) -> None:
    allowed = {"__future__", "collections", "dataclasses", "typing", "numpy", "warpgran.arrays", "warpgran.physics"}
    assert imports(ROOT / "warpgran" / f"{judge}.py") <= allowed


def test_every_room_has_a_rule() -> None:
    assert ARROWS.keys() == MAY_IMPORT.keys() | {"cli"}


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_rooms_import_what_they_may(room: str) -> None:
    assert ARROWS[room] <= MAY_IMPORT[room]


def test_no_class_name_stands_twice() -> None:
    homes: dict[str, list[str]] = {}
    for path in (ROOT / "warpgran").rglob("*.py"):  # the kernels have the names of the reference
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                homes.setdefault(node.name, []).append(path.relative_to(ROOT).as_posix())
    assert {name: paths for name, paths in homes.items() if len(paths) > 1} == {}


def test_rooms_stand_on_eight_floors_at_most() -> None:
    floor: dict[str, int] = {}
    while left := MAY_IMPORT.keys() - floor.keys():
        ready = {room for room in left if MAY_IMPORT[room] <= floor.keys()}
        assert ready, f"a circle among {sorted(left)}"
        floor |= {room: max((floor[other] + 1 for other in MAY_IMPORT[room]), default=0) for room in ready}
    assert 1 + max(floor.values()) <= 7  # the command line is the eighth


def test_no_two_modules_import_each_other_by_whatever_way() -> None:
    found = {name: imported_modules(path) for name, path in modules().items()}
    TopologicalSorter({name: others & found.keys() for name, others in found.items()}).prepare()  # or a CycleError


@pytest.mark.parametrize(
    ("statement", "absent"),
    [
        ("import warpgran.cli.app", ["warp", "xarray", "matplotlib", "scipy", "pydantic", "h5py"]),
        ("import warpgran", ["matplotlib", "scipy", "warp"]),
        ("import warpgran.physics.reference", ["warp"]),
    ],
)
def test_imports_stay_light(statement: str, absent: list[str]) -> None:
    code = f"{statement}; import sys; print(*[name for name in {absent!r} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert found == []


@pytest.mark.parametrize(
    ("switch", "then", "drawn_by"),
    [
        ("--no-picture", "summary", "matplotlib PIL"),
        ("--picture", "summary", "matplotlib PIL"),  # which another process imports
        ("--no-picture", "plot", ""),
    ],
)
def test_a_single_run_its_table_and_its_picture_do_without_xarray(
    tmp_path: Path, switch: str, then: str, drawn_by: str
) -> None:
    (tmp_path / "short.toml").write_text("grid = { right = 0.3, cells = 100 }\ntime.end = 0.01\n")
    code = (
        "import os, sys; from warpgran.cli.app import app\n"
        "os.cpu_count = lambda: 2\n"
        f"for command in ['run', 'short.toml', '{switch}'], ['{then}', 'short.h5']:\n"
        "  try: app(command)\n"
        "  except SystemExit as ended: assert not ended.code\n"
        f"heavy = 'xarray pandas dask scipy distributed jinja2 matplotlib.pyplot {drawn_by}'.split()\n"
        "print('imported:', *(name for name in heavy if name in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "imported:"
    assert (tmp_path / "short.png").exists() == (switch == "--picture" or then == "plot")


def test_kernels_is_no_top_level_package() -> None:
    code = "import kernels"
    failed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
    assert "import this package as warpgran.kernels" in failed.stderr
