import numpy as np
import pytest

from hydrohil.services.recorder.state_timeline import STATE_TIMELINES, changes
from hydrohil.shared.contract.columns import column_names
from hydrohil.shared.contract.messages import GateCause, GateState, Mode, Permit, TripCause
from tests.support.recorder_trial import trial


def test_only_changes_are_written_and_the_first_row_is_one():
    assert changes(np.array([0.0, 0.0, 1.0, 1.0, 0.0]), None).tolist() == [0, 2, 4]
    assert changes(np.array([0.0, 0.0, 1.0, 1.0, 0.0]), 0.0).tolist() == [2, 4]
    assert changes(np.empty(0), 0.0).tolist() == []


@pytest.mark.parametrize(
    ("timeline", "members"), [("supervisor", Mode), ("trip", TripCause), ("gate", GateState), ("gate cause", GateCause)]
)
def test_every_mode_has_a_label_of_its_own(timeline: str, members: type):
    found = next(row for rows in STATE_TIMELINES.values() for row in rows if row.title == timeline)
    assert len({found.text(float(m)) for m in members}) == len(members)


def test_a_number_without_a_label_is_shown_as_it_is():
    timeline = STATE_TIMELINES[Permit][0]
    assert timeline.text(99.0) == "99"
    assert timeline.text(float("nan")) == "nan"


@pytest.mark.parametrize("message", list(STATE_TIMELINES))
def test_every_timeline_names_a_column_of_its_message(message: type):
    body = next(m.body for m in trial(1) if isinstance(m.body, message))
    assert {timeline.column for timeline in STATE_TIMELINES[message]} <= set(column_names(body))
