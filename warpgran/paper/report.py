"""What `warpgran reproduce` writes beside the pictures: the table of claims, and the page that holds everything."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

import pandas as pd

from warpgran.figures.page import Page
from warpgran.files import replacing
from warpgran.paper.claim import Claim, Finding
from warpgran.paper.picture import Picture
from warpgran.paper.remarks import remark
from warpgran.paper.settings import AS_PAPER, DEFAULTS, SECOND_ORDER, SETTINGS

Judged = tuple[Claim, dict[str, Finding]]
"""A claim and its findings by setting."""

YES_NO = {True: "yes", False: "no", None: "open"}


def write_csv(judged: Sequence[Judged], path: Path) -> None:
    """Write the table of claims: what each says and, for every setting, our numbers and the verdict.

    Raises:
        StorageError: The file cannot be written.
    """
    rows = []
    for claim, found in judged:
        row = {"claim": claim.name, "place": claim.place, "statement": claim.says, "paper": claim.paper}
        for name, finding in found.items():
            row |= {name: finding.value, f"{name}_verdict": finding.verdict}
        rows.append(row | {"how": claim.how, "remark": remark(claim.name)})
    with replacing(path) as part:
        pd.DataFrame(rows).to_csv(part, index=False, lineterminator="\n", encoding="utf-8")


def counted(judged: Sequence[Judged]) -> list[str]:
    """How many claims hold under the settings that stand for themselves, and what the others change, in words."""
    words = []
    for setting in SETTINGS:
        if setting.base:
            changed = sum(found[setting.name].holds is not found[setting.base].holds for _, found in judged)
            words.append(f"{setting.words}: {changed} verdicts are others")
            continue
        verdicts = [found[setting.name].holds for _, found in judged]
        words.append(
            f"{setting.words}: {verdicts.count(True)} claims hold, {verdicts.count(False)} do not, "
            f"{verdicts.count(None)} cannot be told"
        )
    return words


def put_claims(page: Page, judged: Sequence[Judged]) -> None:
    """The table of all claims, under the settings that stand for themselves, and where another changes the verdict."""
    page.heading("Claims", "claims")
    page.paragraph(
        "What the paper states, and whether it is so here. Each claim is judged with the run files as they are and as "
        "the paper has it, both of order 1, and with order 2, with the run files' cells and with more, and with "
        "phi_stat = 0.585; how, the figures and claims.csv say. A claim that does not hold is a result, "
        "not a failure."
    )
    for line in counted(judged):
        page.paragraph(f"{line[0].upper()}{line[1:]}.")
    rows = []
    for claim, found in judged:
        ours = found[DEFAULTS.name]
        others = [f"{found[other.name].verdict}: {found[other.name].value}" for other in (AS_PAPER, SECOND_ORDER)]
        says = f"{claim.says} [{claim.paper}]" if claim.paper else claim.says
        known = " ".join(filter(None, (_elsewhere(found), remark(claim.name))))
        rows.append([claim.place, says, ours.value, YES_NO[ours.holds], *others, known])
    names = ["place", "the paper says", "defaults", "holds", "as the paper has it", "order 2", "remark"]
    page.table(names, rows, verdict="holds")


def _elsewhere(found: dict[str, Finding]) -> str:
    """The settings whose verdict differs from that of the one that they refine or change, in words."""
    changed = [s.name for s in SETTINGS if s.base and found[s.name].holds is not found[s.base].holds]
    return " ".join(f"{name}: {found[name].verdict} ({found[name].value})." for name in changed)


def put_picture(page: Page, picture: Picture, path: Path, judged: Sequence[Judged]) -> None:
    """A figure, and the claims that it shows."""
    number = int(picture.name.removeprefix("fig"))
    page.heading(f"Fig. {number}: {picture.title.removesuffix('.')}", picture.name)
    page.picture(path, picture.caption)
    shown = [(claim, found[DEFAULTS.name]) for claim, found in judged if picture.name in claim.figures]
    if shown:
        rows = [[claim.says, finding.value, YES_NO[finding.holds], claim.how] for claim, finding in shown]
        page.table(["the paper says", "defaults", "holds", "how it is judged"], rows, verdict="holds")


def put_sources(page: Page, runs: Path, how: str) -> None:
    """Settings, versions and run files."""
    page.heading("How it was computed", "how")
    page.table(["setting", "what it is"], [[setting.name, setting.words] for setting in SETTINGS])
    versions = ", ".join(f"{name} {version(name)}" for name in ("warpgran", "warp-lang", "numpy"))
    page.paragraph(f"{versions}; {how}.")
    for file in sorted(runs.glob("*.toml")):
        page.paragraph(file.name)
        page.preformatted(file.read_text(encoding="utf-8"))
