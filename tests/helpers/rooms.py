"""The rooms of the package and what their files import, read from the sources."""

from __future__ import annotations

import ast
from pathlib import Path

from helpers.places import ROOT


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


def modules() -> dict[str, Path]:
    """Every file of the package by the dotted name that it is imported as."""
    roots = {(): ROOT / "warpgran", ("kernels",): ROOT / "kernels"}
    files = [(folder, path.relative_to(root), path) for folder, root in roots.items() for path in root.rglob("*.py")]
    return {".".join(("warpgran", *folder, *inside.with_suffix("").parts)).removesuffix(".__init__"): path
            for folder, inside, path in files}  # fmt: skip


def room_of(module: str) -> str:
    """The room of a module: the folder, or the file of the top; "" for the package itself."""
    return module.partition(".")[2].partition(".")[0]


def arrows() -> dict[str, set[str]]:
    """The other rooms that each room imports, but for typing."""
    found: dict[str, set[str]] = {}
    for module, path in modules().items():
        room = room_of(module)
        found.setdefault(room, set()).update(room_of(name) for name in imports(path) if name.startswith("warpgran."))
        found[room].discard(room)
    del found[""]
    return found


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
