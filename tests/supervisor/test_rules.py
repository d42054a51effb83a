import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from hydrohil.services.supervisor.rule import GaugeObservation, Limits, MotionObservation, Observed, TransportObservation
from hydrohil.services.supervisor.rules import RULES, first_broken, fold
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.deadline_window import RANDOM_MISSES
from hydrohil.shared.contract.messages import GateState, TripCause
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.trips.causes import TRIPS
from tests.support.supervisor_scene import CONFIG, FINE, LIMITS, changed

NAN, INF = math.nan, math.inf
RAW, TARED = CONFIG.raw_force_limit_n, CONFIG.force_limit_n
SPEED, FASTEST = CONFIG.joint_speed_limit_q_per_s, CONFIG.tip_speed_limit_m_per_s
BRAKES = UNIMATE.motion.brakes_q
STEP = tuple(UNIMATE.motion.full_speed[i] * 0.0045 + LIMITS.count_q[i] * (1.0 + 1e-9) for i in range(4))
LOW_Q, HIGH_Q = CONFIG.joint_low_q, CONFIG.joint_high_q
LOW_M, HIGH_M = CONFIG.workspace_low_m, CONFIG.workspace_high_m
first_broken_compiled = compiled(first_broken)


def above(limit):
    return math.nextafter(limit, INF)


def below(limit):
    return math.nextafter(limit, -INF)


def one_of(field, index, value):
    values = list(getattr(FINE.motion, field))
    values[index] = value
    return {field: tuple(values)}


