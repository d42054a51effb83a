"""Windows of the encoders: steps and smooth speeds; a link under a current that must move it."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hydrohil.services.plant.hydraulics import LinkState
from hydrohil.services.plant.machine import link_step as machine_link_step
from hydrohil.services.plant.params import UNIMATE_PARAMS
from hydrohil.services.supervisor.observe import LinkHealth, SampleContext, observe_step, observer_start
from hydrohil.services.supervisor.observe_motion import (
    LinkProgress,
    MotionMemory,
    Pose,
    _driven,
    against,
    link_step,
    motion_begin,
    motion_step,
    smooth_speed,
)
from hydrohil.services.supervisor.rules import first_broken
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.messages import NO_TRIAL, TripCause
from tests.support.supervisor_scene import DESCRIPTION, LEVEL, LIMITS, PARAMS, sample

OBSERVER, CODES, MOTION = PARAMS.observer, PARAMS.observer.codes, LIMITS.motion
RUNNING = SampleContext(True, 0, True, LinkHealth(0, 0, 0, 1))
FIRST = 100
T_NS = DESCRIPTION.sample_period_ns
observe_compiled = compiled(observe_step)


def play(encoders, codes=(2048, 2048, 2048), first=FIRST):
    """What is observed at the last of these samples."""
    memory, observed = observer_start(), None
    for row, counts in enumerate(encoders):
        memory, observed = observe_step(
            memory, OBSERVER, sample(first + row, row, encoder_counts=counts, dac_counts=codes), RUNNING
        )
    return memory, observed


def at(link, count):
    return tuple(count if i == link else value for i, value in enumerate(LEVEL))


def test_nothing_has_moved_at_the_first_sample_of_a_trial_wherever_it_begins():
    memory = play([LEVEL] * 3)[0]
    other = (100, 300, 600, 0, 33)
    begun = observe_step(memory, OBSERVER, sample(103, NO_TRIAL, encoder_counts=other), RUNNING)[1]
    assert begun.motion.moved_q == (0.0, 0.0, 0.0, 0.0)
    again = observe_step(memory, OBSERVER, sample(103, 1, encoder_counts=other), RUNNING)[1]  # its tick went back
    assert (again.motion.speed, again.motion.tip_speed_m_per_s) == ((0.0, 0.0, 0.0), 0.0)


@pytest.mark.parametrize("link", range(3))
def test_a_steady_turn_is_its_speed_and_one_count_of_chatter_is_slow(link):
    moved = play([at(link, LEVEL[link] + row) for row in range(60)])[1].motion
    assert abs(moved.speed[link]) == pytest.approx(LIMITS.count_q[link] / 0.0045, rel=1e-3)
    assert abs(moved.moved_q[link]) == pytest.approx(LIMITS.count_q[link])
    chatter = play([at(link, LEVEL[link] + row % 2) for row in range(60)])[1].motion
    assert abs(chatter.speed[link]) < LIMITS.count_q[link] / 0.02


@pytest.mark.parametrize("link", range(3))
@pytest.mark.parametrize("sign", [-1, 1])
def test_full_speed_is_borne_and_a_count_more_in_one_sample_is_a_jump(link, sign):
    most = math.floor(MOTION.full_speed[link] * 0.0045 / LIMITS.count_q[link]) + 1
    assert first_broken(play([LEVEL, at(link, LEVEL[link] + sign * most)])[1], LIMITS)[0] == 0
    broken = first_broken(play([LEVEL, at(link, LEVEL[link] + sign * (most + 1))])[1], LIMITS)
    assert broken[0] == TripCause.ENCODER_JUMP
    lost = observe_step(
        play([LEVEL])[0], OBSERVER, sample(FIRST + 2, 2, encoder_counts=at(link, LEVEL[link] + sign * (most + 1))), RUNNING
    )
    assert first_broken(lost[1], LIMITS)[0] == 0  # in two periods


def test_a_stamp_that_lies_widens_nothing():
    memory = play([LEVEL])[0]
    late = sample(FIRST + 1, 1, time_ns=10**15)
    assert observe_step(memory, OBSERVER, late, RUNNING)[1].motion.dt_s == pytest.approx(0.0045)
    early = sample(FIRST + 1, 1, time_ns=0)
    assert observe_step(memory, OBSERVER, early, RUNNING)[1].motion.dt_s == pytest.approx(0.0045)


def test_a_nan_is_not_remembered():
    assert smooth_speed(math.nan, 0.0, 0.0045) == 0.0
    assert math.isnan(smooth_speed(0.0, math.nan, 0.0045))
    wild = (*LEVEL[:4], 10**12)  # a pitch that is no angle: the tip is nowhere
    observed = play([LEVEL, wild])[1]
    assert math.isnan(observed.motion.tip_speed_m_per_s)
    assert first_broken(observed, LIMITS)[0] != 0
    assert play([LEVEL, wild, LEVEL, LEVEL])[1].motion.tip_speed_m_per_s == 0.0


@pytest.mark.parametrize("link", range(3))
def test_a_link_that_does_not_move_under_its_current_trips_after_200_ms_and_not_before(link):
    samples = MOTION.moves_within_ns // T_NS + 1  # the first of them begins the window
    for codes in (CODES.high[link], CODES.low[link]):
        driven = tuple(codes if i == link else 2048 for i in range(3))
        chatter = [at(link, LEVEL[link] + row % 2) for row in range(2)] + [LEVEL] * 200
        assert first_broken(play([LEVEL] * samples, driven)[1], LIMITS)[0] == 0
        assert first_broken(play([LEVEL] * (samples + 1), driven)[1], LIMITS)[0] == TripCause.NO_MOTION
        assert first_broken(play(chatter[: samples + 5], driven)[1], LIMITS)[0] == TripCause.NO_MOTION
        below = tuple(codes - (1 if codes > 2048 else -1) if i == link else 2048 for i in range(3))
        assert first_broken(play([LEVEL] * 300, below)[1], LIMITS)[0] == 0


def test_at_the_end_of_its_travel_a_link_may_stand_under_current():
    low, high = at(2, 5), at(2, 994)
    out, inward = (2048, 2048, CODES.high[2]), (2048, 2048, CODES.low[2])
    assert play([low] * 100, inward)[1].motion.idle_ns[2] == 0
    assert play([high] * 100, out)[1].motion.idle_ns[2] == 0
    assert play([low] * 100, out)[1].motion.idle_ns[2] == 99 * T_NS
    assert play([high] * 100, inward)[1].motion.idle_ns[2] == 99 * T_NS


def test_progress_is_measured_from_the_furthest_point():
    memory = link_step(LinkProgress(0, 9.0, 99), 1, 0.5, T_NS)
    assert memory == LinkProgress(1, 0.5, 0)
    back = link_step(memory, 1, 0.4, T_NS)
    assert (back, against(back, 0.4)) == (LinkProgress(1, 0.5, T_NS), pytest.approx(0.1))
    assert link_step(back, 1, 0.5, T_NS) == LinkProgress(1, 0.5, 2 * T_NS)
    assert link_step(back, 1, 0.6, T_NS) == LinkProgress(1, 0.6, 0)
    assert link_step(back, -1, 0.4, T_NS) == LinkProgress(-1, 0.4, 0)
    assert against(LinkProgress(-1, 0.4, 0), 0.5) == pytest.approx(0.1)
    assert against(LinkProgress(0, 0.4, 0), 0.5) == 0.0


LOADS = ((0.0, -611.0, 611.0), (421.0, 56.0 - 611.0), (-554.0, 554.0))  # 334 N at 1.83 m; weight; both along the boom
INERTIAS = (420.0, 150.0, 45.0)


@pytest.mark.parametrize("link", range(3))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_current_that_must_move_a_link_moves_it_by_a_count_whatever_stands_against_it(link, sign):
    params = (UNIMATE_PARAMS.rotate, UNIMATE_PARAMS.down_up, UNIMATE_PARAMS.out_in)[link]
    machine = UNIMATE_PARAMS._replace(supply_pressure_pa=6.5e6)
    current_a = sign * (MOTION.moves_up_a if sign > 0.0 else MOTION.moves_down_a)[link]
    for load in LOADS[link]:
        half_pa = (-sign * params.breakaway_tau - load) / params.displacement_m3_per_q / 2.0  # left the wrong way round
        state = LinkState(0.2, 0.0, params.null_bias_a, 3.25e6 + half_pa, 3.25e6 - half_pa)
        for _ in range(int(0.2 / 50e-6)):
            state = machine_link_step(
                state=state,
                link=params,
                machine=machine,
                current_a=current_a,
                load_tau=load,
                inertia_tau_s2_per_q=INERTIAS[link],
                step_s=50e-6,
            )
        assert sign * (state.q - 0.2) >= LIMITS.count_q[link]


@pytest.mark.parametrize("link", range(3))
def test_a_link_at_full_speed_comes_to_rest_within_its_braking_way(link):
    params = (UNIMATE_PARAMS.rotate, UNIMATE_PARAMS.down_up, UNIMATE_PARAMS.out_in)[link]
    machine = UNIMATE_PARAMS._replace(supply_pressure_pa=7.5e6)
    for sign in (-1.0, 1.0):
        for load in LOADS[link]:
            state = LinkState(0.2, 0.0, params.null_bias_a, 3.5e6, 3.5e6)
            for _ in range(8000):
                state = machine_link_step(
                    state=state,
                    link=params,
                    machine=machine,
                    current_a=-sign * 0.36,
                    load_tau=load,
                    inertia_tau_s2_per_q=INERTIAS[link],
                    step_s=50e-6,
                )._replace(q=0.2)
            current_a, furthest = sign * (MOTION.moves_up_a if sign > 0.0 else MOTION.moves_down_a)[link], 0.0
            for _ in range(3000):
                state = machine_link_step(
                    state=state,
                    link=params,
                    machine=machine,
                    current_a=current_a,
                    load_tau=load,
                    inertia_tau_s2_per_q=INERTIAS[link],
                    step_s=50e-6,
                )
                furthest = max(furthest, sign * (0.2 - state.q))
            assert 0.0 < furthest <= MOTION.brakes_q[link] - LIMITS.count_q[link]


SAMPLES = st.builds(
    lambda gap, tick, counts, force, codes, late: (gap, tick, counts, force, codes, late),
    st.integers(-2, 9),
    st.sampled_from([NO_TRIAL, -2, -1, 0, 1, 2]),
    st.tuples(*(st.sampled_from([0, 4, 5, 33, 207, 971, 1023, 2047, 4031, 8191, 10**11]),) * 5),
    st.integers(-2048, 2047),
    st.tuples(*(st.sampled_from([820, *CODES.low, 2048, *CODES.high, 3276]),) * 3),
    st.integers(-(10**8), 10**8),
)


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(SAMPLES, st.sampled_from([0, 0, 0, 1])), max_size=8))
def test_plain_and_compiled_windows_agree_on_anything(rows):
    memory = machine = observer_start()
    number = 10
    for (gap, tick, counts, force, codes, late), stale_ns in rows:
        number += gap
        observed = sample(number, tick, encoder_counts=counts, force_counts=force, dac_counts=codes, time_ns=number * T_NS + late)
        context = RUNNING._replace(stale_ns=stale_ns)
        memory, plain = observe_step(memory, OBSERVER, observed, context)
        machine, fast = observe_compiled(machine, OBSERVER, observed, context)
        assert (repr(memory), repr(plain)) == (repr(machine), repr(fast))


STILL = (0.0, 0.0, 0.0)


def test_every_window_begins_at_the_first_pose():
    nobody, used = LinkProgress(0, 0.0, 0), LinkProgress(1, 0.5, 99)
    pose = Pose((1, 2, 3), (0.1, 0.2, 0.3), 0.4, (0.5, 0.6, 0.7))
    first = MotionMemory(
        q=pose.q, pitch_rad=0.4, tip_m=pose.tip_m, speed=STILL, tip_m_per_s=STILL, rotate=nobody, down_up=nobody, out_in=nobody
    )
    assert motion_begin(pose) == first
    before = MotionMemory(
        q=(9.0,) * 3,
        pitch_rad=9.0,
        tip_m=(9.0,) * 3,
        speed=(9.0,) * 3,
        tip_m_per_s=(9.0,) * 3,
        rotate=used,
        down_up=used,
        out_in=used,
    )
    begun = motion_step(before, CODES, pose, CODES.high, False, T_NS)[0]
    assert (begun.speed, begun.tip_m_per_s, begun.rotate.idle_ns) == (STILL, STILL, 0)


def test_every_axis_has_its_way():
    memory = motion_begin(Pose((0, 0, 0), (0.1, 0.2, 0.3), 0.4, (0.5, 0.6, 0.7)))
    pose = Pose((1, 2, 3), (0.11, 0.22, 0.33), 0.44, (0.52, 0.66, 0.73))
    after, observed = motion_step(memory, CODES, pose, (2048, 2048, 2048), True, T_NS)
    assert observed.moved_q == pytest.approx((0.01, 0.02, 0.03, 0.04))
    assert observed.counts == (1, 2, 3)
    smoothed = [way / 0.0245 for way in (0.01, 0.02, 0.03)]
    assert observed.speed == after.speed == pytest.approx(smoothed)
    assert observed.tip_speed_m_per_s == pytest.approx(math.sqrt(0.02**2 + 0.06**2 + 0.03**2) / 0.0245)
    assert after.tip_m_per_s == pytest.approx((0.02 / 0.0245, 0.06 / 0.0245, 0.03 / 0.0245))


@pytest.mark.parametrize("link", range(3))
def test_the_way_against_its_current_is_that_of_each_link(link):
    step_by = [1, -1, 1][link]  # down/up counts downwards
    driven = tuple(CODES.high[i] if i == link else 2048 for i in range(3))
    memory, observed = play([LEVEL, at(link, LEVEL[link] - 2 * step_by)], driven)
    others = [i for i in range(3) if i != link]
    assert observed.motion.against[link] == pytest.approx(2.0 * LIMITS.count_q[link])
    assert [observed.motion.against[i] for i in others] == [0.0, 0.0]
    assert observed.motion.idle_ns == tuple(T_NS if i == link else 0 for i in range(3))
    assert (memory.motion.rotate, memory.motion.down_up, memory.motion.out_in)[link].sign == 1


def test_a_current_into_a_stop_must_move_nothing_and_one_a_hair_off_it_must():
    stops = (0.0, 1.0)
    for q, up, down in ((0.9, 0, -1), (math.nextafter(0.9, 0.0), 1, -1), (0.1, 1, 0), (math.nextafter(0.1, 1.0), 1, -1)):
        assert _driven(3000, 1000, 3000, q, stops, 0.1) == up
        assert _driven(1000, 1000, 3000, q, stops, 0.1) == down
    assert _driven(2999, 1000, 3000, 0.5, stops, 0.1) == _driven(1001, 1000, 3000, 0.5, stops, 0.1) == 0


def test_a_smooth_speed_decays_with_its_time():
    assert smooth_speed(1.0, 0.0, 0.0045) == pytest.approx(0.02 / 0.0245)
