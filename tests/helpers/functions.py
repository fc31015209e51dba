"""Functions of the kernels, called one by one: each in a kernel that is written for it."""

from __future__ import annotations

import linecache
from typing import Any

import numpy as np
import warp as wp

from warpgran.case.case import Case
from warpgran.kernels.precision import FAST, module, precision
from warpgran.solve.schedule import Outputs
from warpgran.solve.state import State, padded_cells
from warpgran.solve.variant import variant_of


class Caller:
    """Calls functions of a variant, compiled as the kernels are, with the parameters of a case.

    Attributes:
        case: Whose parameters they get.
        variant: What is compiled in.
        module: For the kernels that come with the functions; never compiled.
    """

    def __init__(self, case: Case, precision_name: str = "float64") -> None:
        self.case, self.variant = case, variant_of(case, precision_name)
        self.module = module(f"{self.variant.name}_functions", FAST)
        self._kinds = precision(precision_name)
        state = State(1, padded_cells(case.grid.cells), self.variant, Outputs.of(case), "cpu")
        state.load([case])
        self._params = state.params

    def __call__(self, function: Any, *columns: Any, returns: int = 1) -> Any:
        """What a function returns for each row of arguments; every output is NaN before.

        Args:
            function: Of the kernels.
            columns: Arguments but for the parameters of the run: numbers or arrays, which are broadcast.
            returns: How many values it returns.
        """
        Real = self._kinds.Real
        types = [type_ for type_ in function.input_types.values() if type_ is not self._kinds.RunParams]
        arrays = np.broadcast_arrays(*(np.atleast_1d(column) for column in columns or (0.0,)))
        inputs = [wp.array(array, dtype=type_) for array, type_ in zip(arrays, types, strict=False)]
        outputs = [wp.full(arrays[0].size, float("nan"), dtype=Real) for _ in range(returns)]
        kernel = self._kernel(function, types, returns)
        wp.launch(kernel, dim=arrays[0].size, inputs=[*inputs[: len(types)], self._params, *outputs], device="cpu")
        found = [output.numpy().astype(float) for output in outputs]
        assert np.isfinite(found).all(), f"{function.key} made a NaN or left an output as it was"
        return found if returns > 1 else found[0]

    def _kernel(self, function: Any, types: list[Any], returns: int) -> Any:
        """A kernel that calls the function with the elements of its arrays and stores what it returns."""
        inputs = [f"a{n}: T{n}" for n in range(len(types))]
        outputs = [f"b{n}: B" for n in range(returns)]
        passed = [f"a{n}[i]" for n in range(len(types))]
        passed += ["params[0]"] * (len(function.input_types) - len(types))
        values = [f"b{n}_i" for n in range(returns)]
        lines = [
            f"def call({', '.join([*inputs, 'params: Params', *outputs])}):",
            "    i = wp.tid()",
            f"    {', '.join(values)} = function({', '.join(passed)})",
            *(f"    b{n}[i] = Real({value})" for n, value in enumerate(values)),
        ]
        name = f"{self.variant.name}_{function.key.split('__')[-1]}"
        source = "\n".join(lines)
        linecache.cache[name] = len(source), None, source.splitlines(keepends=True), name
        scope = {"wp": wp, "function": function, "Params": self._kinds.Params, "B": self._kinds.Array}
        scope |= {"Real": self._kinds.Real} | {f"T{n}": wp.array(dtype=type_) for n, type_ in enumerate(types)}
        exec(compile(source, name, "exec"), scope)
        return wp.kernel(scope["call"], module=module(name, FAST))
