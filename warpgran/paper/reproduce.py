"""The paper anew: results, pictures, claims, and the page that holds them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib import rc_context

from warpgran.figures.page import Page
from warpgran.figures.style import STYLE, save
from warpgran.paper.catalogue import chosen
from warpgran.paper.claim import Finding
from warpgran.paper.laboratory import Laboratory
from warpgran.paper.picture import Picture
from warpgran.paper.report import Judged, counted, put_claims, put_picture, put_sources, write_csv
from warpgran.paper.results import Results, StoredResults
from warpgran.paper.settings import DEFAULTS, SETTINGS, Setting
from warpgran.run.options import Options

Progress = Callable[[str, int, float], None]
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """What to reproduce, and how.

    Attributes:
        runs: Folder of the run files.
        output: Folder to write to; made if it is not there.
        figures: Names of the figures; all if empty.
        laboratory: Measurements to lay over them.
        options: How to compute.
        overrides: `KEY=VALUE` for every run file.
        setting: The setting that is drawn.
        claims: Whether the claims are judged too.
    """

    runs: Path
    output: Path
    figures: tuple[str, ...] = ()
    laboratory: Laboratory = field(default_factory=Laboratory)
    options: Options = field(default_factory=Options)
    overrides: tuple[str, ...] = ()
    setting: Setting = DEFAULTS
    claims: bool = True


def shipped_runs() -> Path:
    """Folder of the run files: within the package where it is installed, runs/paper in a copy of the repository."""
    here = Path(__file__).parent
    installed = here / "runs"
    return installed if installed.is_dir() else here.parent.parent / "runs" / "paper"


def reproduce(plan: Plan, progress: Progress, tell: Tell) -> Path:
    """Compute what is missing, draw, judge, and write the page.

    Args:
        plan: What is asked for.
        progress: Called with the name of what is computed, its number of runs and how many are done.
        tell: Called with a line about each thing that is done.

    Returns:
        The page.

    Raises:
        OptionError: An unknown figure.
        CaseError: A run file or an override is wrong.
        StorageError: Something cannot be written.
        KeyboardInterrupt: Ctrl-C; what was computed is kept.
    """
    pictures, _ = chosen(plan.figures)
    plan.output.mkdir(parents=True, exist_ok=True)
    drawn = _results(plan, plan.setting, progress, whole=False)
    for picture in pictures:
        draw(picture, drawn, plan.laboratory, plan.output)
        tell(f"drew {picture.name}: {picture.title.removesuffix('.')}")
    for words in drawn.ended_early:
        tell(f"{words}: its lines end there")
    table = plan.output / "claims.csv"
    table.unlink(missing_ok=True)  # an older one would not be of these results
    judged = _judged(plan, progress, tell) if plan.claims else []
    if judged:
        write_csv(judged, table)
        for line in counted(judged):
            tell(line)
    page = plan.output / "index.html"
    _page(plan, pictures, drawn.ended_early, judged).write(page)
    return page


def draw(picture: Picture, results: Results, laboratory: Laboratory, folder: Path) -> None:
    """Draw a picture as PNG and SVG, the same bytes for the same results."""
    with rc_context({**STYLE, "svg.hashsalt": picture.name}):
        figure = picture.draw(results, laboratory)
        save(figure, folder / f"{picture.name}.png", dpi=180)
        save(figure, folder / f"{picture.name}.svg", dpi=180, Date=None)


def _results(plan: Plan, setting: Setting, progress: Progress, whole: bool = True) -> StoredResults:
    def named(name: str, runs: int, done: float) -> None:
        progress(f"{setting.name}/{name}", runs, done)

    folder = plan.output / "results" / setting.name
    return StoredResults(setting, plan.runs, folder, plan.options, plan.overrides, named, whole)


def _judged(plan: Plan, progress: Progress, tell: Tell) -> list[Judged]:
    """Every claim of the chosen figures under every setting, one setting after another."""
    _, claims = chosen(plan.figures)
    findings: dict[str, dict[str, Finding]] = {claim.name: {} for claim in claims}
    for setting in SETTINGS:
        results = _results(plan, setting, progress)
        for claim in claims:
            findings[claim.name][setting.name] = claim.evaluate(results)
        tell(f"judged {len(claims)} claims, {setting.words}")
    return [(claim, findings[claim.name]) for claim in claims]


def _page(plan: Plan, pictures: tuple[Picture, ...], ended_early: list[str], judged: list[Judged]) -> Page:
    page = Page("Dilatancy in dry granular flows with a compressible mu(I) rheology, computed anew")
    page.paragraph(
        "The numerical results of F. Bouchut, E. D. Fernandez-Nieto, E. H. Kone, A. Mangeney and G. Narbona-Reina, "
        "computed with warpgran from the run files below, to be read beside their paper. Figures have the paper's "
        f"numbers. They are drawn with {plan.setting.words}. Fronts, and the mass behind them, are measured in "
        "compacted thickness h_c = phi h/phi_stat, thickness itself in h."
    )
    if not plan.laboratory.tables:
        page.paragraph("Laboratory measurements are not public; --data FOLDER lays yours over the figures.")
    if plan.overrides:
        changed = ", ".join(plan.overrides)
        page.paragraph(f"Changed in every run file: {changed}. The remarks are on the files as they ship.")
    for words in ended_early:
        page.paragraph(f"In the figures {words}: its lines end there.")
    if judged:
        put_claims(page, judged)
    for picture in pictures:
        put_picture(page, picture, plan.output / f"{picture.name}.png", judged)
    how = plan.options
    put_sources(page, plan.runs, f"{how.engine} on {how.device} in {how.precision}")
    return page
