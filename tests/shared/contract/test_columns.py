import math
from typing import get_type_hints

import numpy as np
import pytest
from annotated_types import Len

from hydrohil.services.recorder.writer import WITHOUT_ROWS
from hydrohil.shared.contract.columns import GROUND_TRUTH_FIGURES, column_names, figure_values, figures, flat_rows
from hydrohil.shared.contract.converters import ZERO_CODE, code_to_current
from hydrohil.shared.contract.messages import Command, ControllerState, GroundTruth, Permit, Sample
from hydrohil.shared.contract.topics import TOPICS, Topic
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.recorder_trial import DESCRIPTION, exact, received, trial

ANY = received("controller/command", Command((2048,) * 3), 0).header


def first(message: type, skip: int = 700):
    return [m for m in trial(400) if isinstance(m.body, message)][skip]


@pytest.mark.parametrize("message", [Sample, GroundTruth, ControllerState, Permit, Command])
def test_every_scalar_of_a_message_has_one_name(message: type):
    m = first(message)
    names = column_names(m.body, m.header)
    assert flat_rows([m.body], [m.header.seq]).tolist() == exact([m])
    assert len(names) == len(exact([m])[0]) == len(set(names))
    assert names[0] == "header.seq"


def test_arrays_are_named_by_their_own_length_so_that_another_machine_fits():
    assert column_names(Command((1, 2, 3, 4, 5))) == tuple(f"dac_counts[{i}]" for i in range(5))


@pytest.mark.parametrize("message", [Sample, GroundTruth, ControllerState, Permit])
def test_every_figure_finds_its_columns(message: type):
    m = first(message)
    names, matrix = column_names(m.body, m.header), flat_rows([m.body], [m.header.seq])
    drawn = figures(message, DESCRIPTION.machine.converters)
    assert drawn
    for figure in drawn:
        values = figure_values(figure, names, matrix)
        assert values is not None and values.shape == (1, len(figure.curves)), figure.entity


def test_the_valve_figure_shows_the_current_that_the_codes_drive():
    sample = first(Sample).body._replace(dac_counts=(ZERO_CODE, 3276, 820))
    figure = figures(Sample, DESCRIPTION.machine.converters)[0]
    values = figure_values(figure, column_names(sample, ANY), flat_rows([sample], [0]))
    expected = [0.0, 1e3 * code_to_current(UNIMATE.drive, 3276), 1e3 * code_to_current(UNIMATE.drive, 820)]
    np.testing.assert_allclose(values, [expected], atol=1e-9)


def test_the_error_is_set_point_minus_measured_in_degrees():
    state = first(ControllerState).body._replace(q_set=(0.2, 0.1, 0.5), q=(0.1, 0.1, 0.4))
    figure = next(f for f in figures(ControllerState) if f.entity == "figure/error/angle")
    values = figure_values(figure, column_names(state, ANY), flat_rows([state], [0]))
    np.testing.assert_allclose(values, [[math.degrees(0.1), 0.0]], atol=1e-12)


def test_a_message_without_the_column_draws_no_figure():
    assert figure_values(GROUND_TRUTH_FIGURES[0], ("number",), np.zeros((3, 1))) is None


def test_nan_and_infinity_stay_what_they_are():
    permit = first(Permit).body._replace(measured=math.nan, limit=math.inf)
    row = dict(zip(column_names(permit, ANY), flat_rows([permit], [0])[0], strict=True))
    assert math.isnan(row["measured"]) and row["limit"] == math.inf


@pytest.mark.parametrize("topic", [topic for topic in TOPICS if topic.message not in WITHOUT_ROWS], ids=lambda topic: topic.key)
def test_what_is_written_as_rows_has_arrays_of_one_length(topic: Topic):
    for field, hint in get_type_hints(topic.message, include_extras=True).items():
        bounds = [bound for bound in getattr(hint, "__metadata__", ()) if isinstance(bound, Len)]
        lengths = {length for bound in bounds for length in (bound.min_length, bound.max_length)}
        assert len(lengths) == (0 if hint in (int, float) else 1), field
