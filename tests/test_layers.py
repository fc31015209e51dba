"""Who may import whom. What judges the kernels shares no code with them, and layers look downward only."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
LAYERS = [
    {"tables", "schema", "kernels", "reference", "exact"},
    {"errors"},
    {"sections"},
    {"times", "sweep_section"},
    {"checks", "sweep_values"},
    {"runfile"},
    {"case"},
    {"identity"},
    {"sweep", "outputs", "device"},
    {"state"},
    {"solver"},
    {"engines", "blocks"},
    {"results"},
    {"storage", "simulation"},
    {"cluster", "jobs", "merging", "summary", "derived", "page"},
    {"keys", "momentum"},
    {"drawing"},
    {"figures", "animation", "batch_figures"},
    {"verification", "paper"},  # packages, each a layer as a whole
    {"verify"},
    {"__init__", "cli"},
]
# The ways up, and only when called: Case.sweep, a shorthand for warpgran.sweep.sweep that needs no import, and
# simulate(client=...), which hands over to the cluster.
UPWARD_WHEN_CALLED = {("case", "warpgran.sweep"), ("simulation", "warpgran.cluster")}


def imports(path: Path, typing_too: bool = False, when_called: bool = True) -> set[str]:
    """Top-level names that a file imports, warpgran's own modules as warpgran.NAME."""
    tree = ast.parse(path.read_text())
    if not when_called:
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                node.body = []
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


def test_kernels_import_warp_alone() -> None:
    allowed = {"warp", "warpgran.kernels", "typing", "functools", "dataclasses"}
    for path in (ROOT / "kernels").glob("*.py"):
        assert imports(path, typing_too=True) <= allowed, path.name


@pytest.mark.parametrize("judge", ["reference", "exact"])
def test_what_judges_imports_numpy_alone(judge: str) -> None:
    allowed = {"__future__", "collections", "dataclasses", "typing", "numpy"}
    assert imports(ROOT / "warpgran" / f"{judge}.py") <= allowed


def test_layers_import_downward() -> None:
    level = {module: n for n, layer in enumerate(LAYERS) for module in layer}
    folder = ROOT / "warpgran"
    files = {path: path.relative_to(folder).parts[0].removesuffix(".py") for path in folder.rglob("*.py")}
    assert set(files.values()) <= level.keys(), "a new module needs its layer here"
    for path, name in files.items():
        at_once = imports(path, when_called=False)
        for other in imports(path) - {f"warpgran.{name}"}:
            if other.startswith("warpgran.") and (other in at_once or (name, other) not in UPWARD_WHEN_CALLED):
                assert level[other.removeprefix("warpgran.")] < level[name], f"{name} imports {other}"


@pytest.mark.parametrize(
    ("statement", "absent"),
    [
        ("import warpgran.cli", ["warp", "xarray", "matplotlib", "scipy", "pydantic", "h5py"]),
        ("import warpgran", ["matplotlib", "scipy", "warp"]),
        ("import warpgran.reference", ["warp"]),
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
