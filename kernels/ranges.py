"""Which cells a thread visits.

A launch has `chunks * block_dim` threads a run: each chunk of a run's window is walked by the lanes of one block, a
stride of block_dim apart. On the CPU block_dim is 1 and there is one chunk, so that a thread walks the whole window in
a plain loop, which LLVM vectorises; on CUDA neighbouring lanes read neighbouring cells.
"""

import warp as wp

from warpgran.kernels.precision import BLOCK

_BLOCK = wp.constant(BLOCK)


@wp.func
def run_of(thread: int, chunks: int) -> int:
    """The run that a thread works on."""
    return thread // (chunks * wp.block_dim())


@wp.func
def chunk_size(width: int, chunks: int) -> int:
    """Cells in a chunk of a window of `width` cells, a multiple of BLOCK."""
    return (width + chunks * _BLOCK - 1) // (chunks * _BLOCK) * _BLOCK


@wp.func
def first_of(thread: int, chunks: int, row: int, lo: int, hi: int) -> int:
    """The element a thread starts from, for the window lo..hi of cells of the run stored at `row`."""
    block = thread // wp.block_dim()
    start = row + lo + (block % chunks) * chunk_size(hi - lo, chunks)
    # wp.max shows the compiler that the index is not negative, without which it does not vectorise.
    return wp.max(start + thread % wp.block_dim(), 0)


@wp.func
def before_first(thread: int, chunks: int, row: int, lo: int, hi: int) -> int:
    """The element on the left of first_of: where a loop that also reads the left neighbour starts to count.

    Indices `left`, `left + 1`, `left + 2` vectorise, `i - 1` does not.
    """
    return wp.max(first_of(thread, chunks, row, lo, hi) - 1, 0)


@wp.func
def end_of(thread: int, chunks: int, row: int, lo: int, hi: int, active: int) -> int:
    """One past the last element of a thread's chunk; 0, so that nothing is visited, if the run is not active."""
    chunk = (thread // wp.block_dim()) % chunks
    end = row + wp.min(lo + (chunk + 1) * chunk_size(hi - lo, chunks), hi)
    return wp.where(active != 0, end, 0)
