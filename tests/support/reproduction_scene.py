"""A report as it comes from two figures and twenty seeds, without playing them."""

from hydrohil.claims.claims import Verdict, verdict
from hydrohil.claims.study import Statement
from hydrohil.pages.drawing import Drawing
from hydrohil.reproduction.plan import find_figure
from hydrohil.reproduction.play import Found
from hydrohil.reproduction.report import Report
from hydrohil.reproduction.tally import Result, result
from hydrohil.thesis.library import find

SEEDS = 20
TRIAL, COMPUTED = find_figure("fig-5-9"), find_figure("fig-6-4")
CLAIM = find("fig-5-9").claims[0]  # below 160 N
SVG = '<svg viewBox="0 0 1 1"><path d="M 0 0L 1 1"/></svg>'


def verdicts(held: int, seeds: int = SEEDS) -> list[Verdict]:
    """`CLAIM` judged on the limit in `held` seeds, and just past it in the others."""
    return [verdict(CLAIM, 160.0 if seed < held else 160.1) for seed in range(seeds)]


def trial(held: int, seeds: int = SEEDS, tripped: str = "", gap: str = "") -> Result:
    found = [(seed, Found(TRIAL.name, (v,), (), tripped, gap)) for seed, v in enumerate(verdicts(held, seeds))]
    return result(TRIAL, found, (Drawing("Motion plot", SVG), Drawing("", SVG)))


def computed() -> Result:
    stated = Statement("a < b & c", "within", "mm", 1.0, 2.0, 'thesis 6.2.1: "<sic>"')
    return result(COMPUTED, [(0, Found(COMPUTED.name, (verdict(stated, 1.5),)))], (Drawing("", SVG),))


def report(*results: Result) -> Report:
    return Report(
        results=results,
        clock="local",
        seeds=SEEDS,
        source_version="0123456789abcdef",
        created_at="2026-01-01",
        duration_s=12.0,
        machine="a machine",
        command="hydrohil reproduce",
        times_real_time=400.0,
    )
