import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.supervisor.modes import Event
from hydrohil.services.supervisor.observe import Bias, LinkHealth, SampleContext, observe_step, observer_start
from hydrohil.services.supervisor.params import below_gate, supervisor_params
from hydrohil.services.supervisor.rules import first_broken
from hydrohil.services.supervisor.state import SupervisorMemory
from hydrohil.services.supervisor.step import supervisor_step
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, GateCause, GateState, Mode, TripCause
from hydrohil.shared.contract.pose import forward, joint_positions
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.supervisor_scene import (
    BIAS,
    CONFIG,
    DESCRIPTION,
    DURATION,
    LEVEL,
    N_PER_COUNT,
    PARAMS,
    asked,
    running,
    sample,
    step,
    watched,
)

HEAVY = 300  # counts: 405 N, above 334 + 60 N
AT_REST = SampleContext(False, 0, True, LinkHealth(0, 0, 0, 1))
DISARMED = SupervisorMemory()
TOWARDS_LOW = (-1, 1, -1)  # counts; down/up counts downwards
STOPS = [(Event.ESTOP, GateCause.NONE), (Event.NOTHING, GateCause.ESTOP)]
supervisor_step_compiled = compiled(supervisor_step)


def tripped(**changes):
    return step(running(), sample(50, 5, force_counts=HEAVY, **changes))


def armed(at=10):
    return step(DISARMED, sample(at), asked(Event.ARM))


def started(at=20):
    return step(armed(at - 1), sample(at), asked(Event.START))


def test_a_supervisor_begins_disarmed_with_nothing_latched_and_no_sample():
    nothing = (0, 0, 0.0, 0.0, NO_COMMAND, NO_COMMAND, 0, 0, (0, 0, 0), observer_start(), False)
    assert SupervisorMemory() == (Mode.DISARMED, *nothing)


def test_an_arming_id_is_drawn_on_arming_and_stays_until_disarmed():
    memory = armed()
    assert (memory.mode, memory.arming_id, memory.armed_at) == (Mode.ARMED, 4711, 10)
    later = step(memory, sample(11), asked(new_arming_id=99))
    assert later.arming_id == 4711
    assert step(later, sample(12), asked(Event.START, new_arming_id=99)).arming_id == 4711
    assert step(later, sample(12), asked(Event.STOP, new_arming_id=99)).arming_id == 0


@pytest.mark.parametrize("event", [event for event in Event if event not in (Event.ARM, Event.ESTOP)])
def test_nothing_but_arm_draws_a_number_for_a_disarmed_machine(event):
    memory = step(DISARMED, sample(10), asked(event))
    assert (memory.mode, memory.arming_id) == (Mode.DISARMED, 0)


def test_arming_is_refused_unless_all_agree_and_nothing_is_broken():
    assert step(DISARMED, sample(10), asked(Event.ARM, agreed=False)).mode == Mode.DISARMED
    assert step(DISARMED, sample(10, force_counts=HEAVY), asked(Event.ARM)).mode == Mode.DISARMED


def test_armed_times_out_after_sixty_seconds_and_not_a_sample_earlier():
    memory, samples = armed(), 60_000_000_000 // DESCRIPTION.sample_period_ns
    assert step(memory, sample(10 + samples)).mode == Mode.ARMED
    assert step(memory, sample(10 + samples + 1)).mode == Mode.DISARMED
    assert step(memory, sample(10 + samples + 1), asked(Event.START)).mode == Mode.DISARMED


