"""100 malformed result files: changed through HDF5 or byte by byte; every command that reads one, and --resume."""

from __future__ import annotations

import random
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))  # for tests/helpers

from helpers.attack import QUICK, SWEEP, Ended, asked, prepared, report, tried, warpgran

TRIALS = 100
PYTHON = ("wg.derive, wg.forces, wg.caveats, wg.with_keys",)
COMMANDS = (
    ("summary", "bad.h5", "--csv", "table.csv"),
    ("view", "bad.h5"),
    ("view", "../whole.h5", "bad.h5", "--runs", "3-5", "-o", "two.html"),
    ("plot", "../whole.h5", "bad.h5", "-o", "two.png"),
    ("plot", "bad.h5", "-o", "a.png"),
    ("plot", "bad.h5", "--run", "3", "-o", "b.png"),
    ("animate", "bad.h5", "-o", "a.gif"),
    ("compare", "../whole.h5", "bad.h5"),
    ("compare", "bad.h5", "../whole.h5"),
    ("merge", "all.h5", "bad.h5"),
    ("sensitivity", "bad.h5", "--no-picture"),
    ("run", "../case.toml", "-o", "bad.h5", "--resume", "--no-picture"),
)
DESIGN = """
[sensitivity]
samples = 2
of = ["run_out", "h_max", "front@0.01"]
[sensitivity.over]
"rheology.mu1" = { mean = 0.48, sd = 0.05, low = 0.4 }
"rheology.mu_wall" = { low = 0.01, high = 0.2, scale = "log" }
"""


def main() -> None:
    """Try every command on every file."""
    trials, rng = asked(TRIALS, seed=3)
    ended: list[Ended] = []
    findings: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for kind, more in (("sweep", SWEEP), ("design", DESIGN)):
            (folder / kind).mkdir()
            prepared(folder / kind, QUICK.replace("0.05", "0.02") + more)
        for trial in range(trials):
            here = folder / ("sweep" if trial % 4 else "design") / f"trial{trial}"
            here.mkdir()
            shutil.copy(here.parent / "whole.h5", here / "bad.h5")
            how = _spoil_bytes(here / "bad.h5", rng) if trial % 3 == 0 else _spoil(here / "bad.h5", rng)
            for command in [*COMMANDS, PYTHON]:
                end = tried(_derive, here) if command == PYTHON else warpgran(*command, folder=here)
                wrong = end.finding
                unusable = "runs cannot be used" in end.said  # a sound file whose design is refused, with its reasons
                if not wrong and end.code == 2 and not unusable and len(end.said.strip().splitlines()) != 1:
                    wrong = f"several lines: {end.said}"
                ended.append(end)
                findings += [f"trial {trial}, {how}, {' '.join(command)}: {wrong}"] if wrong else []
            shutil.rmtree(here)
    report("malformed results", ended, findings)


def _derive() -> None:
    """What Python is asked for with a result."""
    import warpgran as wg

    try:
        with wg.open_dataset("bad.h5") as data:
            wg.derive(data, "psi", "mu", "I")
            wg.forces(data)
            wg.caveats(data)
            wg.with_keys(data, "rheology.K")
    except wg.WarpgranError as error:
        print(error)
        sys.exit(2)


def _spoil_bytes(path: Path, rng: random.Random) -> str:
    data = bytearray(path.read_bytes())
    if rng.random() < 0.2:
        at = rng.randrange(len(data))
        path.write_bytes(data[:at])
        return f"cut at {at}"
    near = rng.choice((len(data), 20_000))
    places = [rng.randrange(min(near, len(data))) for _ in range(rng.choice((1, 4, 16, 64)))]
    for place in places:
        data[place] = rng.randrange(256)
    path.write_bytes(data)
    return f"bytes at {places[:4]}"


def _spoil(path: Path, rng: random.Random) -> str:
    """Change the file through HDF5."""
    with h5py.File(path, "r+") as file:
        names, attributes = sorted(file), sorted(file.attrs)
        name, attribute = rng.choice(names), rng.choice(attributes)
        values: list[Any] = [np.zeros(3), "text", b"\xff\x01", 1e300, float("nan"), -1, np.zeros((2, 2))]
        values.append(h5py.Empty("f8"))
        value = values[rng.randrange(len(values))]
        shape, kind = file[name].shape, file[name].dtype

        other = rng.choice([each for each in names if each != name])

        def again(make: Callable[[], Any]) -> None:
            del file[name]
            make()

        changes: dict[str, Callable[[], Any]] = {
            f"{name} gone": lambda: file.__delitem__(name),
            f"{name} = {value!r}": lambda: again(lambda: file.__setitem__(name, value)),
            f"{name} external": lambda: again(lambda: file.__setitem__(name, h5py.ExternalLink("/dev/zero", "/h"))),
            f"{name} soft": lambda: again(lambda: file.__setitem__(name, h5py.SoftLink(f"/{other}"))),
            f"{name} hard": lambda: again(lambda: file.__setitem__(name, file[other])),
            f"{name} a group": lambda: again(lambda: file.create_group(name)),
            f"{name} stored in /dev/zero": lambda: again(
                lambda: file.create_dataset(name, shape, "f8", external=[("/dev/zero", 0, h5py.h5f.UNLIMITED)])
            ),
            f"{name} references": lambda: again(
                lambda: file.create_dataset(name, data=[file["h" if name != "h" else "v"].ref], dtype=h5py.ref_dtype)
            ),
            f"{name} huge": lambda: again(lambda: file.create_dataset(name, (2**50,), "f8", chunks=(2**10,))),
            f"{name} without scales": lambda: again(lambda: file.create_dataset(name, shape, "f8")),
            f"numbers of {name}": lambda: _scramble(file[name], rng) if kind.kind in "fiu" else None,
            f"attribute {attribute} gone": lambda: file.attrs.__delitem__(attribute),
            f"attribute {attribute} = {value!r}": lambda: file.attrs.__setitem__(attribute, value),
            f"attributes of {name} gone": lambda: [file[name].attrs.__delitem__(key) for key in list(file[name].attrs)],
            f"units of {name} = {value!r}": lambda: file[name].attrs.__setitem__("units", value),
            f"coordinates of {name} = nonsense": lambda: file[name].attrs.__setitem__("coordinates", "h h nonsense"),
        }
        how = rng.choice(list(changes))
        changes[how]()
    return how


def _scramble(data: h5py.Dataset, rng: random.Random) -> None:
    values = data[:]
    flat = values.reshape(-1)
    odd = [np.nan, np.inf, -np.inf, 1e308, -1.0] if values.dtype.kind == "f" else [100, -100, 0]
    for place in range(0, flat.size, 3):
        flat[place] = rng.choice(odd)
    data[...] = values


if __name__ == "__main__":
    main()
