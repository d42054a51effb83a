import itertools
import math

import numpy as np
import pytest

from hydrohil.services.controller.actuation import Handover, slewed_code
from hydrohil.services.controller.config import (
    TARGETS,
    AdaptationConfig,
    ControllerConfig,
    ImpedanceConfig,
    Segment,
    controller_params,
    segment_table,
)
from hydrohil.services.controller.explicit import FILTERS_AT_REST
from hydrohil.services.controller.laws.table import LAW_NAMES
from hydrohil.services.controller.step import control_start, control_step
from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.converters import ZERO_CODE, code_to_current, current_to_code
from hydrohil.shared.contract.messages import NO_TRIAL, GateState, Sample
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.machines import description

STOPPED = (ZERO_CODE, ZERO_CODE, ZERO_CODE)
PERIOD_NS = 4_500_000
DT_S = PERIOD_NS * 1e-9
FIRST = -30
COUNTS = (4031, 971, 207, 0, 33)
SHUT, OPEN, REVOKED, RECOVERING = (int(state) for state in GateState)


def _params(axis=2, sign=1.0, first_tick=FIRST, **config):
    plant = description(period_ns=PERIOD_NS, force_axis=axis, force_sign=sign)
    return controller_params(ControllerConfig(**config), plant, first_tick)


def _sample(tick, counts=COUNTS, force=30, gate=None, dac=STOPPED, open_samples=10**6, number=None, late_ns=0, signs=(0, 0, 0)):
    if gate is None:
        gate = OPEN if tick > 0 else SHUT
    number = tick + 1000 if number is None else number
    trial_ns = 0 if tick == NO_TRIAL else tick * PERIOD_NS + late_ns
    opened = open_samples if gate == OPEN else 0
    return Sample(
        number=number,
        time_ns=number * PERIOD_NS + late_ns,
        tick=tick,
        trial_time_ns=trial_ns,
        encoder_counts=counts,
        force_counts=force,
        dac_counts=dac,
        gate=gate,
        gate_cause=0,
        gate_open_samples=opened,
        recover_signs=signs,
        command_number=number - 1,
        command_late_substeps=0,
        command_age_ns=0,
    )


def _run(params, segments, samples, memory=None):
    memory, table, out = memory or control_start(params), segment_table(segments), []
    for sample in samples:
        memory, codes, thought = control_step(memory, params, table, sample)
        out.append((codes, thought))
    return memory, out


def _bias_phase(**kwargs):
    return [_sample(tick, **kwargs) for tick in range(FIRST, 0)]


def _moved(*steps):
    return tuple(count + step for count, step in itertools.zip_longest(COUNTS, steps, fillvalue=0))


JOINT_STEP = (Segment("q1", "step", amount=0.05), Segment("q2", "step", amount=0.05), Segment("q3", "step", amount=0.05))


def test_a_shut_gate_means_tracking_set_point_measured_integral_zero_code_zero():
    params = _params(law="pi", target="joint")
    _, out = _run(params, JOINT_STEP, [*_bias_phase(), *(_sample(t, gate=REVOKED, counts=_moved(t, t)) for t in range(1, 30))])
    for codes, thought in out:
        assert codes == STOPPED
        assert thought.q_set == thought.q
        assert thought.x_set_m == thought.x_m
        assert thought.integral_a == (0.0, 0.0, 0.0)
        assert thought.current_a == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("tick", "gate", "answers"),
    [(-1, OPEN, False), (0, SHUT, True), (0, REVOKED, False), (0, RECOVERING, False), (1, SHUT, False), (1, OPEN, True)],
)
def test_the_law_answers_tick_0_and_an_open_gate_and_nothing_else(tick, gate, answers):
    params = _params(target="joint")
    before = [_sample(t) for t in range(FIRST, tick)]
    _, out = _run(params, JOINT_STEP, [*before, _sample(tick, gate=gate)])
    assert (out[-1][0] != STOPPED) == answers


