"""Where things are in the checkout."""

from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
TESTS = ROOT / "tests"
RUNS = ROOT / "runs"
DOCS = ROOT / "docs"
BENCHMARKS = ROOT / "benchmarks"
