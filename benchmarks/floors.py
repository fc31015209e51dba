"""What a cell-step must cost on a GPU: the memory that it moves, the arithmetic that it does, the registers it takes.

Needs no GPU.

python benchmarks/floors.py
"""

from __future__ import annotations

from itertools import product

from parts.counts import ARCH, counts, table, total
from parts.registers import most

from warpgran.case.case import Case
from warpgran.solve.device import start_quietly
from warpgran.solve.variant import variant_of


def main() -> None:
    """Print the counts of each launch and their sums, by both schemes and in both precisions."""
    start_quietly()
    for order, precision in product((2, 1), ("float64", "float32")):
        variant = variant_of(Case().with_(**{"scheme.order": order}), precision)
        found = counts(variant)
        print(f"\n{precision}, order {order}, of a cell and step, sm_{ARCH}")
        print(table(found))
        print(f"memory: {total(found).bytes(precision)} bytes")
        print("registers of a lane: {} at most, and {} bytes of local memory".format(*most(variant)))


if __name__ == "__main__":
    main()