def test_after_a_cut_law_and_target_model_start_from_nothing():
    params = _params(law="pi", target="impedance")
    push = (Segment("force", "step", amount=200.0), Segment("x", "step", amount=0.05))
    memory, out = _run(params, push, [*_bias_phase(), *(_sample(t) for t in range(50))])
    assert out[-1][1].integral_a[2] > 0.0
    assert memory.impedance.force_offset_m < 0.0
    memory, out = _run(params, push, [_sample(50, gate=REVOKED)], memory)
    assert memory.laws[2].integral_a == 0.0
    assert memory.impedance.position_m == out[-1][1].x_m
    assert memory.impedance.velocity_m_per_s == (0.0, 0.0, 0.0)
    assert (memory.impedance.force_offset_m, memory.impedance.force_velocity_m_per_s) == (0.0, 0.0)


def test_recovering_drives_only_the_allowed_signs_with_the_low_current():
    params = _params(target="joint")
    dac, memory = STOPPED, control_start(params)
    for number in range(10):
        sample = _sample(NO_TRIAL, gate=RECOVERING, signs=(0, -1, 1), dac=dac, number=number)
        memory, codes, thought = control_step(memory, params, (), sample)
        assert all(abs(code - last) <= 100 for code, last in zip(codes, dac, strict=True))
        dac = codes
    u = params.recover_current_a
    assert dac == (ZERO_CODE, current_to_code(UNIMATE.drive, -u[1]), current_to_code(UNIMATE.drive, u[2]))
    assert thought.current_a == (0.0, -u[1], u[2])


