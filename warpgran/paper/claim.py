"""A statement of the paper, and what our results say to it."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass

from warpgran.paper.results import NotComputedError, Results

WORDS = {True: "holds", False: "does not hold", None: "cannot be told"}


@dataclass(frozen=True)
class Finding:
    """The finding on a claim.

    Attributes:
        value: Our numbers, in words.
        holds: Whether the statement holds; None if our results do not decide it.
    """

    value: str
    holds: bool | None

    @property
    def verdict(self) -> str:
        """In words."""
        return WORDS[self.holds]


@dataclass(frozen=True)
class Claim:
    """A statement of the paper.

    Attributes:
        name: Short, for tables.
        place: Section and figures of the paper.
        figures: Names of ours that show it.
        says: The statement, in our words.
        paper: The paper's number, "" where it gives none.
        how: What is measured, and when the statement is taken to hold.
        judge: Measures it.
    """

    name: str
    place: str
    figures: tuple[str, ...]
    says: str
    paper: str
    how: str
    judge: Callable[[Results], Finding]

    def evaluate(self, results: Results) -> Finding:
        """The finding of our results; undecided where a run, an instant or one of the numbers is missing."""
        try:
            finding = self.judge(results)
        except NotComputedError as error:
            return Finding(str(error), None)
        return Finding(finding.value, None) if "nan" in finding.value else finding


def claim(
    place: str, figures: str, *, paper: str = "", shared: str = ""
) -> Callable[[Callable[[Results], Finding]], Claim]:
    """Make a claim of the function that measures it.

    The function's name is the claim's, the first paragraph of its docstring the statement, the rest of it says how it
    is judged; `shared` is said before that. For the other arguments see `Claim`.
    """

    def made(judge: Callable[[Results], Finding]) -> Claim:
        says, _, how = inspect.cleandoc(judge.__doc__ or "").partition("\n\n")
        name = judge.__name__.replace("_", "-")
        words = " ".join(f"{shared} {how}".split())
        return Claim(name, place, tuple(figures.split()), says, paper, words, judge)

    return made


def at_angles(values: dict[float, float], form: str = "{:.2f}", unit: str = "") -> str:
    """Values by slope, in words: `0: 4.2, 22: 10 %`."""
    return ", ".join(f"{angle:g}: {form.format(value)}" for angle, value in values.items()) + f" {unit}".rstrip()


def by_packing(values: dict[str, float], form: str = "{:.2f}", unit: str = "") -> str:
    """Values by packing, in words."""
    return ", ".join(f"{name} {form.format(value)}" for name, value in values.items()) + f" {unit}".rstrip()
