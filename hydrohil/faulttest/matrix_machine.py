"""Rows 17 to 26: sensors, valves, limits, commands and parameters."""

from functools import partial

from hydrohil.faulttest.impact_trials import beyond_joint, beyond_workspace, gated, lasting, pushed, steep, struck_live, working
from hydrohil.faulttest.retuned import pressed, pressed_live, refused_live
from hydrohil.faulttest.simulations import broken, disobeyed
from hydrohil.faulttest.trial import Lived, Played, Proved, Row
from hydrohil.shared.contract.faults import Fault

JUMP_S = 0.1


def _one(words: str, motion: str, kind: str, target: str, value: float, bound_s: float, periods: float = 0.0) -> Played:
    """One fault in one motion; the bound is so many seconds and so many T."""
    return Played(
        words,
        partial(
            broken,
            motion=motion,
            faults=lambda at_s: (Fault(kind, target, at_s, 0.0, value),),
            bound=lambda period_s: bound_s + periods * period_s,
        ),
    )


def _disobeyed(words: str, kind: str, target: str, value: float = 0.0) -> Played:
    return Played(words, partial(disobeyed, kind=kind, target=target, value=value))


MACHINE = (
    Row(
        "17",
        "force reading out of range or saturated",
        "invalid: safe; never read as zero",
        "T",
        (
            _one("cable off (negative rail)", "press", "dropout", "force", 0.0, 0.0, 1.0),
            _one("saturated by an offset", "swing", "offset", "force", 1000.0, 0.0, 1.0),
            Proved(
                "the limits of the gauge, at gate and supervisor",
                (
                    "tests/plant/test_gate_conditions.py::test_just_past_its_limit_a_condition_cuts_to_zero_current_and_burns",
                    "tests/supervisor/test_rules.py::test_a_rule_breaks_just_past_its_limit_and_tells_its_own_numbers",
                ),
            ),
        ),
    ),
    Row(
        "18",
        "force reading frozen, too quiet to be true",
        "safe",
        "100 ms",
        (
            _one("stuck, in free space", "swing", "stuck", "force", 0.0, JUMP_S),
            _one("stuck, in contact", "press", "stuck", "force", 0.0, JUMP_S),
        ),
    ),
    Row(
        "19",
        "force reading offset, drift, gain error",
        "safe once implausible",
        "100 ms for a jump",
        (
            _one("a jump by 150 N in free space", "swing", "offset", "force", 150.0, JUMP_S),
            _one("three times the force, in contact", "press", "gain", "force", 3.0, JUMP_S),
        ),
    ),
    Row(
        "20",
        "force above its limit: the plate struck at full speed",
        "the supervisor trips; the gate cuts by its own limit",
        "2 T; the gate: its own latch",
        (
            Played("pushed beyond the supervisor's 334 N", pushed),
            Played("the gate's own limit, set below the supervisor's", gated),
            Lived("struck at full speed; overshoot told", struck_live, most=10),
        ),
    ),
    Row(
        "21",
        "force rate, time above the contact level, energy into the environment",
        "safe",
        "T beyond the limit, of the smoothed force",
        (
            Played("struck at full speed: the rate", steep),
            Played("pushed: 100 N for 0.1 s", lasting),
            Played("pushed: an energy of 0.5 J", working),
            Proved(
                "each rule at its limit and just past it",
                ("tests/supervisor/test_rules.py::test_a_rule_breaks_just_past_its_limit_and_tells_its_own_numbers",),
            ),
        ),
    ),
    Row(
        "22",
        "encoder jump, stuck counter, dropout, wrap",
        "invalid: safe",
        "2 T; stuck: 200 ms of a current that must move it + 2 T",
        (
            _one("a jump of 200 counts", "swing", "offset", "encoder_down_up", 200.0, 0.0, 2.0),
            _one("cable off", "swing", "dropout", "encoder_down_up", 0.0, 0.0, 2.0),
            _one("the highest bit flips", "swing", "wrap", "encoder_down_up", 0.0, 0.0, 2.0),
            _one("any code", "swing", "garbage", "encoder_down_up", 0.0, 0.0, 2.0),
            _disobeyed("stuck", "stuck", "encoder_down_up"),
        ),
    ),
    Row(
        "23",
        "joint, workspace or speed limit; set-point outside the envelope",
        "set-point shaped and said; beyond the limit: safe",
        "T",
        (
            Played("a joint limit within the swing", beyond_joint),
            Played("a workspace within the swing", beyond_workspace),
            Proved(
                "the set-point is shaped and said",
                ("tests/controller/test_step.py::test_a_set_point_beyond_the_travel_is_clamped_and_reported",),
            ),
        ),
    ),
    Row(
        "24",
        "valve stuck, leak, supply lost, D/A stuck",
        "current without motion, or motion against it: safe",
        "200 ms of such a current + 2 T",
        (
            _disobeyed("spool stuck", "stuck", "valve_down_up"),
            _disobeyed("supply lost", "drop", "supply", 1.0),
            _disobeyed("D/A stuck", "stuck", "dac_down_up"),
            _disobeyed("leak, 1000 times", "leak", "valve_down_up", 1000.0),
        ),
    ),
    Row(
        "25",
        "command out of range, beyond slew, no number",
        "the gate refuses and writes zero; the supervisor trips",
        "T",
        (
            Proved(
                "every condition at its limit and just past it; a current that is no number stops",
                (
                    "tests/plant/test_gate_conditions.py::test_a_command_may_move_by_the_slew_limit_and_not_by_one_more",
                    "tests/plant/test_gate_conditions.py::test_just_past_its_limit_a_condition_cuts_to_zero_current_and_burns",
                    "tests/supervisor/test_step.py::test_a_gate_that_has_cut_trips",
                    "tests/controller/test_step.py::test_a_current_that_is_no_number_stops_at_once",
                ),
            ),
        ),
    ),
    Row(
        "26",
        "parameter out of bounds, or changed in contact",
        "refused, nothing changes; what may change is ramped, no trip",
        "0; command step within the tight limit",
        (
            Lived("out of bounds, unknown, of another section, a limit: while pressing", refused_live, most=5),
            Played("impedance or gains, while pressing", pressed, most=10),
            Lived("the same with real processes", pressed_live, most=20),
            Proved(
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
