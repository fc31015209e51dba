"""20 sizes of a disk, most of them too small: studies, merges and pictures; then more room, and --resume."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))  # for tests/helpers

from helpers.attack import QUICK, SWEEP, Ended, asked, half, killed, prepared, report, same, warpgran
from helpers.small_disk import small_disk

TRIALS = 20
PICTURES = ("png", "pdf", "svg")
"""One for each disk, in turn."""


def main() -> None:
    """Run on disks of growing size."""
    ended: list[Ended] = []
    findings: list[str] = []
    trials, _ = asked(TRIALS, seed=0)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole = prepared(folder, QUICK + SWEEP, "--no-picture")
        for share in ("1/2", "2/2"):
            shard = ("run", "case.toml", "--shard", share, "-o", f"{share[0]}.h5", "--no-picture")
            assert warpgran(*shard, folder=folder).code == 0
        part = (half(folder, killed) / "half.h5.part").stat().st_size
        needed = part + 2.5 * (folder / "whole.h5").stat().st_size + 2**17
        few = trials // 4  # are too small for the part file, the others end in what follows it
        sizes = [*np.linspace(2**14, part, few, endpoint=False), *np.linspace(part, needed, trials - few)]
        print(f"the part file has {part} bytes")
        for trial, size in enumerate(map(int, sizes)):
            with small_disk(folder / "disk", size) as disk:
                for words, end in _tries(disk, whole, PICTURES[trial % len(PICTURES)]):
                    ended.append(end)
                    wrong = end.finding or (words if words.startswith("!") else "")
                    findings += [f"{size} bytes, {words}: {wrong}"] if wrong else []
    report("full disks", ended, findings)


def _tries(disk: Path, whole: dict[str, object], suffix: str) -> list[tuple[str, Ended]]:
    """A study, its completion elsewhere, a merge, and pictures on what is left; "!" marks other numbers."""
    tries = []
    end = warpgran("run", "../case.toml", "-o", "out.h5", "--no-picture", folder=disk)
    tries.append(("run", end))
    if end.code == 0 and not same(disk / "out.h5", whole):
        tries.append(("! run to other numbers", end))
    if (disk / "out.h5.part").exists():
        more = disk.parent / "more"
        more.mkdir()
        shutil.copy(disk / "out.h5.part", more)
        end = warpgran("run", "../case.toml", "-o", "out.h5", "--no-picture", "--resume", folder=more)
        good = end.code == 0 and same(more / "out.h5", whole)
        tries.append(("resume" if good else f"! not resumed: {end.said}", end))
        shutil.rmtree(more)
    for path in disk.iterdir():
        path.unlink()
    end = warpgran("merge", "all.h5", "../1.h5", "../2.h5", folder=disk)
    tries.append(("merge", end))
    if end.code == 0 and not same(disk / "all.h5", whole):
        tries.append(("! merged to other numbers", end))
    tries.append((suffix, warpgran("plot", "../whole.h5", "-o", f"a.{suffix}", folder=disk)))
    with open(disk / "full", "wb") as file:  # what is left but for a few pages
        room = os.statvfs(disk)
        file.write(bytes(max(0, room.f_bavail - 3) * room.f_frsize))
    tries.append((f"{suffix} on 12 kB", warpgran("plot", "../whole.h5", "-o", f"b.{suffix}", folder=disk)))
    tries.append(("gif on 12 kB", warpgran("animate", "../whole.h5", "-o", "c.gif", folder=disk)))
    if left := [path.name for path in disk.iterdir() if path.name.startswith(".")]:
        tries.append((f"! left {left}", tries[-1][1]))
    return tries


if __name__ == "__main__":
    main()
