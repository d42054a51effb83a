"""Rows 27 to 34: laws and resets, starts and ends, operators, and several faults at once."""

import signal
from functools import partial

from hydrohil.faulttest.endings import run_ended
from hydrohil.faulttest.loads import requests
from hydrohil.faulttest.operators import disagreeing, recovered, reset_refused, stopped_by, stopped_while_tripped
from hydrohil.faulttest.orders import ORDERS, in_start_order, rejoined
from hydrohil.faulttest.pairs import PAIRS, paired
from hydrohil.faulttest.parameter_changes import switched, switched_live
from hydrohil.faulttest.trial import ByTests, Live, Row, Simulated


def _ending(words: str, how: signal.Signals, everything: bool) -> Live:
    return Live(words, partial(run_ended, how=how, everything=everything), max_trials=3, in_shared_cell=False)


OPERATOR = (
    Row(
        number="27",
        fault="law switched while moving; reset after a trip",
        must="command continuous; a reset moves nothing",
        bound="step <= slew",
        ways=(
            ByTests(
                "codes rise slowly at first; after a cut a law starts from nothing; nothing resumes without an operator",
                (
                    "tests/controller/test_step.py::test_codes_rise_by_the_tight_limit_at_first_and_by_the_experiments_later",
                    "tests/controller/test_step.py::test_after_a_cut_law_and_target_model_start_from_nothing",
                    "tests/controller/test_step.py::test_a_law_that_takes_over_holds_the_accepted_current_and_goes_on_from_it",
                    "tests/supervisor/test_modes.py::test_nothing_gains_permission_without_an_operators_act",
                ),
            ),
            Simulated("every law in turn while the link swings", switched, max_trials=10),
            Live("three laws in turn, with real processes", switched_live, max_trials=20),
        ),
    ),
    Row(
        number="27b",
        fault="over-force trip, then RECOVER, release, reset",
        must="only the unloading sign, low current, zero on release",
        bound="2 T + one hop",
        ways=(Live("held, released, reset on the stiff plate", recovered),),
    ),
    Row(
        number="28",
        fault="reset while the cause stands, held, replayed",
        must="refused",
        bound="0 effect",
        ways=(
            Live("three resets while the plant is frozen", reset_refused, max_trials=5),
            ByTests(
                "a reset is refused while the cause stands, when it is replayed, and when it was meant for an earlier start",
                (
                    "tests/supervisor/test_step.py::test_a_reset_is_refused_while_the_cause_stands_and_clears_it_afterwards",
                    "tests/shared/transport/test_requests.py::test_a_replayed_request_is_refused_before_anyone_serves_it",
                    "tests/shared/transport/test_requests.py::test_a_request_that_was_recorded_before_a_restart_has_no_effect_after_it",
                ),
            ),
        ),
    ),
    Row(
        number="29",
        fault="any start order, a service that joins late or anew",
        must="disarmed until all agree; then it arms",
        bound="no current before",
        ways=(
            Live("the four services by hand, in any order", in_start_order, max_trials=len(ORDERS), in_shared_cell=False),
            Live("one service ends and starts anew", rejoined, max_trials=8),
        ),
    ),
    Row(
        number="30",
        fault="versions or experiments differ",
        must="refuses to arm and names it",
        bound="hand-shake",
        ways=(
            Live("one service has another experiment", disagreeing, max_trials=3),
            ByTests(
                "another wire version is refused by name",
                ("tests/shared/contract/test_codec.py::test_a_header_that_is_not_ours_is_refused_by_name",),
            ),
        ),
    ),
    Row(
        number="31",
        fault="100 status requests a second",
        must="the same control timing",
        bound="within 10 %",
        ways=(Live("in turn with none", requests),),
    ),
    Row(
        number="32",
        fault="SIGINT, SIGTERM, terminal closed",
        must="valves at zero, recording closed and readable",
        bound="200 ms",
        ways=(
            _ending("SIGINT to `hydrohil run`", signal.SIGINT, False),
            _ending("SIGTERM to `hydrohil run`", signal.SIGTERM, False),
            _ending("SIGHUP to all that it started: the terminal is closed", signal.SIGHUP, True),
        ),
    ),
    Row(
        number="33",
        fault="E-stop by one operator, by two, during a trip",
        must="safe, latched",
        bound="T + one hop",
        ways=(
            Live("one operator", partial(stopped_by, operators=1)),
            Live("two at the same instant", partial(stopped_by, operators=2)),
            Live("during a trip", stopped_while_tripped),
        ),
    ),
    Row(
        number="34",
        fault="two faults at once",
        must="the most severe wins",
        bound="the larger bound",
        ways=(
            Simulated(f"{len(PAIRS)} pairs of sensors and valves", paired),
            ByTests(
                "of several broken rules the first decides",
                ("tests/supervisor/test_rules.py::test_of_several_broken_rows_the_first_decides",),
            ),
        ),
    ),
)
