import math
from functools import partial

import pytest

from hydrohil.services.controller import checks
from hydrohil.services.controller.config import AdaptationConfig, ControllerConfig, ImpedanceConfig, Segment, controller_params
from hydrohil.services.controller.contact_environment import ContactEnvironment
from hydrohil.services.controller.kinematics import inverse
from hydrohil.services.controller.params import FORMULATION_MEASURED
from hydrohil.shared.contract.pose import forward
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.machines import description

DESCRIPTION = description()


POSE = (0.0, 0.0, 0.212)


JOINT = ControllerConfig(target="joint")
check = partial(checks.check, geometry=UNIMATE.geometry)


def test_an_onset_on_the_ceiling_leaves_no_room_to_give_way():
    with pytest.raises(ValueError, match="onset_n 100 N must lie below ceiling_n 100 N"):
        check(ControllerConfig(adaptation=AdaptationConfig("offset", 100.0, 100.0)), (), POSE)
    check(ControllerConfig(adaptation=AdaptationConfig("offset", 99.0, 100.0)), (), POSE)
    check(ControllerConfig(adaptation=AdaptationConfig("none", 100.0, 100.0)), (), POSE)


def test_an_adaptation_of_a_target_that_it_does_not_reach_is_refused():
    for config in (JOINT, ControllerConfig(impedance=ImpedanceConfig(formulation="measured"))):
        with pytest.raises(ValueError, match="'offset' adapts target 'impedance', formulation 'setpoint' only"):
            check(config._replace(adaptation=AdaptationConfig("offset")), (), POSE)


@pytest.mark.parametrize(
    ("config", "segment", "says"),
    [
        (JOINT, Segment("x", "step", amount=0.01), "segment 0 .x, step.: target 'joint' reads q1, q2 or q3"),
        (ControllerConfig(), Segment("q1", "step", amount=0.01), "reads x, y, z or force"),
        (JOINT, Segment("q1", "ramp", amount=0.01), "duration_s must be > 0"),
        (JOINT, Segment("q1", "ramp", duration_s=1.0, blend_s=0.51, amount=0.01), "two blends of 0.51 s do not fit"),
        (JOINT, Segment("q1", "sine", duration_s=1.0, amount=0.01), "frequency_hz must be > 0"),
        (JOINT, Segment("q2", "step", start_s=1.5, amount=0.472), r"leaves the travel of down/up \(high, 0.471 rad\) at 1.50 s"),
        (JOINT, Segment("q3", "ramp", duration_s=2.0, amount=-0.3), r"leaves the travel of out/in \(low, 0 m\)"),
        (ControllerConfig(), Segment("z", "sine", duration_s=4.0, amount=0.9, frequency_hz=0.25), "leaves the travel"),
    ],
)
def test_what_does_not_fit_together_is_refused_in_one_line(config, segment, says):
    with pytest.raises(ValueError, match=says) as refused:
        check(config, (segment,), POSE)
    assert "\n" not in str(refused.value)


def test_a_reference_up_to_the_end_of_travel_is_taken():
    q2 = UNIMATE.geometry.high_q[1]
    check(JOINT, (Segment("q2", "step", amount=q2), Segment("q1", "ramp", duration_s=1.0, blend_s=0.5, amount=1.9)), POSE)


def test_compensation_without_an_environment_and_a_tight_limit_above_the_wide_one_are_refused():
    with pytest.raises(ValueError, match="setpoint_compensation needs environment_n_per_m"):
        check(ControllerConfig(impedance=ImpedanceConfig(environment_n_per_m=0.0, setpoint_compensation=True)), (), POSE)
    with pytest.raises(ValueError, match="tight_slew_codes 100 exceeds slew_codes 50"):
        check(ControllerConfig(slew_codes=50), (), POSE)


EXPLICIT = ControllerConfig(target="explicit")


MEASURED = ImpedanceConfig(formulation="measured")


@pytest.mark.parametrize(
    ("config", "segment", "says"),
    [
        (
            EXPLICIT._replace(impedance=ImpedanceConfig(environment_n_per_m=0.0)),
            None,
            "'explicit' divides by environment_n_per_m",
        ),
        (EXPLICIT, Segment("z", "step", amount=0.01), "target 'explicit' reads force"),
        (EXPLICIT, Segment("q2", "step", amount=0.01), "target 'explicit' reads force"),
        (EXPLICIT._replace(impedance=MEASURED), None, "'explicit' is the equivalent of formulation 'setpoint'"),
        (JOINT._replace(impedance=MEASURED), None, "'measured' is of target 'impedance', not 'joint'"),
        (ControllerConfig(target="cartesian"), Segment("force", "step", amount=50.0), "target 'cartesian' reads x, y or z"),
        (ControllerConfig(impedance=MEASURED, acting=(False, True, True)), None, "all links must act"),
        (ControllerConfig(acting=(False, False, False)), None, "no link acts"),
        (
            JOINT._replace(acting=(False, True, True)),
            Segment("q1", "step", amount=0.01),
            "moves q1, which controller.acting holds",
        ),
    ],
)
def test_force_control_formulations_and_links_that_do_not_fit_are_refused_in_one_line(config, segment, says):
    with pytest.raises(ValueError, match=says) as refused:
        check(config, (segment,) if segment else (), POSE)
    assert "\n" not in str(refused.value)


