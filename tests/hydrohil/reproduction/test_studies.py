import math
from functools import cache

import numpy as np
import pytest

from hydrohil.claims.claims import UNITS
from hydrohil.reproduction.explanations import explanation
from hydrohil.reproduction.studies import STUDIES
from hydrohil.thesis.library import catalogue, find

COMPUTED = [study for study in STUDIES if not study.trials]


@cache
def studied(study):
    return study.run(())


def test_every_study_has_a_name_of_its_own():
    names = [name for entry in (*STUDIES, *catalogue()) for name in {entry.name, entry.alias}]
    assert len(names) == len(set(names))


def test_the_computed_figures_of_the_thesis_are_there():
    figures = {"4-12", "4-13", "4-14", "4-15", "6-4", "9-1", "9-2", "9-7", "9-8"}
    assert {study.name for study in STUDIES} >= {f"fig-{figure}" for figure in figures}


def test_studies_ask_for_trials_that_ship():
    for study in STUDIES:
        for name in study.trials:
            assert find(name).duration_s > 0.0


@pytest.mark.parametrize("study", COMPUTED, ids=lambda study: study.name)
def test_a_computed_figure_has_curves_of_finite_numbers_and_quotes_what_it_is_held_against(study):
    panels, verdicts = studied(study)
    assert panels and study.source.startswith("thesis ")
    for curve in (curve for panel in panels for curve in panel.curves):
        assert curve.x.shape == curve.y.shape
        assert np.all(np.isfinite(curve.x)) and np.all(np.isfinite(curve.y))
    for claim, measured, _ in verdicts:
        assert claim.source.startswith("thesis ") and '"' in claim.source
        assert claim.unit in UNITS
        assert math.isfinite(measured)


@pytest.mark.parametrize("study", COMPUTED, ids=lambda study: study.name)
def test_what_follows_from_the_texts_own_formulae_holds(study):
    disagree = {verdict.claim.statement for verdict in studied(study).verdicts if not verdict.holds}
    assert disagree == {statement for statement in disagree if explanation(study.name, statement)}
    assert not disagree or study.name in {"largest-gain", "linear-stability"}  # where the linear model and the text part
