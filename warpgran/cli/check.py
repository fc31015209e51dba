"""The command `warpgran check`."""

from __future__ import annotations

import math

from warpgran.cli.arguments import Precision, RunFile, Set
from warpgran.cli.report import warn_of
from warpgran.cli.terminal import read, say

EXAMINED = 5000
"""Most runs that are checked; `warpgran run` checks all."""
COUNTED = 1000
"""Most runs whose steps are counted."""


def check(file: RunFile, precision: Precision = "float64", set_: Set = None) -> None:
    """Check a run file without running it: mistakes, unlikely values, grid, outputs, steps, memory and file size."""
    from warpgran.analysis.units import unit_of
    from warpgran.case.calibration_section import NAME, read_calibration
    from warpgran.case.sampled_runs import sampled_runs
    from warpgran.case.toml import load
    from warpgran.results.layout import Layout
    from warpgran.solve.expected_steps import expected_steps
    from warpgran.solve.state import bytes_of_run, bytes_of_start
    from warpgran.solve.variant import variant_of

    study = read(file, set_, most=EXAMINED)
    fitted = [*read_calibration(file, set_ or ()).priors] if NAME in load(str(file))[1] else []
    layout = Layout(study)
    counted = sampled_runs({}, len(study), COUNTED)
    cell_steps = sum(expected_steps(study[r]).cell_steps for r in counted)
    per_run = 8 * sum(math.prod(column.shape) for column in layout.columns.values())
    case, outputs = study.base, layout.outputs
    runs = "1 run" if len(study) == 1 else f"{len(study)} runs"
    over = f" over {', '.join(study.keys)}" if study.keys else ""
    warn_of(study)
    say(f"{file}: {case.title or 'untitled'}")
    say(f"{runs}{over}")
    if fitted:
        say(f"warpgran calibrate fits {', '.join(fitted)}")
    dx = unit_of(case.dx).text(case.dx)
    say(f"{layout.cells} cells of {dx}, t = {case.time.end:g} s, about {rough(expected_steps(case).steps)} steps")
    say(f"{outputs.snapshots} snapshots and {outputs.series} samples")
    say(f"about {rough(cell_steps * len(study) / len(counted))} cell-steps")
    variant = variant_of(case, precision)
    memory = bytes_of_run(layout.cells, outputs, variant) + bytes_of_start(
        layout.cells, case.scheme.start_levels, variant
    )
    say(f"memory: {size(memory)} a run being computed")
    say(f"file: {size(per_run * len(study))} before compression")
    if len(study) > EXAMINED:
        extremes = "those with the least and the greatest values among them"
        say(f"about {EXAMINED} of {len(study)} runs were checked, {extremes}; warpgran run checks all")


def rough(n: float) -> str:
    """A count to two digits: an estimate of steps is some ten percent off."""
    return f"{float(f'{n:.2g}'):g}"


def size(n: float) -> str:
    """Bytes with three digits and a unit."""
    for unit in ("B", "kB", "MB", "GB"):
        if n < 1000.0:
            return f"{n:.3g} {unit}"
        n /= 1000.0
    return f"{n:.3g} TB"