def test_nothing_before_the_first_tick_leaves_a_trace():
    params = _params(target="impedance")
    segments = (Segment("x", "sine", duration_s=2.0, amount=0.02, frequency_hz=0.5), Segment("force", "step", amount=40.0))
    trial = [*_bias_phase(), *(_sample(t, counts=_moved(t % 3, t // 9), force=30 + t % 5) for t in range(40))]
    past = [_sample(NO_TRIAL, counts=_moved(50 - i, i, 3), number=i, force=99) for i in range(37)]
    past += [_sample(FIRST + i, number=100 + i, counts=_moved(i), force=7) for i in range(60)]
    memory, _ = _run(params, segments, past)
    fresh, used = _run(params, segments, trial), _run(params, segments, trial, memory)
    assert repr(fresh) == repr(used)


def test_the_bias_is_the_mean_of_the_negative_ticks_alone():
    params = _params(target="joint")
    forces = [20 + i % 7 for i in range(-FIRST)]
    samples = [_sample(FIRST + i, force=force) for i, force in enumerate(forces)]
    _, out = _run(params, (), [*samples, _sample(0, force=500), _sample(1, force=700)])
    scale, thought = params.calibration.force_n_per_count, out[-1][1]
    assert thought.force_bias_n == pytest.approx(scale * sum(forces) / len(forces))
    assert thought.force_n == pytest.approx(scale * 700 - thought.force_bias_n)
    assert thought.force_mean_n == pytest.approx(scale * (forces[-1] + 500 + 700) / 3 - thought.force_bias_n)


def test_ready_comes_with_the_twentieth_sample_in_a_trial_and_outside():
    params = _params(target="impedance")
    for samples in (_bias_phase(), [_sample(NO_TRIAL, number=i) for i in range(30)]):
        _, out = _run(params, (), samples)
        assert [thought.ready for _, thought in out] == [0] * 19 + [1] * 11


@pytest.mark.parametrize(("counts_off", "ready"), [(2, 1), (-2, 1), (2.1, 0), (-2.1, 0)])
@pytest.mark.parametrize("link", [0, 1, 2])
def test_the_reference_may_start_two_counts_from_the_pose_and_no_more(link, counts_off, ready):
    params = _params(target="joint")
    step = Segment(("q1", "q2", "q3")[link], "step", amount=counts_off * params.calibration.scale[link])
    _, out = _run(params, (step,), _bias_phase())
    assert out[-1][1].ready == ready


def test_a_lost_sample_before_tick_0_takes_readiness_from_the_whole_trial():
    params = _params(target="joint")
    samples = _bias_phase()
    del samples[5]
    _, out = _run(params, (), [*samples, *(_sample(t, gate=SHUT) for t in range(1, 30))])
    assert {thought.ready for _, thought in out} == {0}


def test_a_controller_that_missed_the_first_tick_never_drives():
    params = _params(target="joint")
    outside = [_sample(NO_TRIAL, number=i) for i in range(900)]
    samples = [*outside, *_bias_phase()[1:], *(_sample(t, counts=_moved(t, t, t)) for t in range(30))]
    _, out = _run(params, JOINT_STEP, samples)
    assert all(codes == STOPPED for codes, _ in out)
    assert {thought.ready for _, thought in out[900:]} == {0}


def test_a_jump_of_the_tick_without_its_first_tick_stops_the_law():
    params = _params(target="joint")
    samples = [*_bias_phase(), *(_sample(t) for t in range(10)), *(_sample(t, number=1000 + t - 5) for t in range(15, 40))]
    _, out = _run(params, JOINT_STEP, samples)
    assert out[-26][0] != STOPPED
    assert all(codes == STOPPED for codes, _ in out[-25:])


def test_without_a_loaded_trial_no_tick_starts_one():
    params = _params(target="joint", first_tick=0)
    _, out = _run(params, JOINT_STEP, [*_bias_phase(), *(_sample(t) for t in range(30))])
    assert all(codes == STOPPED for codes, _ in out)


def test_codes_rise_by_the_tight_limit_at_first_and_by_the_experiments_later():
    params = _params(target="joint", slew_codes=300)
    _, out = _run(params, JOINT_STEP, [*_bias_phase(), _sample(0)])
    assert out[-1][0] == (ZERO_CODE + 100,) * 3
    for opened, limit in ((0, 100), (19, 100), (20, 300)):
        _, out = _run(params, JOINT_STEP, [*_bias_phase(), _sample(0), _sample(1, open_samples=opened, dac=(2000, 2048, 3100))])
        assert out[-1][0] == (2000 + limit, 2048 + limit, min(3100 + limit, UNIMATE.converters[0].high))


def test_a_current_that_is_no_number_stops_at_once():
    for current_a in (math.nan, math.inf, -math.inf):
        assert slewed_code(UNIMATE.drive, current_a, 3000, 100) == ZERO_CODE
    assert slewed_code(UNIMATE.drive, 0.36, 3000, 100) == 3100
    params = _params(target="joint")
    broken = params._replace(gains=(params.gains[0]._replace(kp_a_per_q=math.nan), *params.gains[1:]))
    _, out = _run(broken, JOINT_STEP, [*_bias_phase(), _sample(0)])
    assert out[-1][0][0] == ZERO_CODE
    assert out[-1][0][1] > ZERO_CODE


def test_a_gap_while_running_is_integrated_with_the_true_time_between_samples():
    params = _params(law="pi", target="joint")
    start = [*_bias_phase(), _sample(0), _sample(1)]
    memory, _ = _run(params, JOINT_STEP, start)
    before = memory.laws[1].integral_a
    memory, out = _run(params, JOINT_STEP, [_sample(9, late_ns=300_000)], memory)
    gained = params.gains[1].linear_ki_a_per_q_s * 0.05 * (8 * DT_S + 0.3e-3)
    assert memory.laws[1].integral_a - before == pytest.approx(gained)
    assert out[-1][0] != STOPPED


def test_the_reference_is_read_at_the_samples_true_time():
    params = _params(target="joint")
    ramp = (Segment("q1", "ramp", duration_s=1.0, amount=0.1),)
    _, out = _run(params, ramp, [*_bias_phase(), _sample(0), _sample(1, late_ns=-400_000)])
    thought = out[-1][1]
    assert thought.q_set[0] - out[0][1].q[0] == pytest.approx(0.1 * (DT_S - 0.4e-3))


def test_cartesian_references_start_at_the_pose_of_the_first_tick():
    params = _params(target="cartesian")
    _, out = _run(params, (Segment("x", "step", start_s=0.0, amount=0.02),), [*_bias_phase(), _sample(0, counts=_moved(0, 1))])
    x0, thought = out[0][1].x_m, out[-1][1]
    assert thought.x_set_m == pytest.approx((x0[0] + 0.02, x0[1], x0[2]), abs=1e-12)
    assert thought.x_nominal_m == thought.x_set_m


@pytest.mark.parametrize(("axis", "sign"), [(2, 1.0), (0, -1.0)])
def test_a_push_moves_the_set_point_away_and_a_force_set_point_moves_it_against_the_push(axis, sign):
    params = _params(axis, sign, target="impedance", impedance=ImpedanceConfig(damping_ratio=1.0, damping="model"))
    k = params.impedance.stiffness_n_per_m
    pushed = [*_bias_phase(), *(_sample(t, force=60) for t in range(600))]
    _, out = _run(params, (), pushed)
    offset = out[-1][1].x_set_m[axis] - out[-1][1].x_nominal_m[axis]
    assert offset == pytest.approx(sign * 30 * params.calibration.force_n_per_count / k, rel=1e-6)
    _, out = _run(params, (Segment("force", "step", amount=40.0),), [*_bias_phase(), *(_sample(t) for t in range(600))])
    offset = out[-1][1].x_set_m[axis] - out[-1][1].x_nominal_m[axis]
    assert offset == pytest.approx(-sign * 40.0 / k, rel=1e-6)
    assert out[-1][1].force_set_n == 40.0


@pytest.mark.parametrize(("axis", "sign"), [(2, 1.0), (0, -1.0)])
def test_explicit_control_presses_where_force_is_missing_and_yields_where_there_is_too_much(axis, sign):
    params = _params(axis, sign, target="explicit", law="pi")
    pressing = _run(params, (Segment("force", "step", amount=40.0),), [*_bias_phase(), *(_sample(t) for t in range(60))])[1][-1][
        1
    ]
    yielding = _run(params, (), [*_bias_phase(), *(_sample(t, force=60) for t in range(60))])[1][-1][1]
    assert sign * (pressing.x_set_m[axis] - pressing.x_m[axis]) < 0.0
    assert sign * (yielding.x_set_m[axis] - yielding.x_m[axis]) > 0.0
    for thought in (pressing, yielding):
        assert all(thought.x_set_m[i] == thought.x_m[i] for i in range(3) if i != axis)


def test_a_vertical_way_becomes_an_angle_by_the_lever():
    # thesis 6.2.1 prints the transposed Jacobian; a link of length d turns by way / d, more for a shorter one
    for slide, lever_m in ((207, 1.0), (0, 0.783)):
        counts = (COUNTS[0], COUNTS[1], slide, *COUNTS[3:])
        params = _params(target="explicit", law="pi")
        samples = [_sample(t, counts=counts) for t in range(FIRST, 30)]
        thought = _run(params, (Segment("force", "step", amount=40.0),), samples)[1][-1][1]
        turned = thought.q_set[1] - thought.q[1]
        assert turned == pytest.approx((thought.x_m[2] - thought.x_set_m[2]) / lever_m, rel=0.01)


def test_the_filters_of_explicit_control_start_from_nothing_after_a_cut():
    params, push = _params(target="explicit"), (Segment("force", "step", amount=40.0),)
    memory, _ = _run(params, push, [*_bias_phase(), *(_sample(t) for t in range(50))])
    assert memory.explicit.shared_m > 0.0
    memory, _ = _run(params, push, [_sample(50, gate=REVOKED)], memory)
    assert memory.explicit == FILTERS_AT_REST


def test_links_that_do_not_act_get_no_current_and_gather_none():
    params = _params(law="pi", target="joint", acting=(False, True, False))
    _, out = _run(params, JOINT_STEP, [*_bias_phase(), *(_sample(t) for t in range(60))])
    thought = out[-1][1]
    assert (thought.current_a[0], thought.current_a[2]) == (0.0, 0.0)
    assert (thought.integral_a[0], thought.integral_a[2]) == (0.0, 0.0)
    assert (out[-1][0][0], out[-1][0][2]) == (ZERO_CODE, ZERO_CODE)
    assert thought.current_a[1] > 0.0


def test_the_alternate_formulation_is_damped_by_the_measured_velocity():
    # the tool is carried down at constant speed without force: the damper asks the set-point to go up
    params = _params(target="impedance", impedance=ImpedanceConfig(500.0, 50.0, 1.0, "model", formulation="measured"))
    samples = [*_bias_phase(), *(_sample(t, counts=_moved(0, -2 * t)) for t in range(60))]
    memory, out = _run(params, (), samples)
    assert out[-1][1].x_m[2] < out[FIRST][1].x_m[2]
    assert memory.impedance.velocity_m_per_s[2] > 0.0


def test_measured_and_demanded_force_pass_the_same_filter():
    params = _params(target="impedance")
    demanded = -30 * params.calibration.force_n_per_count
    pushed = _run(params, (), [*_bias_phase(), *(_sample(t, force=60) for t in range(9))])[1]
    asked = _run(params, (Segment("force", "step", amount=demanded),), [*_bias_phase(), *(_sample(t) for t in range(9))])[1]
    rise = [thought.x_set_m[2] - thought.x_nominal_m[2] for _, thought in pushed[-9:]]
    assert [thought.x_set_m[2] - thought.x_nominal_m[2] for _, thought in asked[-9:]] == pytest.approx(rise, rel=1e-6)
    assert rise[0] > 0.0


def test_a_low_pass_is_settled_before_the_trial_begins_and_knows_the_bias():
    params = _params(target="impedance", impedance=ImpedanceConfig(force_filter="butterworth", force_cutoff_hz=1.0))
    _, out = _run(params, (), [*_bias_phase(), *(_sample(t) for t in range(9))])
    assert all(thought.force_mean_n == 0.0 and thought.x_set_m == thought.x_nominal_m for _, thought in out[-9:])
    _, out = _run(params, (), [*_bias_phase(), *(_sample(t, force=60) for t in range(600))])
    push_n = 30 * params.calibration.force_n_per_count
    assert out[len(_bias_phase())][1].force_mean_n < 0.01 * push_n
    assert out[-1][1].force_mean_n == pytest.approx(push_n, rel=1e-4)
    assert out[-1][1].force_n == pytest.approx(push_n)


def test_after_a_cut_an_adaptation_starts_from_nothing():
    params = _params(target="impedance", adaptation=AdaptationConfig("offset"))
    memory, _ = _run(params, (), [*_bias_phase(), *(_sample(t, force=90) for t in range(50))])
    assert memory.impedance.stiffness_loss > 0.0
    memory, _ = _run(params, (), [_sample(50, gate=REVOKED)], memory)
    assert memory.impedance.stiffness_loss == 0.0


def test_compensation_scales_what_the_model_feels_and_not_what_is_reported():
    impedance = ImpedanceConfig(damping_ratio=1.0, environment_n_per_m=6.2e3, setpoint_compensation=True)
    params = _params(target="impedance", impedance=impedance)
    samples = [*_bias_phase(), *(_sample(t) for t in range(2500))]
    _, out = _run(params, (Segment("force", "step", amount=10.0),), samples)
    offset = out[-1][1].x_set_m[2] - out[-1][1].x_nominal_m[2]
    assert offset == pytest.approx(-10.0 * params.impedance.force_gain / params.impedance.stiffness_n_per_m, rel=1e-4)
    assert out[-1][1].force_set_n == 10.0


@pytest.mark.parametrize(("axis", "sign"), [(2, 1.0), (0, -1.0)])
def test_the_torque_law_is_the_final_law_and_a_current_against_the_push(axis, sign):
    samples = [*_bias_phase(), *(_sample(t, force=30 + t, counts=_moved(0, t // 9)) for t in range(90))]
    plain = _run(_params(axis, sign, law="final", target="joint"), JOINT_STEP, samples)[1]
    params = _params(axis, sign, law="torque", target="joint")
    for (_, final), (_, aware) in zip(plain, _run(params, JOINT_STEP, samples)[1], strict=True):
        x, q, push_n = aware.x_m, aware.q, sign * aware.force_mean_n if aware.tick >= 0 else 0.0
        reach_m, height_m = math.hypot(x[0], x[1]), x[2]
        load_2 = -reach_m * push_n if axis == 2 else height_m * math.cos(q[0]) * push_n
        assert aware.current_a[1] - final.current_a[1] == pytest.approx(-0.068e-3 * load_2, abs=1e-12)
        assert aware.integral_a == final.integral_a
    assert abs(load_2) > 30.0


def test_a_set_point_beyond_the_travel_is_clamped_and_reported():
    params = _params(target="cartesian")
    _, out = _run(params, (Segment("x", "step", amount=2.0),), [*_bias_phase(), _sample(0)])
    assert out[-1][1].clamped != 0
    assert out[-1][1].q_set[2] == params.geometry.high_q[2]
    assert out[-2][1].clamped == 0


def test_the_final_law_brings_links_with_a_dead_valve_to_the_set_point():
    # links that move at 60 deg/s (1 m/s) per A beyond a dead band of 80 mA, on the true encoders
    params = _params(target="joint", law="final")
    ramps = tuple(
        Segment(channel, "ramp", duration_s=2.0, amount=amount, blend_s=0.4)
        for channel, amount in (("q1", 0.1), ("q2", -0.1), ("q3", 0.1))
    )
    table, memory, dac = segment_table(ramps), control_start(params), STOPPED
    scale, offset = params.calibration.scale, params.calibration.offset
    q = [scale[i] * (COUNTS[i] + 0.5) + offset[i] for i in range(3)]
    for tick in range(FIRST, 1200):
        counts = (*(int((q[i] - offset[i]) / scale[i]) for i in range(3)), 0, 33)
        memory, codes, thought = control_step(memory, params, table, _sample(tick, counts=counts, dac=dac, open_samples=tick))
        dac = codes
        for i, code in enumerate(codes):
            u = code_to_current(UNIMATE.drive, code)
            q[i] += DT_S * math.copysign(max(0.0, abs(u) - 0.08), u)
    assert thought.clamped == 0
    for i in range(3):
        assert abs(thought.q[i] - thought.q_set[i]) <= 1.01 * params.gains[i].error_dead_zone_q


def test_plain_and_compiled_agree_in_every_bit_for_all_laws_targets_filters_and_adaptations():
    fast, rng = compiled(control_step), np.random.default_rng(11)
    joint = (Segment("q1", "sine", 0.0, 1.0, 0.1, frequency_hz=1.0), Segment("q2", "ramp", 0.1, 0.5, 0.1, blend_s=0.2))
    space = (Segment("z", "sine", 0.0, 1.0, 0.05, frequency_hz=1.0), Segment("force", "step", 0.2, amount=50.0))
    moving = 0
    settings = [{"law": law, "target": target} for law, target in itertools.product(LAW_NAMES, TARGETS)]
    settings += [{"law": law, "impedance": ImpedanceConfig(formulation="measured")} for law in LAW_NAMES]
    settings += [
        {"impedance": ImpedanceConfig(force_filter=name, force_cutoff_hz=2.0), "adaptation": AdaptationConfig(kind, onset_n=5.0)}
        for name, kind in (("butterworth", "stiffness"), ("bounded", "offset"), ("bounded", "limit_switch"))
    ]
    for setting in settings:
        params = _params(**setting)
        table = segment_table(joint if setting.get("target") == "joint" else space)
        memory, quick, array = control_start(params), control_start(params), np.array(table)
        walk = np.cumsum(rng.integers(-2, 3, (330, 3)), axis=0)
        dac = STOPPED
        for i in range(330):
            tick = FIRST + i
            gate = REVOKED if 200 <= tick < 215 else None
            step = tuple(int(v) for v in walk[i])
            sample = _sample(
                tick, _moved(*step), int(30 + rng.integers(-9, 9)), gate, dac, max(tick, 0), late_ns=int(rng.integers(9)) * 50_000
            )
            memory, dac, thought = control_step(memory, params, table, sample)
            quick, codes, also = fast(quick, params, array, sample)
            assert (codes, repr(also)) == (dac, repr(thought))
            moving += dac != STOPPED
        assert repr(quick) == repr(memory)
    assert moving > 1000


TIGHT = 100
NONE, ALL = (0, 0, 0), (1, 1, 1)


def _changed(memory, links, until=0):
    return memory._replace(handover=Handover(links, until))


@pytest.mark.parametrize("law", [law for law in LAW_NAMES if law != "pi"])
def test_a_law_that_takes_over_holds_the_accepted_current_and_goes_on_from_it(law):
    old, new = _params(law="pi", target="joint"), _params(law=law, target="joint")
    memory, _ = _run(old, JOINT_STEP, [*_bias_phase(), *(_sample(t) for t in range(30))])
    held = (2300, 1900, 2048)
    memory, ((codes, thought),) = _run(new, JOINT_STEP, [_sample(30, dac=held)], _changed(memory, ALL))
    assert all(abs(code - before) <= 1 for code, before in zip(codes, held, strict=True))  # the converter truncates
    assert thought.current_a == tuple(code_to_current(UNIMATE.drive, code) for code in held) and thought.boosted == (0, 0, 0)
    assert memory.handover.links == NONE
    for state, gains, q, q_set, current_a in zip(
        memory.laws, new.gains, thought.q, thought.q_set, thought.current_a, strict=True
    ):
        if law not in ("deadband", "hysteresis"):
            assert state.integral_a == pytest.approx(current_a - gains.kp_a_per_q * (q_set - q))


def test_only_the_links_that_are_named_take_over_and_those_that_do_not_act_stay_without_current():
    params = _params(law="final", target="joint", acting=(True, True, False))
    segments = JOINT_STEP[:2]
    memory, _ = _run(params, segments, [*_bias_phase(), *(_sample(t) for t in range(30))])
    sample = _sample(30, dac=(2300, 1900, 2048))
    _, ((_, alone),) = _run(params, segments, [sample], memory)
    memory, ((_, thought),) = _run(params, segments, [sample], _changed(memory, (0, 1, 1)))
    assert thought.current_a == (alone.current_a[0], code_to_current(UNIMATE.drive, 1900), 0.0)
    assert memory.laws[2].integral_a == 0.0


@pytest.mark.parametrize(("until", "step"), [(1031, TIGHT), (1030, 2456)])
def test_the_tight_slew_limit_of_a_change_holds_up_to_its_last_sample_and_not_at_the_next(until, step):
    params = _params(law="pi", target="joint")
    memory, _ = _run(params, JOINT_STEP, [*_bias_phase(), *(_sample(t) for t in range(30))])
    _, ((codes, _),) = _run(params, JOINT_STEP, [_sample(30, dac=(820, 820, 820))], _changed(memory, NONE, until))
    (free, _), *_ = _run(params, JOINT_STEP, [_sample(30, dac=(820, 820, 820))], memory)[1]
    assert all(code > 820 + TIGHT for code in free)
    assert codes == (free if step > TIGHT else (820 + TIGHT,) * 3)


def test_a_trial_that_begins_knows_nothing_of_a_change_before():
    params = _params(target="joint")
    memory, _ = _run(params, (), [*_bias_phase(), _sample(0)])
    memory, _ = _run(params, (), [_sample(FIRST, number=5000)], _changed(memory, ALL, 10**6))
    assert memory.handover == Handover(NONE, 0)
