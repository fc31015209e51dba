"""How long a short run takes from the command to its end, for one or several installations.

    python benchmarks/startup.py
    python benchmarks/startup.py before=/path/of/bin/warpgran after=/path/of/bin/warpgran --rounds 15

runs `warpgran run runs/dense_22deg.toml`, with and without its picture, in rounds of all that is to be compared, so
that what else the machine does falls on each alike. It prints the least and the median time, and the least processor
time (user and system), which a busy machine disturbs less. The first round, which may compile, does not count.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

RUN_FILE = Path(__file__).parents[1] / "runs" / "dense_22deg.toml"
PICTURES = {"without a picture": "--no-picture", "with its picture": "--picture"}


def measure(command: list[str]) -> tuple[float, float]:
    """Seconds from start to end of a command in an empty folder, and of processor time."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - began
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return seconds, used.ru_utime + used.ru_stime


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("installations", nargs="*", metavar="NAME=COMMAND", help="default: the warpgran of the PATH")
    parser.add_argument("--rounds", type=int, default=9)
    options = parser.parse_args()
    pairs = [pair.split("=", 1) for pair in options.installations] or [["warpgran", shutil.which("warpgran") or ""]]
    found: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for _ in range(1 + options.rounds):
        for picture, switch in PICTURES.items():
            for name, command in pairs:
                measured = measure([command, "run", str(RUN_FILE), switch])
                found.setdefault((picture, name), []).append(measured)
    print(f"{'':34} least  median  processor, least [s]")
    for (picture, name), times in found.items():
        seconds, processor = zip(*times[1:], strict=True)
        print(f"{picture:20}{name:14} {min(seconds):5.2f} {statistics.median(seconds):7.2f} {min(processor):9.2f}")


if __name__ == "__main__":
    main()
