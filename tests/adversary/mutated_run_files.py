"""Run files and measurements mutated at random, by text and by value: checked, computed for a few steps, and read.

    python tests/adversary/mutated_run_files.py --files 500 --seed 1

What a file asks for is tried: a run, a sweep, a design, a calibration or a study of grids, then what reads results. No
command may end in a traceback, crash or take longer than 20 s, and what a bad file is refused with may not steer the
terminal. Takes some minutes; the files that show a fault are kept.
"""

from __future__ import annotations

import argparse
import random
import re
import shutil
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # tests/

from helpers.attempts import Attempt, Tries
from helpers.places import ROOT

BED = "x,b\n-0.2,0.0\n0.3,0.02\n1.6,0.0\n"
PROFILE = "x,h,phi,v\n-0.2,0.1,0.6,0.0\n0.0,0.14,0.62,0.1\n0.2,0.0,0.6,0.0\n"
TABLES = '[slope]\nangle = 16\nbed = "bed.csv"\n[column]\nprofile = "profile.csv"\n[time]\nend = 0.2\n'
MEASURED = {
    "front.csv": "angle,t,x,sigma\n10,0.05,0.02,0.01\n10,0.1,0.05,0.01\n22,0.05,0.03,0.01\n22,0.1,0.07,0.01\n",
    "volume.csv": "angle,t,change,sigma\n10,0.1,0.02,0.01\n22,0.1,0.03,0.01\n",
}
CALIBRATION = (
    "[time]\nend = 0.1\n[calibration.over]\n"
    '"rheology.mu1" = { low = 0.3, high = 0.6 }\n"rheology.K" = { mean = 4.0, sd = 1.0, low = 0.0 }\n'
)
EXPERIMENTS = (
    CALIBRATION + '[[calibration.experiments]]\ndata = "."\nset = { "column.phi" = 0.55 }\n'
    '[[calibration.experiments]]\ndata = "measured"\n'
)
SAMPLED = (
    '[time]\nend = 0.1\n[sweep]\nmode = "sobol"\nsamples = 4\n[sweep.over]\n'
    '"rheology.K" = { low = 0.1, high = 8.0, log = true }\n"column.phi" = { low = 0.55, high = 0.62 }\n'
)
LOGARITHMIC = (
    '[time]\nend = 0.1\n[sensitivity]\nsamples = 2\nof = ["run_out", "front", "h_max@0.05"]\n[sensitivity.over]\n'
    '"rheology.mu_wall" = { low = 0.01, high = 0.3, scale = "log" }\n'
    '"rheology.mu1" = { mean = 0.48, sd = 0.03, low = 0.4, high = 0.55 }\n'
)
DESIGN = (
    '[time]\nend = 0.1\nseries = { every = 0.05 }\n[sensitivity]\nmethod = "morris"\nsamples = 2\n'
    '[sensitivity.over]\n"rheology.K" = { low = 0, high = 4 }\n"slope.angle" = { mean = 10, sd = 2 }\n'
)
ODD = [
    "0", "-0.0", "1", "-1", "1e-320", "5e-324", "1e-30", "1e-12", "1e30", "1e160", "1.7976931348623157e308", "-1e308",
    "inf", "-inf", "nan", "9" * 25, "9" * 5000, "-9223372036854775809", "2147483648", "1e400", "0x7fffffffffffffff",
    "true", "[]", "{}", '""', '"\\u0000"', '"\\u001b[2J"', '"' + "x" * 3000 + '"', "[0, 1e-320]", "[" * 200 + "]" * 200,
    "{ every = 1e-320 }", "{ every = 5e-324 }", "{ low = 0, high = 1e308 }", "1979-05-27", "07:32:00", '"bed.csv"',
    '"/dev/null"', '"."', "0.5", "80", "[1, 2, 3]", '["f0", "f2"]', "1e-9", "12345678",
]  # fmt: skip
STRANGE = [
    "\x00", "\x1b[31m", "\u202e", "\ud7ff", "\n", '"', "'", "[", "]", "=", "#", "{", "}", "\\", "\t", "é", "'''", '"""',
]  # fmt: skip
FORMS = [
    "{ low = 0, high = 4 }", "{ low = 4, high = 0 }", "{ low = 1, high = 1 }", "{ mean = 0.5, sd = 0.1 }",
    "{ mean = 0.5, sd = 0 }", "{ mean = 0.5, sd = -1 }", "{ mean = 0.5, sd = 1e300 }", "{ mean = 0.5, sd = 5e-324 }",
    "{ mean = 0.5, sd = 0.1, low = 0.5 }", "{ mean = 0.5, sd = 0.1, low = 40, high = 41 }", "{ mean = nan, sd = 1 }",
    '{ low = 0, high = 1, scale = "log" }', '{ low = 1e-300, high = 1e300, scale = "log" }', "{ low = 0.5 }",
    '{ low = 0.1, high = 1, scale = "log", log = false }', "{ low = 0.1, high = 1, log = true }", "{ sd = 1 }",
    "{ low = -inf, high = inf }", "{ low = 0.5, high = 0.5000000000000001 }", "{ middle = 3 }", "[0.5, 0.6]",
]  # fmt: skip
QUICK = ["--set", "time.step_limit=30", "--set", "grid.cells=80"]
FEW = [
    word for key, value in (("screening", 8), ("starts", 1), ("particles", 8), ("chains", 2), ("predictive", 2))
    for word in ("--set", f"calibration.{key}={value}")
]  # fmt: skip
"""Of a calibration that takes a second or two."""
READ = [
    ["summary", "out.h5"], ["summary", "out.h5", "--csv", "table.csv"], ["view", "out.h5"],
    ["view", "out.h5", "out.h5"], ["view", "out.h5", "sound.h5", "--max-size", "1MB"], ["plot", "out.h5"],
    ["plot", "out.h5", "--run", "0"], ["plot", "out.h5", "sound.h5"], ["animate", "out.h5"],
    ["compare", "out.h5", "sound.h5"], ["compare", "sound.h5", "out.h5"], ["merge", "all.h5", "out.h5", "--force"],
    ["sensitivity", "out.h5", "--no-picture"],
]  # fmt: skip
"""One of them after each run that wrote its file."""