def test_what_acts_and_how_the_target_is_formulated_reach_the_kernel_as_numbers():
    check(EXPLICIT, (Segment("force", "step", amount=50.0),), POSE)
    check(ControllerConfig(impedance=MEASURED), (Segment("z", "step", amount=0.01),), POSE)
    params = controller_params(ControllerConfig(impedance=MEASURED, acting=(False, True, False)), DESCRIPTION, -444)
    assert (params.acting, params.impedance.formulation) == ((0, 1, 0), FORMULATION_MEASURED)
    assert params.impedance.environment_n_per_m == 25e3


SOFT_TARGET = ControllerConfig(impedance=ImpedanceConfig(125.0, 500.0, 1.0, "model", 6200.0))


FREE, PLATE = ContactEnvironment("free", 0.0, 2, 1.0, 0.0), ContactEnvironment("plate", 6231.0, 2, 1.0, -0.37)


def push(amount):
    return (Segment("force", "step", 0.5, amount=amount),)


def test_a_force_set_point_that_would_take_the_tool_out_of_travel_is_refused_with_the_bound():
    check(SOFT_TARGET, push(100.0), POSE, 0.0, FREE)
    with pytest.raises(ValueError, match=r"force set-point 2000 N on 500 N/m .* down/up \(high, 0.471 rad\).* at 0.50 s"):
        check(SOFT_TARGET, push(2000.0), POSE, 0.0, FREE)


def test_the_largest_force_of_the_travel_is_taken_and_a_newton_more_is_not():
    x, _, z = forward(UNIMATE.geometry, POSE, 0.0)
    low, high = 0.0, 1000.0
    for _ in range(40):  # the deepest z at this reach, by bisection on the inverse kinematics
        middle = 0.5 * (low + high)
        clamped = inverse(UNIMATE.geometry, (x, 0.0, z - middle / 500.0), 0.0)[1]
        low, high = (low, middle) if clamped else (middle, high)
    check(SOFT_TARGET, push(low), POSE, 0.0, FREE)
    with pytest.raises(ValueError, match="force set-point"):
        check(SOFT_TARGET, push(low + 1.0), POSE, 0.0, FREE)


def test_compensation_makes_the_push_larger_and_a_plate_holds_it():
    target = ControllerConfig(impedance=ImpedanceConfig(500.0, 50.0, 5.0, "net", 6200.0))
    with pytest.raises(ValueError, match="force set-point"):
        check(target, push(100.0), POSE, 0.0, FREE)
    check(target, push(100.0), POSE, 0.0, PLATE)
    check(SOFT_TARGET._replace(target="cartesian"), (Segment("z", "step", amount=0.01),), POSE, 0.0, FREE)
    stiff = ImpedanceConfig(500.0, 5e3, 1.0, "net", 100.0)
    check(ControllerConfig(impedance=stiff), push(100.0), POSE, 0.0, FREE)
    with pytest.raises(ValueError, match="force set-point 5100 N on 5000 N/m"):
        check(ControllerConfig(impedance=stiff._replace(setpoint_compensation=True)), push(100.0), POSE, 0.0, FREE)


def test_a_force_that_is_too_large_amid_its_sine_is_found():
    sine = (Segment("force", "sine", 0.0, 10.0, 300.0, frequency_hz=0.1),)
    check(SOFT_TARGET, (sine[0]._replace(amount=100.0),), POSE, 0.0, FREE)
    with pytest.raises(ValueError, match="force set-point"):
        check(SOFT_TARGET, sine, POSE, 0.0, FREE)


@pytest.mark.parametrize(
    ("config", "says"),
    [
        (ControllerConfig(target="cartesian"), "is of target 'impedance'"),
        (ControllerConfig(impedance=ImpedanceConfig(formulation="measured")), "formulation 'setpoint'"),
        (ControllerConfig(adaptation=AdaptationConfig("stiffness")), "without adaptation"),
        (ControllerConfig(impedance=ImpedanceConfig(environment_n_per_m=0.0)), "needs environment_n_per_m > 0"),
        (ControllerConfig(impedance=ImpedanceConfig(stiffness_n_per_m=1500.0)), "1500 N/m must lie below .* 1500 N/m"),
    ],
)
def test_an_apparent_stiffness_that_nothing_can_show_is_refused_in_one_line(config, says):
    config = config._replace(impedance=config.impedance._replace(apparent_stiffness_n_per_m=1500.0))
    with pytest.raises(ValueError, match=says) as refused:
        check(config, (), POSE)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "config",
    [
        ControllerConfig(target="explicit", impedance=ImpedanceConfig(environment_n_per_m=math.nan)),
        ControllerConfig(impedance=ImpedanceConfig(environment_n_per_m=math.nan, setpoint_compensation=True)),
        ControllerConfig(impedance=ImpedanceConfig(apparent_stiffness_n_per_m=math.nan)),
        ControllerConfig(adaptation=AdaptationConfig("offset", math.nan)),
    ],
)
def test_what_is_not_a_number_fits_nothing(config):
    with pytest.raises(ValueError, match="controller"):
        check(config, (), POSE)


@pytest.mark.parametrize("pose", [(math.nan, 0.0, 0.212), (0.0, math.inf, 0.212)])
def test_a_start_pose_that_is_not_finite_is_refused(pose):
    with pytest.raises(ValueError, match="start pose"):
        check(JOINT, (), pose)
