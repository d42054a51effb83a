"""Faults of sensors and actuators on the local clock: which rule finds each, and at which tick."""

import math

import pytest

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.supervisor.params import observer_params
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import Mode, TripCause
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.simulation.rollout import play_local
from hydrohil.thesis.library import find

AT_S, TICKS_PER_S = 2.0, 1.0 / 0.0045
FIRST = math.ceil(AT_S * TICKS_PER_S)
AT_ONCE = [  # kind, target, value, the cause
    ("garbage", "force", 0.0, TripCause.FORCE_INVALID),
    ("dropout", "force", 0.0, TripCause.FORCE_INVALID),
    ("offset", "force", 400.0, TripCause.FORCE_RAW),
    *(("dropout", f"encoder_{link}", 0.0, TripCause.ENCODER_INVALID) for link in ("rotate", "down_up", "out_in")),
    *(("garbage", f"encoder_{link}", 0.0, TripCause.ENCODER_JUMP) for link in ("rotate", "down_up", "out_in")),
    *(("offset", f"encoder_{link}", 50.0, TripCause.ENCODER_JUMP) for link in ("rotate", "down_up", "out_in")),
    *(("wrap", f"encoder_{link}", 0.0, TripCause.ENCODER_JUMP) for link in ("rotate", "down_up", "out_in")),
]
EXPERIMENTS = ("fig-4-25", "fig-5-5", "fig-5-9")


def broken(name, kind, target, value=0.0, at_s=AT_S):
    experiment = find(name)
    outcome = play_local(experiment._replace(faults=(Fault(kind, target, at_s, 0.0, value),)), 0)
    assert outcome.supervisor.mode == Mode.TRIPPED
    assert outcome.gate.codes == (2048, 2048, 2048)
    return outcome


@pytest.mark.parametrize("name", EXPERIMENTS)
@pytest.mark.parametrize(("kind", "target", "value", "cause"), AT_ONCE)
def test_what_shows_in_one_sample_trips_at_that_sample(name, kind, target, value, cause):
    outcome = broken(name, kind, target, value)
    assert (outcome.supervisor.cause, outcome.rows.tick[-1]) == (cause, FIRST)


@pytest.mark.parametrize("name", EXPERIMENTS)
@pytest.mark.parametrize(("kind", "value"), [("stuck", 0.0), ("noise", 0.0)])
def test_a_gauge_without_its_noise_trips_within_100_ms(name, kind, value):
    outcome = broken(name, kind, "force", value)
    assert outcome.supervisor.cause == TripCause.FORCE_FROZEN
    assert 0 < outcome.rows.tick[-1] - FIRST <= 22


@pytest.mark.parametrize(("name", "value"), [("fig-4-25", -100.0), ("fig-5-5", 100.0), ("fig-5-5", -100.0), ("fig-5-9", 100.0)])
def test_a_jump_of_the_gauge_trips_within_100_ms(name, value):
    outcome = broken(name, "offset", "force", value)
    assert outcome.supervisor.cause in (TripCause.FORCE_JUMP, TripCause.FORCE_BELOW_BIAS)
    assert outcome.rows.tick[-1] - FIRST <= 22


@pytest.mark.parametrize(
    ("name", "value", "cause"),
    [
        ("fig-5-5", 100.0, TripCause.FORCE_DRIFT),
        ("fig-4-25", -100.0, TripCause.FORCE_BELOW_BIAS),
        ("fig-5-9", -100.0, TripCause.FORCE_BELOW_BIAS),
    ],
)
def test_a_gauge_that_drifts_trips_before_it_reads_its_limit(name, value, cause):
    outcome = broken(name, "drift", "force", value)
    assert outcome.supervisor.cause == cause
    assert outcome.rows.tick[-1] - FIRST < 334.0 / abs(value) * TICKS_PER_S


@pytest.mark.parametrize(
    ("name", "kind", "target", "value"),
    [
        ("fig-4-25", "stuck", "encoder_down_up", 0.0),
        ("fig-4-25", "leak", "valve_down_up", 1000.0),
        ("fig-4-25", "drop", "supply", 1.0),
        ("fig-5-9", "stuck", "encoder_down_up", 0.0),
        ("fig-5-9", "stuck", "encoder_out_in", 0.0),
        ("fig-5-9", "stuck", "valve_out_in", 0.0),
        ("fig-5-9", "stuck", "dac_out_in", 0.0),
        ("fig-5-9", "drop", "supply", 1.0),
        ("fig-4-25", "stuck", "valve_down_up", 0.0),
        ("fig-4-25", "stuck", "dac_down_up", 0.0),
    ],
)
def test_a_link_that_does_not_obey_trips_within_200_ms_of_a_current_that_must_move_it(name, kind, target, value):
    outcome = broken(name, kind, target, value)
    experiment = find(name)
    described = describe(experiment.plant, GateLimits())
    codes = observer_params(experiment.supervisor, described, 1).codes
    driven_ns = 0
    for row in reversed(outcome.rows.dac_counts[outcome.rows.tick >= FIRST][:-1]):
        if not any(row[i] >= codes.high[i] or row[i] <= codes.low[i] for i in range(3)):
            break
        driven_ns += described.sample_period_ns
    assert outcome.supervisor.cause in (TripCause.NO_MOTION, TripCause.MOTION_AGAINST)
    assert driven_ns <= UNIMATE.motion.moves_within_ns + 12 * described.sample_period_ns  # what moved goes on for a moment


def test_a_fault_of_a_trial_that_nothing_shows_trips_nothing():
    experiment = find("fig-5-5")
    still = play_local(experiment._replace(faults=(Fault("stuck", "encoder_rotate", AT_S),), duration_s=3.0), 0)
    assert still.supervisor.mode == Mode.RUNNING
