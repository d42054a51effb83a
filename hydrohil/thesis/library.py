"""Every experiment that ships, by name and by alias."""

import os
from functools import cache
from pathlib import Path

from hydrohil.claims.pairs import PairClaim
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.toml_files import from_toml
from hydrohil.shared.contract.assignments import nearest
from hydrohil.thesis import appendix, beyond_impedance, beyond_position, beyond_stiffness, chapter4, chapter5, chapter6, chapter7

_CHAPTERS = (chapter4, chapter5, chapter6, chapter7, appendix, beyond_position, beyond_impedance, beyond_stiffness)


@cache
def catalogue() -> tuple[Experiment, ...]:
    """All experiments in the order of the thesis."""
    return tuple(experiment for chapter in _CHAPTERS for experiment in chapter.EXPERIMENTS)


@cache
def pairs() -> tuple[PairClaim, ...]:
    """All claims about two trials at once."""
    return tuple(claim for chapter in _CHAPTERS for claim in chapter.PAIRS)


SECOND_FIGURES = {"fig-5-10": "fig-5-9", "fig-5-12": "fig-5-11"}  # history plots of a trial that is named after its motion plot


@cache
def _index() -> dict[str, Experiment]:
    named = {experiment.name: experiment for experiment in catalogue()}
    second = {figure: named[name] for figure, name in SECOND_FIGURES.items()}
    return {**{experiment.alias: experiment for experiment in catalogue()}, **second, **named}


def find(name_or_alias: str) -> Experiment:
    """The experiment of that name, alias or second figure. Raises ExperimentError with the nearest names."""
    known = _index()
    if name_or_alias not in known:
        hint = nearest(name_or_alias, known, "those that `hydrohil list` shows")
        raise ExperimentError([f"{name_or_alias} is no experiment: use one of {hint}"])
    return known[name_or_alias]


def load(name: str | Path) -> Experiment:
    """An experiment that ships, by name (`fig-5-5`) or alias, or one of a TOML file: a path, or text that ends in `.toml`.

    Raises ExperimentError: with the nearest names where nothing is called so, with one line a problem where the file is no
    experiment. `catalogue` lists what ships.
    """
    if not isinstance(name, str | Path):
        raise ExperimentError([f'expected a name such as "fig-5-5", or a TOML file, not {type(name).__name__}'])
    is_file = isinstance(name, Path) or name.endswith(".toml") or os.sep in name
    return from_toml(Path(name), find) if is_file else find(str(name))
