"""The report as one HTML page, which loads nothing from elsewhere."""

from itertools import groupby

from jinja2 import ChoiceLoader, Environment, PackageLoader

from hydrohil.claims.claims import band
from hydrohil.claims.pairs import PairClaim
from hydrohil.reproduction import formatting
from hydrohil.reproduction.explanations import explanation
from hydrohil.reproduction.parameters import differences
from hydrohil.reproduction.plan import CHAPTERS, Figure
from hydrohil.reproduction.report import Report
from hydrohil.reproduction.tally import ENOUGH_PERCENT, Result, Tally, failures


def page(report: Report) -> str:
    """The page's text."""
    loader = ChoiceLoader([PackageLoader("hydrohil.reproduction", ""), PackageLoader("hydrohil.pages", "")])
    environment = Environment(loader=loader, autoescape=True, trim_blocks=True)
    by_chapter = groupby(report.results, key=lambda result: result.figure.chapter)
    return environment.get_template("page.html").render(
        report=report,
        rows=[*report.counts, report.total],
        enough=ENOUGH_PERCENT,
        chapters=[(CHAPTERS[chapter], list(results)) for chapter, results in by_chapter],
        present={result.figure.name for result in report.results},
        failures=failures(report.results),
        compared=[(r.figure, one) for r in report.results for one in r.tallies if isinstance(one.claim, PairClaim)],
        heading=heading,
        why=_why,
        parameters=differences,
        band=band,
        measured=formatting.measured,
        verdict=formatting.verdict,
        duration=formatting.duration,
        number=formatting.number,
    )


def heading(figure: Figure) -> str:
    """`Figure 5-9, 5-10`, or the name of what has no number."""
    names = (figure.name, *figure.also)
    if not all(name.startswith("fig-") for name in names):
        return figure.name
    return "Figure " + ", ".join(name.removeprefix("fig-") for name in names)


def _why(result: Result, one: Tally) -> str:
    return explanation(result.figure.name, one.claim.statement)