OURS = [TABLES, DESIGN, LOGARITHMIC, SAMPLED, CALIBRATION, EXPERIMENTS]


def texts() -> list[str]:
    """Files to begin from."""
    ours = sorted((ROOT / "runs").rglob("*.toml"))
    return [path.read_text(encoding="utf-8") for path in ours] + [*2 * OURS, ""]


def keys() -> list[str]:
    """Every dotted key, those of the sections that make a study too."""
    from warpgran.case.all_sections import ALL_SECTIONS
    from warpgran.case.sections import KEYS

    studies = ("sweep", "sensitivity", "calibration")
    return [*KEYS, "title", *(f"{name}.{key}" for name in studies for key in ALL_SECTIONS[name].described())]


def by_text(text: str, rng: random.Random) -> str:
    """A few characters or lines removed, doubled, moved or replaced."""
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(text) + 1)
        lines = text.split("\n")
        how = rng.randrange(6)
        if how == 0:
            text = text[:at] + rng.choice(STRANGE) + text[at:]
        elif how == 1:
            text = text[:at] + text[at + rng.randint(1, 8) :]
        elif how == 2:
            text = text[:at]
        elif how == 3:
            rng.shuffle(lines)
            text = "\n".join(lines)
        elif how == 4:
            text = "\n".join([*lines, rng.choice(lines)])
        else:
            text = text[:at] + chr(rng.choice([rng.randrange(1, 128), rng.randrange(128, 0xD800)])) + text[at + 1 :]
    return text


def by_value(text: str, rng: random.Random) -> str:
    """Numbers of the file replaced by odd ones, or some powers of ten away."""
    for _ in range(rng.randint(1, 3)):
        found = list(re.finditer(r"(?<=[=\[ ,])-?\d[\d.e-]*", text))
        if found:
            number = rng.choice(found)
            scaled = f"{number[0]}e{rng.randint(-3, 3)}"
            text = text[: number.start()] + rng.choice([scaled, rng.choice(ODD)]) + text[number.end() :]
    return text


def overrides(known: list[str], rng: random.Random) -> list[str]:
    """Keys set to odd values on the command line."""
    chosen = []
    for _ in range(rng.randint(1, 3)):
        key = rng.choice(known)
        over = key.endswith(".over") and rng.random() < 0.9
        chosen.append(f"{key}.{rng.choice(known)}={rng.choice(FORMS)}" if over else f"{key}={rng.choice(ODD)}")
    return [word for change in chosen for word in ("--set", change.replace("\0", ""))]


