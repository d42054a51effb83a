import math

import pytest
from pydantic import ConfigDict, TypeAdapter, ValidationError

from hydrohil.services.controller.config import (
    AdaptationConfig,
    ControllerConfig,
    ImpedanceConfig,
    RecoverCurrents,
    Segment,
    controller_params,
    impedance_params,
    segment_table,
)
from hydrohil.services.controller.params import OUT_IN_GAINS, TARGET_JOINT, UNIMATE_GAINS
from hydrohil.shared.contract.envelope import checked
from hydrohil.shared.machine.description import machine_id
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.machines import description

DESCRIPTION = description()


JOINT = ControllerConfig(target="joint")


def test_a_dict_with_one_gain_changed_keeps_every_other_default():
    plain = {"law": "pi", "gains": {"out_in": {"kp_a_per_m": 10}}, "impedance": {"mass_kg": 50}}
    config = checked(plain, "controller", ControllerConfig)
    assert config.gains == UNIMATE_GAINS._replace(out_in=OUT_IN_GAINS._replace(kp_a_per_q=10.0))
    assert config.impedance == ImpedanceConfig(mass_kg=50.0)


@pytest.mark.parametrize(
    "wrong",
    [
        {"law": "pid"},
        {"slew_codes": 0},
        {"slew_codes": 2457},
        {"impedance": {"mass_kg": 0.0}},
        {"impedance": {"damping_ratio": -0.1}},
        {"recover_current_a": {"out_in": 0.201}},
    ],
)
def test_a_value_outside_its_bound_is_refused(wrong):
    with pytest.raises(ValidationError):
        TypeAdapter(ControllerConfig).validate_python(wrong)


@pytest.mark.parametrize("ok", [{"slew_codes": 1}, {"slew_codes": 2456}, {"recover_current_a": {"rotate": 0.0, "out_in": 0.2}}])
def test_a_value_on_its_bound_is_taken(ok):
    TypeAdapter(ControllerConfig).validate_python(ok)


def test_net_damping_counts_the_environments_stiffness():
    net = impedance_params(ImpedanceConfig(500.0, 50e3, 1.2, "net", 25e3), 2, 1.0)
    c = 2.0 * net.damping_ratio * math.sqrt(500.0 * 50e3)
    assert c == pytest.approx(2.0 * 1.2 * math.sqrt(500.0 * (50e3 + 25e3)))
    assert impedance_params(ImpedanceConfig(damping_ratio=0.3, damping="model"), 2, 1.0).damping_ratio == 0.3


def test_compensation_makes_the_steady_force_the_set_point():
    # the model and a spring k_eff share the load: f = gain f_d k_eff / (k + k_eff)
    k, k_eff = 50e3, 6.2e3
    gain = impedance_params(
        ImpedanceConfig(stiffness_n_per_m=k, environment_n_per_m=k_eff, setpoint_compensation=True), 2, 1.0
    ).force_gain
    assert gain * k_eff / (k + k_eff) == pytest.approx(1.0)
    assert gain == pytest.approx(9.06, abs=0.01)
    assert impedance_params(ImpedanceConfig(), 2, 1.0).force_gain == 1.0


def test_the_mean_of_three_has_no_cutoff_and_only_the_bounded_filter_knows_the_noise():
    mean, low_pass, bounded = (
        controller_params(ControllerConfig(impedance=ImpedanceConfig(force_filter=kind, force_cutoff_hz=2)), DESCRIPTION, -444)
        for kind in ("mean", "butterworth", "bounded")
    )
    assert (mean.force_cutoff_rad_per_s, low_pass.force_cutoff_rad_per_s) == (0.0, 4.0 * math.pi)
    assert (low_pass.force_noise_n, bounded.force_noise_n) == (math.inf, 10.0)


def test_kernel_parameters_hold_floats_even_where_ints_were_written():
    config = ControllerConfig(
        gains=UNIMATE_GAINS._replace(rotate=UNIMATE_GAINS.rotate._replace(kp_a_per_q=5)),
        impedance=ImpedanceConfig(mass_kg=1, stiffness_n_per_m=4, damping_ratio=1),
        recover_current_a=RecoverCurrents(0, 0, 0),
        adaptation=AdaptationConfig(
            kind="stiffness",
            onset_n=20,
            ceiling_n=100,
            softening_per_s=20,
            retreat_m_per_s=1,
            stop_n=100,
            stop_ns_per_m=1000,
            release_s=2,
        ),
    )
    params = controller_params(config, DESCRIPTION, -444)
    assert all(type(value) is float for gains in params.gains for value in gains)
    assert [type(value) for value in params.impedance] == [float, float, float, float, int, float, float, int]
    assert all(type(value) is float for value in params.recover_current_a)
    assert all(type(value) is float for value in params.adaptation[1:])
    assert type(params.force_noise_n) is float
    assert (params.impedance.natural_frequency_rad_per_s, params.first_tick) == (2.0, -444)


def test_the_machine_states_where_the_gauge_is_mounted_and_which_way_it_is_pushed():
    params = controller_params(JOINT, DESCRIPTION, -10)
    assert (params.impedance.force_axis, params.impedance.force_sign, params.target) == (0, -1.0, TARGET_JOINT)


def test_a_row_names_its_channel_and_kind_by_number_and_is_all_floats():
    (row,) = segment_table((Segment("force", "sine", 1.0, 2.0, 3.0, frequency_hz=0.5, phase_rad=0.25),))
    assert row == (6.0, 2.0, 1.0, 2.0, 3.0, 0.0, math.pi, 0.25, 3.0)
    assert all(type(value) is float for value in row)


def test_a_force_error_knows_no_dead_zone_and_a_position_error_does():
    for target, dead_zones in (("explicit", {0.0}), ("impedance", {g.error_dead_zone_q for g in UNIMATE_GAINS})):
        params = controller_params(ControllerConfig(target=target), DESCRIPTION, -444)
        assert {gains.error_dead_zone_q for gains in params.gains} == dead_zones


@pytest.mark.parametrize(
    "wrong",
    [
        {"mass_kg": -1.0},
        {"stiffness_n_per_m": 0.0},
        {"stiffness_n_per_m": -5.0},
        {"stiffness_n_per_m": math.nan},
        {"apparent_stiffness_n_per_m": 0.0},
        {"contact_n": -1.0},
    ],
)
def test_a_singular_or_negative_impedance_is_refused(wrong):
    with pytest.raises(ValidationError, match=r"greater than|finite number"):
        TypeAdapter(ControllerConfig, config=ConfigDict(allow_inf_nan=False)).validate_python({"impedance": wrong})


def test_the_controller_works_with_the_machine_that_is_described_and_states_which():
    longer = UNIMATE._replace(geometry=UNIMATE.geometry._replace(hand_m=0.7))
    plants = description(), description(machine=longer)
    params = [controller_params(ControllerConfig(), plant, 0) for plant in plants]
    assert [found.geometry.hand_m for found in params] == [0.5, 0.7]
    assert [found.machine_id for found in params] == [machine_id(plant.machine_hash) for plant in plants]
    assert params[0].machine_id != params[1].machine_id
