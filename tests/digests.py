"""Digests of all results of the run files, to see that a change of the code changes no bit of them.

    python tests/digests.py --write FILE.json     # before the change
    python tests/digests.py --check FILE.json     # after it: prints what differs and exits with 1

Uses only the public interface of the installed warpgran. Digests hold for one machine and its versions of NumPy and
Warp. Threads and blocks have no part in them, so one thread computes all.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import warpgran as wg

ROOT = Path(__file__).parents[1]
COMPUTED = (("warp", "float64"), ("warp", "float32"), ("numpy", "float64"))


class Line(NamedTuple):
    """The digests of one run file, engine and precision.

    Attributes:
        runs: How many were computed, and of how many.
        steps: Of these runs together.
        digests: By variable; one that the result lacks is missing here too.
    """

    runs: str
    steps: int
    digests: dict[str, str]

    def __str__(self) -> str:
        return f"{self.runs}, {self.steps} steps: " + " ".join(f"{k}={v}" for k, v in self.digests.items())

    def differences(self, other: Line) -> list[str]:
        """The names of what differs."""
        names = dict.fromkeys([*self.digests, *other.digests])
        differ = [name for name in names if self.digests.get(name) != other.digests.get(name)]
        return [name for name in ("runs", "steps") if getattr(self, name) != getattr(other, name)] + differ


def digest(values: Any, dtype: str) -> str:
    """The first 16 digits of the sha256 of values, whatever precision they are kept in."""
    return hashlib.sha256(np.ascontiguousarray(values, dtype=dtype).tobytes()).hexdigest()[:16]


def compute(path: Path, engine: Any, precision: Any) -> Line:
    """Compute the runs of a file; by the NumPy engine, which is slow, the first and the last alone."""
    study = wg.read_study(path)
    few = engine == "numpy" and len(study) > 2
    cases = [study[0], study[len(study) - 1]] if few else study
    data = wg.simulate(cases, engine=engine, precision=precision, threads=1)
    computed = {str(name): v for name, v in data.data_vars.items() if v.dims[:1] == ("run",) and name != "bed"}
    types = {"f": "<f8", "i": "<i8"}
    digests = {name: digest(v, types[v.dtype.kind]) for name, v in computed.items() if v.dtype.kind in types}
    runs = f"{len(cases)} of {len(study)} runs" + (" (first and last)" if few else "")
    return Line(runs, int(data["steps"].sum()), digests)


def main(args: Sequence[str] | None = None) -> int:
    """Compute what is asked for, print it, and write it or compare it; 1 if anything differs."""
    parser = argparse.ArgumentParser(description="Digests of all results of the run files.")
    todo = parser.add_mutually_exclusive_group()
    todo.add_argument("--write", type=Path, metavar="FILE.json", help="write the digests")
    todo.add_argument("--check", type=Path, metavar="FILE.json", help="compare with these digests, print what differs")
    parser.add_argument("--only", default="*", metavar="PATTERN", help="files such as 'runs/dense_*' or '*latin*'")
    parser.add_argument("--engine", choices=("warp", "numpy"))
    parser.add_argument("--precision", choices=("float64", "float32"))
    options = parser.parse_args(args)

    def asked(key: str) -> bool:
        file, engine, precision = key.split()
        return (
            fnmatch(file, options.only) and options.engine in (None, engine) and options.precision in (None, precision)
        )

    files = [*sorted(ROOT.glob("runs/*.toml")), *sorted(ROOT.glob("runs/paper/*.toml"))]
    names = [file.relative_to(ROOT).as_posix() for file in files]
    keys = [key for how in COMPUTED for name in names if asked(key := " ".join((name, *how)))]
    before = {}
    if options.check:
        stored = json.loads(options.check.read_text(encoding="utf-8"))
        before = {key: Line(**line) for key, line in stored.items() if asked(key)}
    if not keys and not before:
        parser.error("no run file, engine and precision is like this")
    print(f"warpgran of {Path(wg.__file__).parent}", file=sys.stderr)

    lines: dict[str, Line] = {}
    differ = sorted(before.keys() - set(keys))
    for key in differ:
        print(f"{key}: no such run file any more")
    for key in keys:
        file, engine, precision = key.split()
        began = time.perf_counter()
        line = lines[key] = compute(ROOT / file, engine, precision)
        print(f"{key}: {time.perf_counter() - began:.1f} s", file=sys.stderr)
        if not options.check:
            print(f"{key}: {line}", flush=True)
        elif key not in before:
            differ.append(key)
            print(f"{key}: not in {options.check}", flush=True)
        elif names_differ := line.differences(before[key]):
            differ.append(key)
            print(f"{key}: differs in {', '.join(names_differ)}\n  was {before[key]}\n  is  {line}", flush=True)
    if options.write:
        stored = {key: line._asdict() for key, line in lines.items()}
        options.write.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")
    if options.check:
        print(f"{len(differ)} of {len(before.keys() | set(keys))} differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