def test_the_first_sample_is_announced_a_quarter_second_ahead():
    memory, permit = supervisor_step(armed(), PARAMS, sample(20), asked(Event.START))
    assert (memory.mode, permit.mode, permit.first_sample) == (Mode.RUNNING, Mode.RUNNING, 20 + 250_000_000 // 4_500_000)
    assert (permit.duration_ticks, permit.tare_ticks) == (DURATION, BIAS)
    assert step(memory, sample(21), asked(Event.START)).first_sample == memory.first_sample


def test_a_trial_ends_at_its_declared_sample():
    memory = running(tick=DURATION - 2)
    last = step(memory, sample(50, DURATION - 1))
    assert last.mode == Mode.RUNNING
    end = step(running(tick=DURATION), sample(50))
    assert (end.mode, end.arming_id, end.cause, end.first_sample) == (Mode.DISARMED, 0, TripCause.NONE, NO_COMMAND)


def test_a_trip_latches_cause_numbers_and_sample_and_loses_the_arming():
    memory, permit = supervisor_step(running(), PARAMS, sample(50, 5, force_counts=HEAVY), asked())
    assert (memory.mode, memory.arming_id, memory.cause, memory.trip_number) == (Mode.TRIPPED, 0, TripCause.FORCE_RAW, 50)
    assert (memory.measured, memory.limit) == (HEAVY * N_PER_COUNT, CONFIG.raw_force_limit_n)
    assert (permit.mode, permit.cause, permit.measured, permit.limit, permit.trip_number) == (
        Mode.TRIPPED,
        TripCause.FORCE_RAW,
        memory.measured,
        memory.limit,
        50,
    )
    later = step(memory, sample(51, 6, force_counts=600))  # worse, but the first cause stays
    assert (later.cause, later.measured, later.trip_number, later.first_sample) == (
        memory.cause,
        memory.measured,
        50,
        NO_COMMAND,
    )


def test_a_reset_is_refused_while_the_cause_stands_and_clears_it_afterwards():
    memory = tripped()
    refused = step(memory, sample(51, force_counts=HEAVY), asked(Event.RESET))
    assert (refused.mode, refused.cause) == (Mode.TRIPPED, TripCause.FORCE_RAW)
    jumped = step(refused, sample(52), asked(Event.RESET))
    assert jumped.mode == Mode.TRIPPED  # the reading fell further than motion explains
    for number in range(53, 65):  # and fast
        jumped = step(jumped, sample(number))
    reset = step(jumped, sample(65), asked(Event.RESET))
    assert (reset.mode, reset.arming_id, reset.cause, reset.measured, reset.limit) == (Mode.DISARMED, 0, 0, 0.0, 0.0)
    assert (reset.trip_number, reset.first_sample, reset.recover_signs) == (NO_COMMAND, NO_COMMAND, (0, 0, 0))


@pytest.mark.parametrize(("event", "at_gate"), STOPS)
def test_an_emergency_stop_at_either_place_names_itself_even_when_a_rule_breaks_too(event, at_gate):
    stopped = sample(50, 5, force_counts=HEAVY, gate=GateState.REVOKED, gate_cause=int(at_gate))
    memory = step(running(), stopped, asked(event))
    assert (memory.mode, memory.cause, memory.measured, memory.limit, memory.arming_id) == (
        Mode.TRIPPED,
        TripCause.ESTOP,
        0.0,
        0.0,
        0,
    )


def test_samples_that_stop_trip_a_running_trial():
    memory = step(running(observer=watched(50)), sample(50, 5), asked(stale_ns=20_000_001))
    assert (memory.mode, memory.cause) == (Mode.TRIPPED, TripCause.SAMPLE_STALE)
    assert (memory.measured, memory.limit) == pytest.approx((0.020000001, 0.02))


@pytest.mark.parametrize(("number", "mode"), [(50, Mode.RUNNING), (54, Mode.RUNNING), (55, Mode.TRIPPED)])
def test_a_lease_of_lost_samples_is_borne_and_one_more_trips(number, mode):
    memory = step(running(), sample(number, number - 45))
    assert (memory.mode, memory.observer.last_number) == (mode, number)
    assert memory.cause == (TripCause.NONE if mode == Mode.RUNNING else TripCause.SAMPLE_LOST)


@pytest.mark.parametrize("number", [0, 49])
def test_a_plant_that_starts_anew_trips_a_running_trial(number):
    memory = step(running(), sample(number, NO_TRIAL))
    assert (memory.mode, memory.cause) == (Mode.TRIPPED, TripCause.SAMPLE_LOST)


@pytest.mark.parametrize(("lag", "mode"), [(1, Mode.RUNNING), (5, Mode.RUNNING), (6, Mode.TRIPPED), (-1, Mode.TRIPPED)])
def test_a_controller_that_does_not_advance_trips(lag, mode):
    assert step(running(), sample(50, 5, command_number=50 - lag)).mode == mode


def test_a_gate_that_has_cut_trips():
    memory = step(running(), sample(50, 5, gate=int(GateState.REVOKED)))
    assert (memory.mode, memory.cause) == (Mode.TRIPPED, TripCause.GATE_CUT)


@pytest.mark.parametrize("tick", [-1, 0, 1])
def test_a_controller_that_is_not_ready_trips_even_if_the_sample_before_tick_0_is_lost(tick):
    start = running(tick=tick)
    assert step(start, sample(50, tick)).mode == Mode.RUNNING
    memory = step(start, sample(50, tick), asked(controller_ready=False))
    assert (memory.mode, memory.cause) == (Mode.TRIPPED, TripCause.NOT_READY)
    assert step(running(tick=-2), sample(50, -2), asked(controller_ready=False)).mode == Mode.RUNNING


@pytest.mark.parametrize("tick", [-1, 0, 1])
def test_a_bias_above_its_limit_trips_even_if_the_sample_before_tick_0_is_lost(tick):
    counts = math.ceil(61.0 / N_PER_COUNT)
    bias_n = counts * N_PER_COUNT
    biased = running(tick=tick, observer=watched(49, bias=Bias(bias_n, 0.0, bias_n * BIAS, bias_n * bias_n * BIAS, BIAS)))
    memory = step(biased, sample(50, tick, force_counts=counts))
    assert (memory.mode, memory.cause, memory.limit) == (Mode.TRIPPED, TripCause.BIAS, 60.0)


def test_recovery_draws_its_own_arming_and_shows_the_unloading_signs():
    memory, permit = supervisor_step(
        tripped(), PARAMS, sample(51, force_counts=HEAVY), asked(Event.HOLD_RECOVER, new_arming_id=88)
    )
    assert (memory.mode, memory.arming_id, permit.mode) == (Mode.RECOVER, 88, Mode.RECOVER)
    assert permit.recover_signs == memory.recover_signs != (0, 0, 0)
    held = step(memory, sample(52, force_counts=HEAVY), asked(Event.HOLD_RECOVER, new_arming_id=89))
    assert held.arming_id == 88
    released, shown = supervisor_step(held, PARAMS, sample(53, force_counts=HEAVY), asked(Event.RELEASE))
    assert (released.mode, released.arming_id, released.cause, shown.recover_signs) == (
        Mode.TRIPPED,
        0,
        TripCause.FORCE_RAW,
        (0, 0, 0),
    )
    again = step(released, sample(54, force_counts=HEAVY), asked(Event.HOLD_RECOVER, new_arming_id=90))
    assert (again.mode, again.arming_id) == (Mode.RECOVER, 90)


def test_recovery_lasts_as_long_as_its_lease_is_renewed_and_not_a_sample_longer():
    lease = 300_000_000 // DESCRIPTION.sample_period_ns
    memory = step(tripped(), sample(51, force_counts=HEAVY), asked(Event.HOLD_RECOVER))
    let_go = step(memory, sample(51 + lease - 1, force_counts=HEAVY))
    assert let_go.mode == Mode.RECOVER
    assert step(let_go, sample(51 + lease, force_counts=HEAVY)).mode == Mode.TRIPPED
    renewed = step(memory, sample(51 + lease - 1, force_counts=HEAVY), asked(Event.HOLD_RECOVER))
    assert step(renewed, sample(51 + lease, force_counts=HEAVY)).mode == Mode.RECOVER


def test_a_recovery_that_is_let_go_keeps_what_tripped_first_whatever_stands_now():
    memory = tripped()
    for number in range(51, 65):
        memory = step(memory, sample(number))
    memory = step(memory, sample(65), asked(Event.HOLD_RECOVER))
    for current in (sample(66), sample(66, gate=int(GateState.REVOKED), force_counts=HEAVY)):
        let_go = step(memory, current, asked(Event.RELEASE))
        assert (let_go.mode, let_go.cause, let_go.trip_number) == (Mode.TRIPPED, TripCause.FORCE_RAW, 50)
        assert (let_go.measured, let_go.limit) == (HEAVY * N_PER_COUNT, CONFIG.raw_force_limit_n)


def test_recovery_from_a_joint_limit_trips_anew_on_a_force():
    outside = (4031, 10, 207, 0, 33)  # link 2 at +27.3 deg
    memory = step(running(observer=watched(49, encoder_counts=outside)), sample(50, 5, encoder_counts=outside))
    assert (memory.cause, memory.recover_signs) == (TripCause.JOINT_LIMIT, (0, -1, 0))
    memory = step(memory, sample(51, encoder_counts=outside), asked(Event.HOLD_RECOVER))
    assert memory.mode == Mode.RECOVER
    memory = step(memory, sample(52, encoder_counts=outside, force_counts=HEAVY))
    assert (memory.mode, memory.cause, memory.trip_number) == (Mode.TRIPPED, TripCause.FORCE_RAW, 52)


def beyond(link):
    """Counts of the arm with this link just beyond its limit, and a count further in."""
    outside, inside = list(LEVEL), list(LEVEL)
    while CONFIG.joint_low_q[link] <= joint_positions(PARAMS.observer.calibration, tuple(outside))[0][link]:
        inside[link], outside[link] = outside[link], outside[link] + TOWARDS_LOW[link]
    return tuple(outside), tuple(inside)


@pytest.mark.parametrize("link", range(3))
def test_recovery_goes_on_while_its_cause_stands_and_when_it_has_gone(link):
    outside, inside = beyond(link)
    memory = step(running(observer=watched(49, encoder_counts=outside)), sample(50, 5, encoder_counts=outside))
    signs = tuple(int(i == link) for i in range(3))
    for number, counts in ((51, outside), (52, outside), (53, inside), (54, inside)):
        memory = step(memory, sample(number, encoder_counts=counts), asked(Event.HOLD_RECOVER))
        assert (memory.mode, memory.cause, memory.recover_signs) == (Mode.RECOVER, TripCause.JOINT_LIMIT, signs)


def test_a_latched_direction_is_recovered_in_after_its_cause_has_gone():
    memory = tripped()
    for number in range(51, 65):
        memory = step(memory, sample(number))
    assert first_broken(observe_step(memory.observer, PARAMS.observer, sample(65), AT_REST)[1], PARAMS.limits)[0] == 0
    memory = step(memory, sample(65), asked(Event.HOLD_RECOVER))
    assert (memory.mode, memory.cause, memory.recover_signs) == (Mode.RECOVER, TripCause.FORCE_RAW, (0, -1, 0))


def test_what_stands_now_is_recovered_from_where_the_latched_cause_led_nowhere():
    outside, inside = beyond(0)
    cut = sample(50, 5, encoder_counts=inside, gate=int(GateState.REVOKED))
    memory = step(running(observer=watched(49, encoder_counts=inside)), cut)
    assert (memory.cause, memory.recover_signs) == (TripCause.GATE_CUT, (0, 0, 0))
    memory = step(memory, sample(51, encoder_counts=outside), asked(Event.HOLD_RECOVER))
    assert (memory.mode, memory.cause, memory.recover_signs) == (Mode.RECOVER, TripCause.JOINT_LIMIT, (1, 0, 0))


def test_recovery_of_two_joints_goes_on_when_the_first_of_them_is_back():
    (low, inside), other = beyond(0), beyond(1)[0][1]
    both, one = (low[0], other, *LEVEL[2:]), (inside[0], other, *LEVEL[2:])
    memory = step(running(observer=watched(49, encoder_counts=both)), sample(50, 5, encoder_counts=both))
    for number, counts in ((51, both), (52, one)):
        memory = step(memory, sample(number, encoder_counts=counts), asked(Event.HOLD_RECOVER))
        assert (memory.mode, memory.recover_signs) == (Mode.RECOVER, (1, 1, 0))


@pytest.mark.parametrize(("axis", "sign"), [(2, 1.0), (2, -1.0), (0, 1.0), (0, -1.0)])
def test_the_unloading_sign_moves_the_tip_the_way_the_environment_pushes(axis, sign):
    params = PARAMS._replace(observer=PARAMS.observer._replace(force_axis=axis, force_sign=sign))
    memory = supervisor_step(running(), params, sample(50, 5, force_counts=HEAVY), asked())[0]
    q, pitch_rad = joint_positions(params.observer.calibration, LEVEL)
    moved = tuple(a + 0.01 * b for a, b in zip(q, memory.recover_signs, strict=True))
    assert sum(map(abs, memory.recover_signs)) == 1
    way_m = forward(UNIMATE.geometry, moved, pitch_rad)[axis] - forward(UNIMATE.geometry, q, pitch_rad)[axis]
    assert way_m * sign > 0.004


def test_a_joint_limit_that_outlasts_the_force_is_recovered_from_in_its_own_direction():
    outside = (100, 971, 207, 0, 33)  # link 1 at -110.8 deg
    memory = step(
        running(observer=watched(49, encoder_counts=outside)), sample(50, 5, encoder_counts=outside, force_counts=HEAVY)
    )
    assert (memory.cause, memory.recover_signs) == (TripCause.FORCE_RAW, (0, -1, 0))
    memory = step(memory, sample(51, encoder_counts=outside, force_counts=HEAVY), asked(Event.HOLD_RECOVER))
    assert (memory.mode, memory.cause, memory.recover_signs) == (Mode.RECOVER, TripCause.FORCE_RAW, (0, -1, 0))
    for number in range(52, 65):
        memory = step(memory, sample(number, encoder_counts=outside), asked(Event.HOLD_RECOVER))
        if memory.mode == Mode.TRIPPED:
            break
    assert (memory.mode, memory.cause, memory.recover_signs) == (Mode.TRIPPED, TripCause.JOINT_LIMIT, (1, 0, 0))
    memory = step(memory, sample(70, encoder_counts=outside), asked(Event.HOLD_RECOVER))
    assert (memory.mode, memory.recover_signs) == (Mode.RECOVER, (1, 0, 0))


def test_what_stands_when_recovery_begins_leads_the_way():
    outside = (100, 971, 207, 0, 33)
    memory = step(
        running(observer=watched(49, encoder_counts=outside)), sample(50, 5, encoder_counts=outside), asked(Event.ESTOP)
    )
    assert (memory.cause, memory.recover_signs) == (TripCause.ESTOP, (0, -1, 0))
    memory = step(memory, sample(50, encoder_counts=outside), asked(Event.RESET))
    memory = step(memory, sample(51, encoder_counts=outside), asked(Event.HOLD_RECOVER))
    assert (memory.mode, memory.cause, memory.recover_signs) == (Mode.RECOVER, TripCause.JOINT_LIMIT, (1, 0, 0))
    assert memory.trip_number == 51
    blind = step(memory, sample(52, encoder_counts=(0, 971, 207, 0, 33)), asked(Event.HOLD_RECOVER))
    assert (blind.mode, blind.cause, blind.recover_signs) == (Mode.TRIPPED, TripCause.ENCODER_INVALID, (0, 0, 0))


@pytest.mark.parametrize(("event", "at_gate"), STOPS)
@pytest.mark.parametrize("when", ["running", "tripped", "recovering"])
def test_a_stop_that_is_pressed_is_not_recovered_from_before_a_reset_has_released_it(event, at_gate, when):
    heavy = {"force_counts": HEAVY}
    memory = running() if when == "running" else tripped()
    if when == "recovering":
        memory = step(memory, sample(51, **heavy), asked(Event.HOLD_RECOVER))
        assert memory.mode == Mode.RECOVER
    memory = step(memory, sample(52, **heavy, gate_cause=int(at_gate)), asked(event))
    for number in range(53, 60):
        memory = step(memory, sample(number, **heavy), asked(Event.HOLD_RECOVER))
        assert (memory.mode, memory.pressed) == (Mode.TRIPPED, True)
    refused = step(memory, sample(60, **heavy), asked(Event.RESET))
    assert (refused.mode, refused.pressed, refused.cause) == (Mode.TRIPPED, False, memory.cause)
    again = step(refused, sample(61, **heavy), asked(Event.HOLD_RECOVER))
    assert (again.mode, again.recover_signs) == (Mode.RECOVER, (0, -1, 0))


def test_a_reset_releases_no_stop_that_is_pressed_at_the_gate():
    pressed = {"gate": int(GateState.REVOKED), "gate_cause": int(GateCause.ESTOP)}
    memory = step(step(running(), sample(50, 5, **pressed)), sample(51, **pressed), asked(Event.RESET))
    assert (memory.mode, memory.pressed) == (Mode.TRIPPED, True)
    assert not step(memory, sample(52), asked(Event.RESET)).pressed


def test_among_force_causes_recovery_goes_on():
    memory = step(step(running(), sample(50, 5, force_counts=280)), sample(51, force_counts=280), asked(Event.HOLD_RECOVER))
    assert (memory.mode, memory.cause) == (Mode.RECOVER, TripCause.FORCE_TARED)
    worse = step(memory, sample(52, force_counts=HEAVY), asked(Event.HOLD_RECOVER))
    assert (worse.mode, worse.cause) == (Mode.RECOVER, TripCause.FORCE_TARED)


@pytest.mark.parametrize(
    ("counts", "signs"),
    [((100, 971, 207, 0, 33), (1, 0, 0)), ((8000, 971, 207, 0, 33), (-1, 0, 0)), ((4031, 2035, 207, 0, 33), (0, 1, 0))],
)
def test_beyond_a_joint_limit_recovery_leads_inward(counts, signs):
    memory = step(running(observer=watched(49, encoder_counts=counts)), sample(50, 5, encoder_counts=counts))
    assert (memory.cause, memory.recover_signs) == (TripCause.JOINT_LIMIT, signs)


def test_a_joint_on_its_limit_is_led_nowhere_while_another_is_led_back():
    counts = beyond(1)[0]
    q = joint_positions(PARAMS.observer.calibration, counts)[0]
    low, high = CONFIG.joint_low_q[1], CONFIG.joint_high_q[1]
    for lows, highs in (((q[0], low, -9.0), (9.0, high, q[2])), ((-9.0, low, q[2]), (q[0], high, 9.0))):
        limits = PARAMS.limits._replace(config=CONFIG._replace(joint_low_q=lows, joint_high_q=highs))
        stands = running(observer=watched(49, encoder_counts=counts))
        memory = step(stands, sample(50, 5, encoder_counts=counts), params=PARAMS._replace(limits=limits))
        assert (memory.cause, memory.recover_signs) == (TripCause.JOINT_LIMIT, (0, 1, 0))


@pytest.mark.parametrize("link", range(3))
@pytest.mark.parametrize("sign", [-1, 1])
def test_each_joint_is_led_back_by_its_own_limits_and_no_other(link, sign):
    counts = (2000, 600, 700, 0, 33)
    q = joint_positions(PARAMS.observer.calibration, counts)[0]
    assert min(abs(a - b) for a, b in itertools.combinations(q, 2)) > 0.2
    middle = tuple(q + 0.02 * sign * (i == link) for i, q in enumerate(q))
    lows, highs = (tuple(q + way for q in middle) for way in (-0.01, 0.01))
    limits = PARAMS.limits._replace(config=CONFIG._replace(joint_low_q=lows, joint_high_q=highs))
    stands = running(observer=watched(49, encoder_counts=counts))
    memory = step(stands, sample(50, 5, encoder_counts=counts), params=PARAMS._replace(limits=limits))
    assert (memory.cause, memory.recover_signs) == (TripCause.JOINT_LIMIT, tuple(sign * (i == link) for i in range(3)))


def test_the_last_of_the_force_causes_has_a_direction_too():
    biased = watched(49, bias=Bias(50.0, 0.0, 0.0, 0.0, BIAS))
    memory = step(running(observer=biased), sample(50, 5))
    assert (memory.cause, memory.recover_signs) == (TripCause.FORCE_BELOW_BIAS, (0, -1, 0))
    for number, counts in ((51, 4), (52, HEAVY)):  # a worse one among them does not end its recovery
        memory = step(memory, sample(number, force_counts=counts), asked(Event.HOLD_RECOVER))
        assert (memory.mode, memory.cause) == (Mode.RECOVER, TripCause.FORCE_BELOW_BIAS)


def test_a_cause_without_a_direction_cannot_be_recovered_from():
    memory = step(running(), sample(50, 5, gate=int(GateState.REVOKED)))
    assert memory.recover_signs == (0, 0, 0)
    assert step(memory, sample(51), asked(Event.HOLD_RECOVER)).mode == Mode.TRIPPED


def test_arming_needs_limit_bias_and_noise_below_the_gates_limit():
    at = CONFIG.force_limit_n + CONFIG.bias_limit_n + 10.0
    assert not below_gate(CONFIG, DESCRIPTION._replace(gate_force_limit_n=at))
    assert below_gate(CONFIG, DESCRIPTION._replace(gate_force_limit_n=math.nextafter(at, 1e9)))
    assert below_gate(CONFIG, DESCRIPTION._replace(gate_force_limit_n=GateLimits().force_limit_n))


def test_a_longer_lease_bears_more_lost_samples():
    longer = supervisor_params(CONFIG, DESCRIPTION._replace(permit_ttl_ns=60_000_000), BIAS, DURATION)
    assert (longer.limits.lease_samples, longer.limits.lease_ns) == (13, 60_000_000)


SAMPLES = st.builds(
    lambda number, tick, counts, force, gate, cause, answered: sample(
        number, tick, encoder_counts=counts, force_counts=force, gate=gate, gate_cause=cause, command_number=answered
    ),
    st.integers(0, 400),
    st.sampled_from([NO_TRIAL, *range(-BIAS - 1, 3), DURATION]),
    st.sampled_from([LEVEL, (0, 0, 0, 0, 0), (8191, 2047, 1023, 1023, 2047), (4031, 0, 207, 0, 33)]),
    st.sampled_from([-1, 0, 4, 40, 60, 240, HEAVY, 517, 518]),
    st.integers(0, 3),
    st.sampled_from([0, 1, int(GateCause.ESTOP)]),
    st.integers(-1, 400),
)
ASKS = st.builds(
    lambda event, agreed, ready, stale, links: asked(event, agreed=agreed, controller_ready=ready, stale_ns=stale, links=links),
    st.sampled_from(Event),
    st.booleans(),
    st.booleans(),
    st.sampled_from([0, 0, 20_000_000, 20_000_001]),
    st.builds(LinkHealth, *[st.sampled_from([0, 0, 0, 1, 2])] * 3, st.integers(-40, 40)),
)


@settings(max_examples=150, deadline=None)
@given(st.sampled_from([DISARMED, armed(), started(), running(), tripped()]), st.lists(st.tuples(SAMPLES, ASKS), max_size=8))
def test_plain_and_compiled_supervisors_agree_and_permit_nothing_without_an_arming(memory, steps):
    machine = memory
    for current, inputs in steps:
        before = memory
        memory, permit = supervisor_step(memory, PARAMS, current, inputs)
        machine, shown = supervisor_step_compiled(machine, PARAMS, current, inputs)
        assert (tuple(machine), tuple(shown)) == (memory, permit)
        assert (memory.arming_id != 0) == (memory.mode in (Mode.ARMED, Mode.RUNNING, Mode.RECOVER))
        if inputs.event == Event.NOTHING:
            assert memory.arming_id in (0, before.arming_id)