AT_LIMIT = [
    {"force_counts": 0},
    {"force_counts": 517},
    {"raw_n": RAW},
    {"raw_n": -RAW},
    {"tared_n": TARED},
    {"tared_n": -TARED},
    {"quiet_samples": 21},
    {"jump_n": 56.0},
    {"jump_n": -56.0},
    {"rate_n_per_s": 5000.0},
    {"rate_n_per_s": -5000.0},
    {"held_ns": 1_000_000_000},
    {"energy_j": 100.0},
    {"unexplained_n": 107.0},
    {"smooth_n": -25.0},
    *(one_of("counts", i, LIMITS.low_counts[i] + 1) for i in range(3)),
    *(one_of("counts", i, LIMITS.high_counts[i] - 1) for i in range(3)),
    *(one_of("moved_q", i, STEP[i]) for i in range(4)),
    *(one_of("moved_q", i, -STEP[i]) for i in range(4)),
    *(one_of("against", i, BRAKES[i]) for i in range(3)),
    *(one_of("idle_ns", i, 200_000_000) for i in range(3)),
    *(one_of("speed", i, SPEED[i]) for i in range(3)),
    *(one_of("speed", i, -SPEED[i]) for i in range(3)),
    {"tip_speed_m_per_s": FASTEST},
    {"bias_n": 60.0},
    {"bias_n": -60.0},
    {"bias_spread_n": 15.0},
    {"lost_samples": 4},
    {"stale_ns": 20_000_000},
    {"command_lag": 5},
    {"command_lag": 0},
    {"command_lag": 99, "tick": 0},
    {"state_lag": 6},
    {"state_lag": -4},
    {"state_lag": 99, "tick": 0},
    {"link_faults": 1},
    {"epoch_conflicts": 0},
    {"epoch_conflicts": 1, "moving": False},
    {"missed": 21},
    {"gate": int(GateState.OPEN)},
    {"gate": int(GateState.SHUT)},
    {"gate": int(GateState.RECOVERING)},
    *(one_of("q", i, LOW_Q[i]) for i in range(3)),
    *(one_of("q", i, HIGH_Q[i]) for i in range(3)),
    *(one_of("tip_m", i, LOW_M[i]) for i in range(3)),
    *(one_of("tip_m", i, HIGH_M[i]) for i in range(3)),
]
PAST = [  # what is observed, the cause, the number that broke, the limit it broke
    ({"force_counts": -1}, TripCause.FORCE_INVALID, -1.0, 0.0),
    ({"force_counts": 518}, TripCause.FORCE_INVALID, 518.0, 518.0),
    ({"raw_n": above(RAW)}, TripCause.FORCE_RAW, above(RAW), RAW),
    ({"raw_n": -above(RAW)}, TripCause.FORCE_RAW, -above(RAW), RAW),
    ({"raw_n": NAN}, TripCause.FORCE_RAW, NAN, RAW),
    ({"tared_n": above(TARED)}, TripCause.FORCE_TARED, above(TARED), TARED),
    ({"tared_n": -above(TARED)}, TripCause.FORCE_TARED, -above(TARED), TARED),
    ({"tared_n": NAN}, TripCause.FORCE_TARED, NAN, TARED),
    ({"quiet_samples": 22}, TripCause.FORCE_FROZEN, 22.0, 22.0),
    ({"jump_n": above(56.0)}, TripCause.FORCE_JUMP, above(56.0), 56.0),
    ({"jump_n": -above(56.0)}, TripCause.FORCE_JUMP, -above(56.0), 56.0),
    ({"jump_n": NAN}, TripCause.FORCE_JUMP, NAN, 56.0),
    ({"rate_n_per_s": above(5000.0)}, TripCause.FORCE_RATE, above(5000.0), 5000.0),
    ({"rate_n_per_s": -above(5000.0)}, TripCause.FORCE_RATE, -above(5000.0), 5000.0),
    ({"rate_n_per_s": NAN}, TripCause.FORCE_RATE, NAN, 5000.0),
    ({"held_ns": 1_000_000_001}, TripCause.FORCE_HELD, 1.000000001, 1.0),
    ({"energy_j": above(100.0)}, TripCause.FORCE_ENERGY, above(100.0), 100.0),
    ({"energy_j": NAN}, TripCause.FORCE_ENERGY, NAN, 100.0),
    ({"unexplained_n": above(107.0)}, TripCause.FORCE_DRIFT, above(107.0), 107.0),
    ({"unexplained_n": NAN}, TripCause.FORCE_DRIFT, NAN, 107.0),
    ({"smooth_n": -above(25.0)}, TripCause.FORCE_BELOW_BIAS, -above(25.0), -25.0),
    ({"smooth_n": NAN}, TripCause.FORCE_BELOW_BIAS, NAN, -25.0),
    *((one_of("counts", i, LIMITS.low_counts[i]), TripCause.ENCODER_INVALID, 0.0, 0.0) for i in range(3)),
    *((one_of("counts", i, high), TripCause.ENCODER_INVALID, high, high) for i, high in enumerate(LIMITS.high_counts)),
    *((one_of("moved_q", i, above(STEP[i])), TripCause.ENCODER_JUMP, above(STEP[i]), STEP[i]) for i in range(4)),
    *((one_of("moved_q", i, -above(STEP[i])), TripCause.ENCODER_JUMP, -above(STEP[i]), STEP[i]) for i in range(4)),
    *((one_of("moved_q", i, NAN), TripCause.ENCODER_JUMP, NAN, STEP[i]) for i in range(4)),
    *((one_of("against", i, above(BRAKES[i])), TripCause.MOTION_AGAINST, above(BRAKES[i]), BRAKES[i]) for i in range(3)),
    *((one_of("against", i, NAN), TripCause.MOTION_AGAINST, NAN, BRAKES[i]) for i in range(3)),
    *((one_of("idle_ns", i, 200_000_001), TripCause.NO_MOTION, 0.200000001, 0.2) for i in range(3)),
    *((one_of("speed", i, above(SPEED[i])), TripCause.JOINT_SPEED, above(SPEED[i]), SPEED[i]) for i in range(3)),
    *((one_of("speed", i, -above(SPEED[i])), TripCause.JOINT_SPEED, -above(SPEED[i]), SPEED[i]) for i in range(3)),
    *((one_of("speed", i, NAN), TripCause.JOINT_SPEED, NAN, SPEED[i]) for i in range(3)),
    ({"tip_speed_m_per_s": above(FASTEST)}, TripCause.TIP_SPEED, above(FASTEST), FASTEST),
    ({"tip_speed_m_per_s": NAN}, TripCause.TIP_SPEED, NAN, FASTEST),
    ({"bias_n": above(60.0)}, TripCause.BIAS, above(60.0), 60.0),
    ({"bias_n": -above(60.0)}, TripCause.BIAS, -above(60.0), 60.0),
    ({"bias_n": NAN}, TripCause.BIAS, NAN, 60.0),
    ({"bias_spread_n": above(15.0)}, TripCause.BIAS, above(15.0), 15.0),
    ({"bias_spread_n": NAN}, TripCause.BIAS, NAN, 15.0),
    *((one_of("q", i, below(LOW_Q[i])), TripCause.JOINT_LIMIT, below(LOW_Q[i]), LOW_Q[i]) for i in range(3)),
    *((one_of("q", i, above(HIGH_Q[i])), TripCause.JOINT_LIMIT, above(HIGH_Q[i]), HIGH_Q[i]) for i in range(3)),
    *((one_of("q", i, NAN), TripCause.JOINT_LIMIT, NAN, LOW_Q[i]) for i in range(3)),
    *((one_of("tip_m", i, below(LOW_M[i])), TripCause.WORKSPACE, below(LOW_M[i]), LOW_M[i]) for i in range(3)),
    *((one_of("tip_m", i, above(HIGH_M[i])), TripCause.WORKSPACE, above(HIGH_M[i]), HIGH_M[i]) for i in range(3)),
    *((one_of("tip_m", i, NAN), TripCause.WORKSPACE, NAN, LOW_M[i]) for i in range(3)),
    ({"lost_samples": 5}, TripCause.SAMPLE_LOST, 5.0, 4.0),
    ({"lost_samples": -1}, TripCause.SAMPLE_LOST, -1.0, 0.0),
    ({"stale_ns": 20_000_001}, TripCause.SAMPLE_STALE, 20_000_001e-9, 0.02),
    ({"link_faults": 2}, TripCause.LINK_FAULTS, 2.0, 1.0),
    ({"epoch_conflicts": 2}, TripCause.TWO_PUBLISHERS, 2.0, 0.0),
    ({"other_run": 1}, TripCause.OTHER_RUN, 1.0, 0.0),
    ({"command_lag": 6}, TripCause.COMMAND_STALE, 6.0, 5.0),
    ({"command_lag": 6, "tick": 1}, TripCause.COMMAND_STALE, 6.0, 5.0),
    ({"command_lag": -1}, TripCause.COMMAND_STALE, -1.0, 0.0),
    ({"state_lag": 7}, TripCause.CONTROLLER_SILENT, 7.0, 6.0),
    ({"state_lag": 7, "tick": 1}, TripCause.CONTROLLER_SILENT, 7.0, 6.0),
    ({"state_lag": -5}, TripCause.CONTROLLER_SILENT, -5.0, -4.0),
    ({"missed": 22}, TripCause.QUALITY, 0.78, 0.79),
    ({"gate": int(GateState.REVOKED)}, TripCause.GATE_CUT, float(GateState.REVOKED), float(GateState.OPEN)),
    ({"ready": False}, TripCause.NOT_READY, 0.0, 1.0),
]
OVERLAPS: set[tuple[TripCause, TripCause]] = set()  # (first, second): a row of the first breaks the second too
ALONE = {rule.cause: fold((rule,)) for rule in RULES}
AT_REST = changed(FINE, moving=False, starting=False)
ONLY_WHILE_MOVING = (
    TripCause.FORCE_DRIFT,
    TripCause.FORCE_BELOW_BIAS,
    TripCause.SAMPLE_LOST,
    TripCause.COMMAND_STALE,
    TripCause.CONTROLLER_SILENT,
    TripCause.GATE_CUT,
)
ONLY_AT_THE_START = (TripCause.BIAS, TripCause.NOT_READY)