def commands_of(file: str, text: str, sets: list[str], rng: random.Random) -> list[list[str]]:
    """What is tried with a file, one after the other while it goes well."""
    found = [["check", file, *sets]]
    if rng.random() > 0.8:
        return found
    quick = [*sets, *QUICK]
    engine = ["--engine", rng.choice(["numpy", "numpy", "warp"])]
    picture = [rng.choice(["--picture", "--no-picture"])]
    words = [file, *quick, *engine, *picture, "-o", "out.h5", "--force"]
    if "[calibration" in text and rng.random() < 0.8:
        stage = rng.choice(["screening", "fit", "posterior", "predictive"])
        return [*found, ["calibrate", file, "--data", "measured", "-o", "fitted", "--stage", stage, *quick, *FEW]]
    if "[sensitivity" in text and rng.random() < 0.8:
        return [*found, ["sensitivity", *words, *rng.choice([[], ["--drop-failed"]])]]
    if rng.random() < 0.15:
        return [*found, ["converge", file, *quick, "-o", "converged.png", "--csv", "converged.csv"]]
    return [*found, ["run", *words, *rng.choice([[], [], ["--view"]])], rng.choice(READ), rng.choice(READ)]


def measured(rng: random.Random, folder: Path) -> None:
    """Write measurements, half of the time mutated ones."""
    for name, text in MEASURED.items():
        if rng.random() < 0.5:
            text = rng.choice([by_text, by_value])(text, rng)
        (folder / name).write_bytes(text.encode("utf-8", "replace"))


def judged(attempt: Attempt) -> str:
    """The fault of an attempt."""
    if attempt.fault:
        return attempt.fault
    if attempt.code not in (0, 1, 2):
        return f"exit status {attempt.code}"
    if "RuntimeWarning" in attempt.text:
        return "a warning of NumPy"
    steering = [c for c in attempt.text if not c.isprintable() and c not in "\n\xa0"]
    return f"writes {steering[:3]}" if steering else ""


def main() -> None:
    """Try as many files as asked for, and say what was found."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--files", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="mutated-"))
    (folder / "bed.csv").write_text(BED)
    (folder / "profile.csv").write_text(PROFILE)
    (folder / "measured").mkdir()
    (folder / "sound.toml").write_text("grid.cells = 80\ntime.end = 0.1\n")
    bases, known, faults, counts, slowest = texts(), keys(), 0, {0: 0, 1: 0, 2: 0}, 0.0
    with Tries(folder) as tries:
        assert tries.of("run", "sound.toml", "-o", "sound.h5", "--no-picture").code == 0
        for n in range(asked.files):
            rng = random.Random(f"{asked.seed} {n}")
            text, sets = rng.choice(bases), []
            kind = rng.randrange(3)
            if kind == 0:
                text = by_text(text, rng)
            elif kind == 1:
                text = by_value(text, rng)
            else:
                sets = overrides(known, rng)
            file = folder / f"mutated_{n}.toml"
            file.write_bytes(text.encode("utf-8", "replace"))
            commands = commands_of(file.name, text, sets, rng)
            measured(rng, folder / "measured")
            shutil.rmtree(folder / "fitted", ignore_errors=True)
            for command in commands:
                attempt = tries.of(*command)
                slowest = max(slowest, attempt.seconds)
                fault = judged(attempt)
                counts[attempt.code] = counts.get(attempt.code, 0) + 1
                if fault:
                    faults += 1
                    print(f"{n}: {fault} after {attempt.seconds:.1f} s: warpgran {' '.join(command)}"[:400])
                    print("   ", attempt.text.strip()[-600:].encode("unicode_escape").decode())
                many = re.search(r"^(\d+) runs", attempt.text, re.MULTILINE)
                if fault or attempt.code == 2 or (many and int(many[1]) > 64):
                    break
            if not fault:
                file.unlink()
    print(f"{asked.files} files, by exit status {counts}, slowest {slowest:.1f} s, {faults} faults")
    if faults:
        sys.exit(f"the files are kept in {folder}")
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
