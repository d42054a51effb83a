"""Which parameters may change while a trial runs, and how the change is spread over the samples."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.controller.actuation import Handover
from hydrohil.services.controller.checks import CHECKED_AT_ONCE, check, examine
from hydrohil.services.controller.config import AdaptationConfig, ControllerConfig, ImpedanceConfig, Segment, controller_params
from hydrohil.services.controller.contact_environment import ContactEnvironment
from hydrohil.services.controller.parameter_change import (
    FIXED,
    RAMPED,
    Change,
    Difference,
    acting,
    assigned,
    begun,
    blended,
    differences,
    handed_over,
    leaves,
    may_change,
)
from hydrohil.services.controller.step import control_start
from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.plant_description import describe
from hydrohil.shared.machine.unimate import UNIMATE

DESCRIPTION = describe(PlantConfig(), GateLimits())
PERIOD_NS = 4_500_000
RAMP = 111  # 0.5 s
LOADED = ControllerConfig(adaptation=AdaptationConfig(kind="offset"))
MEMORY = control_start(controller_params(LOADED, DESCRIPTION, -10))
DIFFERENT = {  # any other value of what stays
    "target": "joint",
    "acting.rotate": "false",
    "acting.down_up": "false",
    "acting.out_in": "false",
    "impedance.damping": "model",
    "impedance.environment_n_per_m": "1e3",
    "impedance.setpoint_compensation": "true",
    "impedance.formulation": "measured",
    "impedance.force_filter": "butterworth",
    "impedance.force_cutoff_hz": "0.5",
    "impedance.force_noise_n": "5.0",
    "impedance.apparent_stiffness_n_per_m": "1e3",
    "impedance.contact_n": "5.0",
    "adaptation.kind": "stiffness",
    "slew_codes": "2000",
    "tight_slew_codes": "50",
    "tight_samples": "30",
    "recover_current_a.rotate": "0.0",
    "recover_current_a.down_up": "0.0",
    "recover_current_a.out_in": "0.0",
}


def test_every_parameter_may_change_or_has_a_reason_why_not():
    paths = [path for path, _ in leaves(LOADED)]
    assert len(paths) == len(set(paths)) > 80
    assert {path for path in paths if not may_change(path)} == set(FIXED) == {f"controller.{name}" for name in DIFFERENT}
    assert set(RAMPED) <= set(paths)


@pytest.mark.parametrize("name", DIFFERENT)
def test_what_is_no_law_no_gain_and_no_number_of_the_target_stays_and_says_why(name):
    with pytest.raises(ValueError) as refused:
        assigned(LOADED, [f"controller.{name}={DIFFERENT[name]}"])
    assert f"controller.{name} stays while a trial runs: {FIXED[f'controller.{name}']}" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("path", "on", "past"),
    [
        ("controller.gains.down_up.kp_a_per_rad", 0.0, -5e-324),
        ("controller.gains.out_in.alpha_max_m2_per_s2", 5e-324, 0.0),
        ("controller.impedance.stiffness_n_per_m", 1e7, math.nextafter(1e7, math.inf)),
        ("controller.impedance.mass_kg", 1e6, math.nextafter(1e6, math.inf)),
        ("controller.impedance.damping_ratio", 100.0, math.nextafter(100.0, math.inf)),
        ("controller.adaptation.release_s", 1e3, math.nextafter(1e3, math.inf)),
    ],
)
def test_a_value_is_taken_on_its_bound_and_refused_just_past_it(path, on, past):
    taken = assigned(LOADED, [f"{path}={on!r}"])
    assert [(found.path, found.new) for found in differences(LOADED, taken)] == [(path, on)]
    with pytest.raises(ValueError, match="Input should be"):
        assigned(LOADED, [f"{path}={past!r}"])


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("controller.lav=pi", "lav is no field of controller; use one of law"),
        ("controller.law=p", "controller.law is 'p'"),
        ("controller.law=final", "nothing would change"),
        ("controller.impedance.stiffness_n_per_m=nan", "stiffness_n_per_m"),
        ("controller=3", "is a section"),
        ("supervisor.force_limit_n=100", "only [controller] may change"),
        ("duration_s=3", "only [controller] may change"),
        ("controller.law", "expected path=value"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(assignment, words):
    with pytest.raises(ValueError) as refused:
        assigned(LOADED, [assignment])
    assert words in str(refused.value) and "\n" not in str(refused.value)


PATHS = [path for path, _ in leaves(LOADED)]


@given(st.sampled_from(["", *PATHS]), st.sampled_from(["", "="]), st.text(max_size=30))
def test_whatever_is_asked_for_is_taken_or_refused_in_one_line(path, sign, text):
    try:
        after = assigned(LOADED, [path + sign + text])
    except ValueError as refused:
        assert "\n" not in str(refused)
    else:
        assert all(may_change(found.path) for found in differences(LOADED, after))


def test_of_a_change_all_acts_or_nothing():
    with pytest.raises(ValueError, match="tight_samples"):
        assigned(LOADED, ["controller.law=pi", "controller.tight_samples=0"])


def test_what_the_trial_does_not_use_is_refused_instead_of_ignored():
    joint, rigid = ControllerConfig(target="joint"), ControllerConfig()
    with pytest.raises(ValueError, match="has no target impedance"):
        assigned(joint, ["controller.impedance.mass_kg=3.0"])
    with pytest.raises(ValueError, match="does not adapt"):
        assigned(rigid, ["controller.adaptation.stop_n=3.0"])
    assert assigned(ControllerConfig(target="explicit"), ["controller.impedance.mass_kg=3.0"]).impedance.mass_kg == 3.0


def test_a_gain_goes_by_its_link_in_the_unit_of_that_link():
    for path, number in (("controller.gains.down_up.kp_a_per_rad", 1), ("controller.gains.out_in.kp_a_per_m", 2)):
        after = assigned(LOADED, [f"{path}=3"])
        assert differences(LOADED, after) == (Difference(path, LOADED.gains[number].kp_a_per_q, 3.0),)


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("controller.gains.1.kp_a_per_rad", "links go by name; use one of rotate, down_up, out_in"),
        ("controller.gains.down_up.kp_a_per_q", "use one of kp_a_per_rad"),
        ("controller.gains.out_in.kp_a_per_rad", "use one of kp_a_per_m"),
    ],
)
def test_an_index_or_the_unit_of_another_link_is_refused_with_the_name_that_is_meant(path, words):
    with pytest.raises(ValueError) as refused:
        assigned(LOADED, [f"{path}=3"])
    assert words in str(refused.value)


def test_law_and_gains_act_at_once():
    after = assigned(LOADED, ["controller.law=pi", "controller.gains.down_up.kp_a_per_rad=3"])
    change = begun(50, LOADED, after, PERIOD_NS)
    assert change == Change(50, 50, LOADED, after)
    assert acting(change, 49) == LOADED and acting(change, 50) == after


def test_the_target_impedance_moves_over_half_a_second_mass_and_stiffness_geometrically():
    after = assigned(LOADED, ["controller.impedance.stiffness_n_per_m=200e3", "controller.impedance.damping_ratio=2.2"])
    change = begun(50, LOADED, after, PERIOD_NS)
    assert (change.first, change.last) == (50, 50 + RAMP - 1)
    ramp = [acting(change, number).impedance for number in range(49, 50 + RAMP)]
    assert ramp[0] == LOADED.impedance and ramp[-2] != ramp[-1] == after.impedance == acting(change, 10**6).impedance
    ratios = [b.stiffness_n_per_m / a.stiffness_n_per_m for a, b in pairwise(ramp)]
    assert ratios == pytest.approx([4.0 ** (1.0 / RAMP)] * RAMP)
    steps = [b.damping_ratio - a.damping_ratio for a, b in pairwise(ramp)]
    assert steps == pytest.approx([1.0 / RAMP] * RAMP)
    assert {impedance.mass_kg for impedance in ramp} == {LOADED.impedance.mass_kg}


def test_a_ramp_over_every_decade_that_may_be_stays_between_its_ends():
    light, heavy = (LOADED._replace(impedance=LOADED.impedance._replace(mass_kg=mass)) for mass in (1e-300, 1e6))
    ramp = [blended(light, heavy, share / 10).impedance.mass_kg for share in range(1, 10)]
    assert ramp == sorted(ramp) and ramp[0] > 1e-300 and ramp[-1] < 1e6


def test_a_mass_too_small_to_be_one_is_refused():
    tiny, small = (LOADED._replace(impedance=LOADED.impedance._replace(mass_kg=mass)) for mass in (5e-324, 1e-300))
    check(small, (), (0.0, 0.0, 0.212), geometry=UNIMATE.geometry)
    with pytest.raises(ValueError, match="mass_kg"):
        check(tiny, (), (0.0, 0.0, 0.212), geometry=UNIMATE.geometry)


@pytest.mark.parametrize("share", [0.0, 0.25, 1.0])
def test_what_does_not_change_keeps_its_bits_while_others_move(share):
    after = assigned(LOADED, ["controller.adaptation.onset_n=0.0", "controller.impedance.mass_kg=123.4"])
    between = blended(LOADED, after, share)
    moved = {found.path for found in differences(LOADED, between)} | {found.path for found in differences(between, after)}
    assert moved <= {"controller.adaptation.onset_n", "controller.impedance.mass_kg"}
    assert between.adaptation.onset_n == LOADED.adaptation.onset_n * (1.0 - share)


@pytest.mark.parametrize(
    ("assignments", "links"),
    [
        (["controller.law=pi"], (1, 1, 1)),
        (["controller.gains.rotate.kp_a_per_rad=3"], (1, 0, 0)),
        (["controller.gains.down_up.kp_a_per_rad=3", "controller.gains.out_in.ki_a_per_m_s=3"], (0, 1, 1)),
        (["controller.impedance.mass_kg=3"], (0, 0, 0)),
    ],
)
def test_those_links_take_over_whose_law_or_gains_are_others(assignments, links):
    change = begun(50, LOADED, assigned(LOADED, assignments), PERIOD_NS)
    memory = handed_over(MEMORY, change)
    assert memory == MEMORY._replace(handover=Handover(links, change.last + LOADED.tight_samples))


def test_the_tight_limit_of_an_earlier_change_is_not_shortened_and_without_tight_samples_there_is_none():
    long = begun(50, LOADED, assigned(LOADED, ["controller.impedance.mass_kg=3"]), PERIOD_NS)
    short = begun(60, long.after, assigned(long.after, ["controller.law=pi"]), PERIOD_NS)
    assert handed_over(handed_over(MEMORY, long), short).handover == Handover((1, 1, 1), 50 + RAMP - 1 + 20)
    loose = LOADED._replace(tight_samples=0)
    assert handed_over(MEMORY, begun(50, loose, loose._replace(law="pi"), PERIOD_NS)).handover == Handover((1, 1, 1), 0)


def test_a_configuration_is_examined_in_short_steps_as_it_is_checked():
    config = ControllerConfig(impedance=ImpedanceConfig(500.0, 50e3, 1.2, "net", 6200.0))
    reference = (Segment("force", "sine", 0.0, 10.0, 100.0, frequency_hz=0.5),)
    met = ContactEnvironment("free", 0.0, 2, 1.0, 0.0)
    start = (0.0, 0.0, 0.212)
    check(config, reference, start, 0.0, met, geometry=UNIMATE.geometry)
    assert len(list(examine(config, reference, start, 0.0, met, geometry=UNIMATE.geometry))) == 1001 // CHECKED_AT_ONCE
    soft = config._replace(impedance=config.impedance._replace(stiffness_n_per_m=100.0))
    for examined in (
        lambda: check(soft, reference, start, 0.0, met, geometry=UNIMATE.geometry),
        lambda: list(examine(soft, reference, start, 0.0, met, geometry=UNIMATE.geometry)),
    ):
        with pytest.raises(ValueError, match="beyond the travel"):
            examined()