def same(a, b):
    return a == b or (a != a and b != b)


def test_nothing_is_broken_when_all_holds():
    assert first_broken(FINE, LIMITS) == (0, 0.0, 0.0)
    assert first_broken(AT_REST, LIMITS) == (0, 0.0, 0.0)


def test_the_limits_of_the_transport_are_leases_in_whole_samples():
    assert (LIMITS.min_force_counts, LIMITS.max_force_counts) == (0, 518)
    assert (LIMITS.lease_samples, LIMITS.lease_ns) == (4, 20_000_000)
    assert (LIMITS.missed_samples, LIMITS.faults_per_s) == (4 + 1 + 16, 1)


@pytest.mark.parametrize("changes", AT_LIMIT, ids=str)
def test_a_rule_holds_on_its_limit(changes):
    assert first_broken(changed(FINE, **changes), LIMITS) == (0, 0.0, 0.0)


@pytest.mark.parametrize(("changes", "cause", "measured", "limit"), PAST, ids=lambda value: str(value)[:40])
def test_a_rule_breaks_just_past_its_limit_and_gives_its_own_numbers(changes, cause, measured, limit):
    found = ALONE[cause](changed(FINE, **changes), LIMITS)
    assert found[0] == cause
    assert same(found[1], measured)
    assert found[2] == pytest.approx(limit, rel=1e-12)


