"""Cutting a study into blocks of runs that are computed together."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from warpgran.case.study import Study
from warpgran.kernels.precision import Variant
from warpgran.solve.schedule import Outputs
from warpgran.solve.state import bytes_of_run, bytes_of_start, most_runs, padded_cells
from warpgran.solve.variant import KEYS, variant_of

CACHE = 3 * 2**19
"""Bytes of state of a block on a CPU, so that what a step visits stays in the second-level cache of a core."""
MOST_DOUBLED = 2
"""Levels of a start for each of which a block is twice as large, so that as many runs start at a time as fit the cache.

What starts at a time is a block's 2^levels-th part, and each part is computed by calls from Python, which cost more
than the run proper then loses for want of cache."""


class Block(NamedTuple):
    """Runs that are computed together.

    Attributes:
        runs: Their numbers in the study.
        capacity: Of the solver, >= len(runs); shared by all blocks of one shape.
        padded: Elements of a row of its arrays.
        variant: What is compiled in.
    """

    runs: tuple[int, ...]
    capacity: int
    padded: int
    variant: Variant


def plan(
    study: Study, runs: Sequence[int], outputs: Outputs, precision: str, *, on_cpu: bool, threads: int, memory: float
) -> list[Block]:
    """Cut runs of a study into blocks, each of one variant, of grids of about one size and starts of as many levels.

    Args:
        study: All runs.
        runs: Numbers of those to compute.
        outputs: Their output schedule.
        precision: "float64" or "float32".
        on_cpu: Whether a block is to fit the cache of a core, rather than fill the memory.
        threads: Blocks computed at once; each thread gets some of the runs.
        memory: Bytes that these blocks may take together.

    Raises:
        MemoryError: A single run takes more, or more than any memory; the message says how much.
    """
    groups: dict[tuple[Variant, int, int], list[int]] = {}
    for run, kind in zip(runs, _kinds(study, runs, precision), strict=True):
        groups.setdefault(kind, []).append(run)
    blocks = []
    for (variant, padded, levels), members in groups.items():
        size, start = bytes_of_run(padded - 1, outputs, variant), bytes_of_start(padded - 1, levels, variant)
        if size + start > memory:
            started = f", with its start on {2**levels} times as many," if levels else ""
            taken = f"{(size + start) / 2**20:.0f} MiB"
            raise MemoryError(f"a run of {padded - 1} cells{started} takes {taken}; allow that much or more")
        fit = most_runs(padded, outputs, variant)
        if fit == 0:
            kept = f"{outputs.snapshots} snapshots and {outputs.samples} samples"
            raise MemoryError(
                f"a run of {padded - 1} cells with {kept} has more numbers than fit an array; ask for fewer"
            )
        share = memory / max(1, min(threads, len(members)))
        most = min(_most_in(share, size, start, levels), fit, -(-len(members) // threads))
        if on_cpu:
            most = min(most, room_on_cpu(levels) // bytes_of_run(padded - 1, Outputs.none(), variant))
        parts = _evenly(members, max(1, most), threads)
        blocks += [Block(part, len(parts[0]), padded, variant) for part in parts]
    return blocks


def room_on_cpu(levels: int) -> int:
    """Bytes of state of a block on a CPU whose runs start on so many levels of finer cells."""
    return CACHE << min(levels, MOST_DOUBLED)


def _most_in(memory: float, size: int, start: int, levels: int) -> int:
    """Most runs of a block in so much memory, of `size` each and `start` for as many as start at a time [bytes]."""
    if memory >= (size << levels) + start:  # more than one of them starts at a time
        return int(memory // (size + start / 2**levels))
    return int(max(0.0, memory - start) // size)


def _evenly(runs: Sequence[int], most: int, threads: int) -> list[tuple[int, ...]]:
    """Parts of at most `most` runs, as many for each thread, equal but for one run; the largest comes first."""
    each = -(-len(runs) // (most * threads))
    count = min(each * threads, len(runs))
    ends = [-(-len(runs) * k // count) for k in range(count + 1)]
    return [tuple(runs[begin:end]) for begin, end in pairwise(ends)]


def _kinds(study: Study, runs: Sequence[int], precision: str) -> list[tuple[Variant, int, int]]:
    """Variant, elements of a row, rounded up, and levels of the start of each run."""
    keys = [key for key in (*KEYS, "grid.cells", "scheme.start") if key in study.keys]
    columns = [study.values(key) for key in keys]
    known: dict[tuple[object, ...], tuple[Variant, int, int]] = {}
    kinds = []
    for run in runs:
        values = tuple(column[run] for column in columns)
        if values not in known:
            case = study[run]
            padded = _rounded(padded_cells(case.grid.cells))
            known[values] = variant_of(case, precision), padded, case.scheme.start_levels
        kinds.append(known[values])
    return kinds


def _rounded(padded: int) -> int:
    """Round up to three significant binary digits, so that grids of nearly one size share a block."""
    unit = 1 << max(0, padded.bit_length() - 3)
    return padded_cells(-(-padded // unit) * unit - 1)
