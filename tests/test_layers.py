"""Who may import whom. What judges the kernels shares no code with them, and layers look downward only."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from helpers.places import ROOT

LEAVES = {"schema", "files", "errors", "arrays"}
"""Modules of the top, which import no room."""
MAY_IMPORT: dict[str, set[str]] = {
    "errors": set(),
    "arrays": set(),
    "schema": set(),
    "files": {"errors"},
    "kernels": set(),
    "case": {"files", "errors", "arrays"},
    "physics": {"arrays"},
    "solve": {"case", "physics", "kernels", "schema", "errors", "arrays"},
    "analysis": {"physics", "schema", "files", "errors", "arrays"},
    "results": {"case", "solve", "schema", "files", "errors", "arrays"},
    "figures": {"case", "analysis", "schema", "files", "errors", "arrays"},
    "run": {"case", "solve", "results", "schema", "files", "errors", "arrays"},
    "studies": {"run", "figures", "analysis", "results", "case", *LEAVES},
    "verification": {"run", "figures", "analysis", "results", "solve", "physics", "case", *LEAVES},
    "paper": {"run", "figures", "analysis", "results", "solve", "physics", "case", *LEAVES},
}
"""What each room may import beside itself. The command line may import anything, and nothing imports it."""


def imports(path: Path, typing_too: bool = False) -> set[str]:
    """Top-level names that a file imports, warpgran's own modules as warpgran.NAME."""
    tree = ast.parse(path.read_text())
    if not typing_too:
        for node in ast.walk(tree):
            if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
                node.body = []
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {f"warpgran.{a.name}" for a in node.names} if node.module == "warpgran" else {node.module}
    return {".".join(name.split(".")[:2]) if name.startswith("warpgran") else name.split(".")[0] for name in found}


def rooms() -> dict[Path, str]:
    """Every file of the package with the room that it is in; a file of the top is a room of its own."""
    folder = ROOT / "warpgran"
    return {path: path.relative_to(folder).parts[0].removesuffix(".py") for path in folder.rglob("*.py")}


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
    assert set(rooms().values()) == {*MAY_IMPORT, "cli", "__init__"} - {"kernels"}


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_rooms_import_what_they_may(room: str) -> None:
    allowed = {f"warpgran.{name}" for name in {*MAY_IMPORT[room], room}}
    for path, name in rooms().items():
        if name == room:
            ours = {other for other in imports(path) if other.startswith("warpgran.")}
            assert ours <= allowed, f"{path.relative_to(ROOT)} imports {sorted(ours - allowed)}"


def test_no_class_name_stands_twice() -> None:
    homes: dict[str, list[str]] = {}
    for path in rooms():
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


def imported_modules(path: Path) -> set[str]:
    """Modules of warpgran that a file imports when it is itself imported: neither within functions nor for typing."""
    found: set[str] = set()
    nodes: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            nodes += node.orelse
        elif not isinstance(node, ast.FunctionDef | ast.Lambda):
            nodes += ast.iter_child_nodes(node)
    return {name for name in found if name.startswith("warpgran.")}


def test_no_two_modules_import_each_other_by_whatever_way() -> None:
    paths = {path: path.relative_to(ROOT).with_suffix("").parts for path in rooms()}
    paths |= {path: ("warpgran", "kernels", path.stem) for path in (ROOT / "kernels").glob("*.py")}
    modules = {".".join(parts).removesuffix(".__init__"): imported_modules(path) for path, parts in paths.items()}
    TopologicalSorter({name: found & modules.keys() for name, found in modules.items()}).prepare()  # or a CycleError


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


def test_kernels_is_no_top_level_package() -> None:
    code = "import kernels"
    failed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
    assert "import this package as warpgran.kernels" in failed.stderr