@pytest.mark.parametrize(("changes", "cause", "measured", "limit"), PAST, ids=lambda value: str(value)[:40])
def test_at_rest_only_what_can_be_judged_at_rest_is(changes, cause, measured, limit):
    judge = ALONE[cause]
    found = judge(changed(AT_REST, **changes), LIMITS)[0]
    assert found == (0 if cause in ONLY_WHILE_MOVING + ONLY_AT_THE_START else cause)
    assert judge(changed(AT_REST, starting=True, **changes), LIMITS)[0] == (0 if cause in ONLY_WHILE_MOVING else cause)
    assert judge(changed(AT_REST, moving=True, **changes), LIMITS)[0] == (0 if cause in ONLY_AT_THE_START else cause)


@pytest.mark.parametrize(
    ("field", "cause"),
    [
        ("jump_limit_n", TripCause.FORCE_JUMP),
        ("unexplained_limit_n", TripCause.FORCE_DRIFT),
        ("dt_s", TripCause.ENCODER_JUMP),
    ],
)
def test_a_limit_that_is_no_number_holds_nothing(field, cause):
    assert first_broken(changed(FINE, **{field: NAN}), LIMITS)[0] == cause


def test_an_encoder_at_its_end_is_reported_with_its_own_end():
    ends = LIMITS._replace(low_counts=(1, 2, 3), high_counts=(8000, 2000, 1000))
    for link, (low, high) in enumerate(zip(ends.low_counts, ends.high_counts, strict=True)):
        for end in (low, high):
            assert first_broken(changed(FINE, **one_of("counts", link, end)), ends) == (TripCause.ENCODER_INVALID, end, end)


def test_of_several_links_the_one_beyond_is_reported():
    for field, cause, limit in (("against", TripCause.MOTION_AGAINST, BRAKES), ("speed", TripCause.JOINT_SPEED, SPEED)):
        observed = changed(FINE, **{field: (limit[0], above(limit[1]), 9.0)})
        assert first_broken(observed, LIMITS) == (cause, above(limit[1]), limit[1])
    observed = changed(FINE, idle_ns=(0, 200_000_001, 300_000_000))
    assert first_broken(observed, LIMITS)[:2] == (TripCause.NO_MOTION, pytest.approx(0.3))


def test_the_rows_stand_in_the_order_of_severity_and_every_cause_has_words():
    causes = [int(rule.cause) for rule in RULES]
    assert causes == sorted(set(causes))
    assert set(TRIPS) == set(causes) | {TripCause.ESTOP}


