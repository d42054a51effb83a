"""Rows 17 to 26: sensors, valves, limits, commands and parameters."""

from functools import partial

from hydrohil.faulttest.impact_trials import (
    beyond_joint,
    beyond_workspace,
    contact_energy,
    cut_by_the_gate,
    force_rate,
    impact_live,
    long_contact,
    pushed_beyond_limit,
)
from hydrohil.faulttest.parameter_changes import pressed, pressed_live, refused_live
from hydrohil.faulttest.simulations import fault_trial, immobile_trial
from hydrohil.faulttest.trial import ByTests, Live, Row, Simulated
from hydrohil.shared.contract.faults import Fault

JUMP_S = 0.1


def _one(
    words: str, motion: str, kind: str, target: str, *, value: float = 0.0, bound_s: float = 0.0, periods: float = 0.0
) -> Simulated:
    """One fault in one motion; the bound is `bound_s` and so many T."""
    return Simulated(
        words,
        partial(
            fault_trial,
            motion=motion,
            faults=lambda at_s: (Fault(kind=kind, target=target, at_s=at_s, lasts_s=0.0, value=value),),
            bound=lambda period_s: bound_s + periods * period_s,
        ),
    )


def _immobile(words: str, kind: str, target: str, value: float = 0.0) -> Simulated:
    return Simulated(words, partial(immobile_trial, kind=kind, target=target, value=value))


MACHINE = (
    Row(
        number="17",
        fault="force reading out of range or saturated",
        must="invalid: safe; never read as zero",
        bound="T",
        ways=(
            _one("cable off (negative rail)", "press", "dropout", "force", periods=1.0),
            _one("saturated by an offset", "swing", "offset", "force", value=1000.0, periods=1.0),
            ByTests(
                "the limits of the gauge, at gate and supervisor",
                (
                    "tests/plant/test_gate_conditions.py::test_just_past_its_limit_a_condition_cuts_to_zero_current_and_revokes",
                    "tests/supervisor/test_rules.py::test_a_rule_breaks_just_past_its_limit_and_gives_its_own_numbers",
                ),
            ),
        ),
    ),
    Row(
        number="18",
        fault="force reading frozen, too quiet to be true",
        must="safe",
        bound="100 ms",
        ways=(
            _one("stuck, in free space", "swing", "stuck", "force", bound_s=JUMP_S),
            _one("stuck, in contact", "press", "stuck", "force", bound_s=JUMP_S),
        ),
    ),
    Row(
        number="19",
        fault="force reading offset, drift, gain error",
        must="safe once implausible",
        bound="100 ms for a jump",
        ways=(
            _one("a jump by 150 N in free space", "swing", "offset", "force", value=150.0, bound_s=JUMP_S),
            _one("three times the force, in contact", "press", "gain", "force", value=3.0, bound_s=JUMP_S),
        ),
    ),
    Row(
        number="20",
        fault="force above its limit: the plate hit at full speed",
        must="the supervisor trips; the gate cuts by its own limit",
        bound="2 T; the gate: its own latch",
        ways=(
            Simulated("pushed beyond the supervisor's 334 N", pushed_beyond_limit),
            Simulated("the gate's own limit, set below the supervisor's", cut_by_the_gate),
            Live("hit at full speed; overshoot measured", impact_live, max_trials=10),
        ),
    ),
    Row(
        number="21",
        fault="force rate, time above the contact level, energy into the environment",
        must="safe",
        bound="T beyond the limit, of the smoothed force",
        ways=(
            Simulated("hit at full speed: the rate", force_rate),
            Simulated("pushed: 100 N for 0.1 s", long_contact),
            Simulated("pushed: an energy of 0.5 J", contact_energy),
            ByTests(
                "each rule at its limit and just past it",
                ("tests/supervisor/test_rules.py::test_a_rule_breaks_just_past_its_limit_and_gives_its_own_numbers",),
            ),
        ),
    ),
    Row(
        number="22",
        fault="encoder jump, stuck counter, dropout, wrap",
        must="invalid: safe",
        bound="2 T; stuck: 200 ms of a current that must move it + 2 T",
        ways=(
            _one("a jump of 200 counts", "swing", "offset", "encoder_down_up", value=200.0, periods=2.0),
            _one("cable off", "swing", "dropout", "encoder_down_up", periods=2.0),
            _one("the highest bit flips", "swing", "wrap", "encoder_down_up", periods=2.0),
            _one("any code", "swing", "garbage", "encoder_down_up", periods=2.0),
            _immobile("stuck", "stuck", "encoder_down_up"),
        ),
    ),
    Row(
        number="23",
        fault="joint, workspace or speed limit; set-point outside the envelope",
        must="set-point shaped and reported; beyond the limit: safe",
        bound="T",
        ways=(
            Simulated("a joint limit within the swing", beyond_joint),
            Simulated("a workspace within the swing", beyond_workspace),
            ByTests(
                "the set-point is shaped and reported",
                ("tests/controller/test_step.py::test_a_set_point_beyond_the_travel_is_clamped_and_reported",),
            ),
        ),
    ),
    Row(
        number="24",
        fault="valve stuck, leak, supply lost, D/A stuck",
        must="current without motion, or motion against it: safe",
        bound="200 ms of such a current + 2 T",
        ways=(
            _immobile("spool stuck", "stuck", "valve_down_up"),
            _immobile("supply lost", "drop", "supply", value=1.0),
            _immobile("D/A stuck", "stuck", "dac_down_up"),
            _immobile("leak, 1000 times", "leak", "valve_down_up", value=1000.0),
        ),
    ),
    Row(
        number="25",
        fault="command out of range, beyond slew, no number",
        must="the gate refuses and writes zero; the supervisor trips",
        bound="T",
        ways=(
            ByTests(
                "every condition at its limit and just past it; a current that is no number stops",
                (
                    "tests/plant/test_gate_conditions.py::test_a_command_may_move_by_the_slew_limit_and_not_by_one_more",
                    "tests/plant/test_gate_conditions.py::test_just_past_its_limit_a_condition_cuts_to_zero_current_and_revokes",
                    "tests/supervisor/test_step.py::test_a_gate_that_has_cut_trips",
                    "tests/controller/test_step.py::test_a_current_that_is_no_number_stops_at_once",
                ),
            ),
        ),
    ),
    Row(
        number="26",
        fault="parameter out of bounds, or changed in contact",
        must="refused, nothing changes; what may change is ramped, no trip",
        bound="0; command step within the tight limit",
        ways=(
            Live("out of bounds, unknown, of another section, a limit: while pressing", refused_live, max_trials=5),
            Simulated("impedance or gains, while pressing", pressed, max_trials=10),
            Live("the same with real processes", pressed_live, max_trials=20),
            ByTests(
                "a load is refused while armed or running; of a change all or nothing acts, limits never",
                (
                    "tests/controller/test_parameter_change.py::test_a_value_is_taken_on_its_bound_and_refused_just_past_it",
                    "tests/controller/test_parameter_change.py::test_what_is_no_law_no_gain_and_no_number_of_the_target_stays_and_says_why",
                    "tests/supervisor/test_service.py::test_neither_load_nor_commit_is_taken_while_armed_or_running",
                    "tests/supervisor/test_service.py::test_an_experiment_may_tighten_a_limit_and_not_widen_it",
                ),
            ),
        ),
    ),
)
