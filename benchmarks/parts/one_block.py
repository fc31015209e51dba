"""Many steps of a run by one block in one launch, made of the kernels themselves: to measure, no part of warpgran.

A step is 12 or 21 launches, which for few small runs cost a GPU more than the work between them. Here a block of lanes
keeps a run, does all kernels of a step one after another, and waits for its lanes between them; what a run needs stays
in the caches nearest to it. For this each kernel's source is read again as a function of its thread (Warp lets only a
kernel ask for that), and a kernel that calls them all is written in the order of `Solver.step`, whatever that is.
"""

from __future__ import annotations

import ast
import inspect
import linecache
import textwrap
from collections.abc import Mapping
from typing import Any

import warp as wp
from parts.stages import launches

from warpgran.kernels.precision import CAREFUL, module
from warpgran.solve.solver import Solver


class OneBlock:
    """A solver whose runs are each kept by a block.

    Attributes:
        module: Of the kernel.
    """

    def __init__(self, solver: Solver) -> None:
        """Write the kernel.

        Args:
            solver: With many lanes, and a chunk that holds all cells of a run.
        """
        if solver.chunks != 1 or solver.lanes == 1:
            raise ValueError("the solver's chunk must hold all cells of a run, and its blocks many lanes")
        self._solver = solver
        arguments: dict[Any, Any] = {}  # of all kernels, each once
        types: list[Any] = []
        names: dict[str, Any] = {"wp": wp, "meet": _meet}
        calls = []
        for kernel, launch in launches(solver.step):
            name = f"stage_{len(names)}"
            names[name] = _as_function(kernel)
            passed = []
            for type_, value in zip(kernel.func.__annotations__.values(), launch["inputs"], strict=True):
                key = id(value) if isinstance(value, wp.array) else (type_, value)
                if key not in arguments:
                    arguments[key] = value
                    types.append(type_)
                passed.append(f"a{list(arguments).index(key)}")
            of_lanes = launch["dim"] > solver.state.runs
            call = f"{name}({'t' if of_lanes else 'r'}, {', '.join(passed)})"
            calls += [call if of_lanes else f"if lane == 0:\n            {call}", "meet()"]
        active = f"a{list(arguments).index(id(solver.state.active))}"
        names |= {f"A{n}": type_ for n, type_ in enumerate(types)}
        declared = ", ".join(f"a{n}: A{n}" for n in range(len(types)))
        lines = [
            f"def keep({declared}, count: int):",
            "    t = wp.tid()",
            "    r = t // wp.block_dim()",
            "    lane = t % wp.block_dim()",
            "    n = int(0)",
            f"    go = {active}[r]",
            "    while n < count and go != 0:",
            *(f"        {call}" for call in calls),
            f"        go = {active}[r]",
            "        meet()",
            "        n += 1",
        ]
        self._arguments = list(arguments.values())
        self.module = module(f"{solver.state.variant.name}_one_block", CAREFUL)
        self._kernel = wp.kernel(_defined("keep", "\n".join(lines), names), module=self.module)

    def steps(self, count: int) -> None:
        """So many steps of every run that has not ended before; the host does not wait."""
        solver = self._solver
        wp.launch(self._kernel, dim=solver.state.runs * solver.lanes, block_dim=solver.lanes, device=solver.device,
                  inputs=[*self._arguments, count])  # fmt: skip


@wp.func_native("WP_TILE_SYNC();")  # type: ignore[untyped-decorator]
def _meet() -> None: ...  # by Warp's own word for __syncthreads(), and for its like on the CPU


def _as_function(kernel: Any) -> Any:
    """A kernel as a function of its thread and its arguments."""
    function = kernel.func
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    definition = tree.body[0]
    assert isinstance(definition, ast.FunctionDef)
    definition.decorator_list = []
    closed = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    names = dict(function.__globals__) | {name: cell.cell_contents for name, cell in closed}
    for argument in definition.args.args:
        argument.annotation = ast.Name(f"{argument.arg}_type", ast.Load())
        names[f"{argument.arg}_type"] = function.__annotations__[argument.arg]
    definition.args.args.insert(0, ast.arg("tid", ast.Name("int", ast.Load())))
    source = ast.unparse(ast.fix_missing_locations(tree)).replace("wp.tid()", "tid")
    return wp.func(_defined(definition.name, source, names))


def _defined(name: str, source: str, names: Mapping[str, Any]) -> Any:
    """A function of some source, which Warp then finds as if it stood in a file."""
    file = f"<{name} of one block, {len(linecache.cache)}>"
    linecache.cache[file] = len(source), None, source.splitlines(keepends=True), file
    scope = dict(names)
    exec(compile(source, file, "exec"), scope)
    return scope[name]