def test_every_rule_has_a_row_past_its_limit():
    assert {cause for _, cause, _, _ in PAST} == {rule.cause for rule in RULES}


def test_of_several_broken_rows_the_first_decides():
    observed = FINE
    for changes, cause, measured, limit in sorted(PAST, key=lambda row: row[1], reverse=True):
        before = first_broken(observed, LIMITS)[0]
        observed = changed(observed, **changes)
        found = first_broken(observed, LIMITS)
        assert found[0] == min(rule.cause for rule in RULES if not rule.holds(observed, LIMITS))
        assert found[0] <= cause
        if found[0] == cause != before:
            assert same(found[1], measured)
            assert found[2] == pytest.approx(limit, rel=1e-12)


def test_a_rule_breaks_on_its_own_rows_and_else_only_where_it_overlaps_another():
    overlaps = set()
    for changes, cause, _, _ in PAST:
        broken = {rule.cause for rule in RULES if ALONE[rule.cause](changed(FINE, **changes), LIMITS)[0]}
        assert cause in broken
        overlaps |= {(cause, other) for other in broken - {cause}}
    assert overlaps == OVERLAPS
    assert fold(())(changed(FINE, ready=False), LIMITS) == (0, 0.0, 0.0)


ANY_FLOAT = st.floats() | st.sampled_from([0.0, RAW, TARED, 60.0, 15.0, -2.0, 2.0])
TRIPLES = st.tuples(ANY_FLOAT, ANY_FLOAT, ANY_FLOAT)
INTS, FEW = st.integers(-10, 600), st.integers(0, 3)
OBSERVED = st.builds(
    Observed,
    st.booleans(),
    st.booleans(),
    INTS,
    st.builds(GaugeObservation, INTS, *(ANY_FLOAT,) * 10, INTS, st.integers(0, 2_000_000_000), ANY_FLOAT),
    st.builds(
        MotionObservation,
        TRIPLES | st.just(FINE.motion.q),
        TRIPLES | st.just(FINE.motion.tip_m),
        st.tuples(INTS, INTS, INTS),
        st.tuples(*(ANY_FLOAT,) * 4) | st.just(FINE.motion.moved_q),
        ANY_FLOAT,
        TRIPLES | st.just(FINE.motion.speed),
        ANY_FLOAT,
        st.tuples(*(st.integers(0, 300_000_000),) * 3),
        TRIPLES | st.just(FINE.motion.against),
    ),
    st.builds(
        TransportObservation, INTS, st.integers(0, 30_000_000), INTS, FEW, st.booleans(), FEW, FEW, FEW, INTS, st.integers(0, 100)
    ),
)


@settings(max_examples=300, deadline=None)
@given(OBSERVED)
def test_plain_and_compiled_rules_agree_on_anything(observed):
    plain, machine = first_broken(observed, LIMITS), first_broken_compiled(observed, LIMITS)
    assert all(same(a, b) for a, b in zip(plain, machine, strict=True))
    assert isinstance(LIMITS, Limits)


def test_every_row_gives_its_number_and_limit_even_while_it_holds():
    numbers = {rule.cause: (rule.measured(FINE, LIMITS), rule.limit(FINE, LIMITS)) for rule in RULES}
    assert numbers[TripCause.JOINT_LIMIT] == (FINE.motion.q[0], HIGH_Q[0])
    assert numbers[TripCause.WORKSPACE] == (FINE.motion.tip_m[0], HIGH_M[0])
    assert numbers[TripCause.NOT_READY] == (1.0, 1.0)
    assert numbers[TripCause.SAMPLE_LOST] == (0.0, 4.0)
    assert all(type(number) is float for pair in numbers.values() for number in pair)


