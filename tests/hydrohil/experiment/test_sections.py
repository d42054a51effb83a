"""The one place from which packages above take the services' sections and thresholds."""

from types import FunctionType
from typing import get_type_hints

import pytest

from hydrohil.experiment import criteria, sections
from hydrohil.experiment.experiment import Experiment


@pytest.mark.parametrize("module", [sections, criteria])
def test_every_name_is_there_and_comes_from_a_service(module):
    assert sorted(module.__all__) == sorted(set(module.__all__))
    for name in module.__all__:
        value = getattr(module, name)
        assert not isinstance(value, type | FunctionType) or value.__module__.startswith("hydrohil.services."), name


def test_the_sections_of_an_experiment_are_among_them():
    hints = get_type_hints(Experiment)
    assert {hints[name].__name__ for name in ("plant", "controller", "supervisor")} <= set(sections.__all__)
