"""Rows 27 to 34: laws and resets, starts and ends, operators, and several faults at once."""

import signal
from functools import partial

from hydrohil.faulttest.endings import ended
from hydrohil.faulttest.loads import requests
from hydrohil.faulttest.operators import disagreeing, recovered, reset_refused, stopped_by, stopped_while_tripped
from hydrohil.faulttest.orders import ORDERS, rejoined, started_in_order
from hydrohil.faulttest.pairs import PAIRS, paired
from hydrohil.faulttest.retuned import switched, switched_live
from hydrohil.faulttest.trial import Lived, Played, Proved, Row


def _ending(words: str, how: signal.Signals, everything: bool) -> Lived:
    return Lived(words, partial(ended, how=how, everything=everything), most=3, whole=False)


OPERATOR = (
    Row(
        "27",
        "law switched while moving; reset after a trip",
        "command continuous; a reset moves nothing",
        "step <= slew",
        (
            Proved(
                "codes rise slowly at first; after a cut a law starts from nothing; nothing resumes without an operator",
                (
                    "tests/controller/test_step.py::test_codes_rise_by_the_tight_limit_at_first_and_by_the_experiments_later",
                    "tests/controller/test_step.py::test_after_a_cut_law_and_target_model_start_from_nothing",
                    "tests/controller/test_step.py::test_a_law_that_takes_over_holds_the_accepted_current_and_goes_on_from_it",
                    "tests/supervisor/test_modes.py::test_nothing_gains_permission_without_an_operators_act",
                ),
            ),
            Played("every law in turn while the link swings", switched, most=10),
            Lived("three laws in turn, with real processes", switched_live, most=20),
        ),
    ),
    Row(
        "27b",
        "over-force trip, then RECOVER, release, reset",
        "only the unloading sign, low current, zero on release",
        "2 T + one hop",
        (Lived("held, released, reset on the stiff plate", recovered),),
    ),
    Row(
        "28",
        "reset while the cause stands, held, replayed",
        "refused",
        "0 effect",
        (
            Lived("three resets while the plant is frozen", reset_refused, most=5),
            Proved(
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
        "29",
        "any start order, a service that joins late or anew",
        "disarmed until all agree; then it arms",
        "no current before",
        (
            Lived("the four services by hand, in any order", started_in_order, most=len(ORDERS), whole=False),
            Lived("one service ends and starts anew", rejoined, most=8),
        ),
    ),
    Row(
        "30",
        "versions or experiments differ",
        "refuses to arm and names it",
        "hand-shake",
        (
            Lived("one service has another experiment", disagreeing, most=3),
            Proved(
                "another wire version is refused by name",
                ("tests/shared/contract/test_codec.py::test_a_header_that_is_not_ours_is_refused_by_name",),
            ),
        ),
    ),
    Row(
        "31",
        "100 status requests a second",
        "the same control timing",
        "within 10 %",
        (Lived("in turn with none", requests),),
    ),
    Row(
        "32",
        "SIGINT, SIGTERM, terminal closed",
        "valves at zero, recording closed and readable",
        "200 ms",
        (
            _ending("SIGINT to `hydrohil run`", signal.SIGINT, False),
            _ending("SIGTERM to `hydrohil run`", signal.SIGTERM, False),
            _ending("SIGHUP to all that it started: the terminal is closed", signal.SIGHUP, True),
        ),
    ),
    Row(
        "33",
        "E-stop by one operator, by two, during a trip",
        "safe, latched",
        "T + one hop",
        (
            Lived("one operator", partial(stopped_by, operators=1)),
            Lived("two at the same instant", partial(stopped_by, operators=2)),
            Lived("during a trip", stopped_while_tripped),
        ),
    ),
    Row(
        "34",
        "two faults at once",
        "the most severe wins",
        "the larger bound",
        (
            Played(f"{len(PAIRS)} pairs of sensors and valves", paired),
            Proved(
                "of several broken rules the first decides",
                ("tests/supervisor/test_rules.py::test_of_several_broken_rows_the_first_decides",),
            ),
        ),
    ),
)