def test_while_nothing_is_broken_the_first_value_stands_for_all():
    triple = (0.001, 0.002, 0.003)
    observed = changed(FINE, moved_q=(*triple, 0.0005), against=triple, speed=triple)
    numbers = {rule.cause: (rule.measured(observed, LIMITS), rule.limit(observed, LIMITS)) for rule in RULES}
    assert first_broken(observed, LIMITS)[0] == 0
    assert numbers[TripCause.ENCODER_INVALID] == (FINE.motion.counts[0], LIMITS.high_counts[0])
    assert numbers[TripCause.ENCODER_JUMP] == (0.001, STEP[0])
    assert numbers[TripCause.MOTION_AGAINST] == (0.001, BRAKES[0])
    assert numbers[TripCause.JOINT_SPEED] == (0.001, SPEED[0])


def test_of_several_values_the_first_outside_its_bounds_is_reported():
    for edge in (LOW_Q[0], HIGH_Q[0]):
        observed = changed(FINE, q=(edge, above(HIGH_Q[1]), 9.0))
        assert first_broken(observed, LIMITS) == (TripCause.JOINT_LIMIT, above(HIGH_Q[1]), HIGH_Q[1])


def test_a_bias_on_its_limit_leaves_the_word_to_its_spread():
    for bias_n in (60.0, -60.0):
        assert first_broken(changed(FINE, bias_n=bias_n, bias_spread_n=16.0), LIMITS) == (TripCause.BIAS, 16.0, 15.0)


def test_limits_that_cross_let_nothing_pass_and_report_the_bound_that_broke():
    crossed = LIMITS._replace(config=CONFIG._replace(joint_low_q=(0.3, -0.5, 0.0), joint_high_q=(0.2, 0.4, 1.0)))
    for value, limit in ((0.2, 0.3), (0.25, 0.2)):
        assert first_broken(changed(FINE, q=(value, 0.0, 0.2)), crossed) == (TripCause.JOINT_LIMIT, value, limit)
    narrow = LIMITS._replace(min_force_counts=6, max_force_counts=5)
    assert first_broken(changed(FINE, force_counts=6), narrow) == (TripCause.FORCE_INVALID, 6.0, 5.0)
    assert first_broken(changed(FINE, force_counts=5), narrow) == (TripCause.FORCE_INVALID, 5.0, 6.0)
    impatient = LIMITS._replace(lease_samples=-2)
    assert first_broken(changed(FINE, command_lag=0), impatient) == (TripCause.SAMPLE_LOST, 0.0, -2.0)
    assert first_broken(changed(FINE, moving=True, lost_samples=0, command_lag=0), LIMITS) == (0, 0.0, 0.0)
    stale = next(rule for rule in RULES if rule.cause == TripCause.COMMAND_STALE)
    assert stale.limit(changed(FINE, command_lag=0), LIMITS) == 5.0
    silent = next(rule for rule in RULES if rule.cause == TripCause.CONTROLLER_SILENT)
    assert [silent.limit(changed(FINE, state_lag=lag), LIMITS) for lag in (1, 0, -1)] == [6.0, 6.0, -4.0]


def test_at_rest_a_service_may_start_anew_and_in_motion_nobody_may():
    anew = changed(FINE, epoch_conflicts=1)
    assert first_broken(anew, LIMITS) == (TripCause.TWO_PUBLISHERS, 1.0, 0.0)
    assert first_broken(changed(anew, moving=False), LIMITS) == (0, 0.0, 0.0)
    assert first_broken(changed(anew, moving=False, epoch_conflicts=2), LIMITS) == (TripCause.TWO_PUBLISHERS, 2.0, 1.0)


@pytest.mark.parametrize(("loss", "trips"), [(0.01, False), (0.2, True)])
def test_a_link_that_loses_one_in_a_hundred_runs_and_one_that_loses_one_in_five_does_not(loss, trips):
    missed = 1.0 - (1.0 - loss) ** 3  # sample to controller, command to plant, next sample to supervisor
    above_floor = stats.binom.sf(LIMITS.missed_samples, 100, missed)
    assert (above_floor > 0.999) if trips else (above_floor < 1e-12)
    without_outage = stats.binom.sf(RANDOM_MISSES, 100, missed)
    assert trips or without_outage < 1e-8
