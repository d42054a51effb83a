"""The configurations of one trial by tick and by sample."""

import pytest

from hydrohil.services.controller.config import ControllerConfig, ScheduledChange
from hydrohil.services.controller.parameter_change import Change, acting
from hydrohil.services.controller.parameter_schedule import ParameterSchedule, advance, at, moves, scheduled

LOADED = ControllerConfig()
PERIOD_NS = 4_500_000
PI = ScheduledChange(0.0045, ("controller.law=pi",))


def test_a_change_waits_for_the_first_tick_at_or_after_its_time():
    for at_s, tick in ((0.0, 0), (0.0045, 1), (0.0045001, 2), (1.0, 223)):
        ((first, config),) = scheduled(LOADED, (PI._replace(at_s=at_s),), PERIOD_NS)
        assert (first, config) == (tick, LOADED._replace(law="pi"))


def test_changes_build_on_one_another_in_the_order_of_their_times_and_those_of_one_tick_are_one():
    changes = (
        ScheduledChange(0.5, ("controller.gains.down_up.kp_a_per_rad=3",)),
        ScheduledChange(0.4999, ("controller.law=vetia",)),
        PI,
    )
    (first, one), (second, both) = scheduled(LOADED, changes, PERIOD_NS)
    assert (first, one.law, one.gains) == (1, "pi", LOADED.gains)
    assert (second, both.law, both.gains[1].kp_a_per_q) == (112, "vetia", 3.0)


def test_a_change_that_may_not_be_is_named_by_its_place():
    with pytest.raises(ValueError, match=r"changes\.1: controller\.tight_samples stays"):
        scheduled(LOADED, (PI, ScheduledChange(1.0, ("controller.tight_samples=0",))), PERIOD_NS)


def test_the_change_begins_with_the_first_sample_of_its_tick_or_later_and_once():
    schedule = ParameterSchedule(LOADED, scheduled(LOADED, (PI,), PERIOD_NS))
    assert advance(schedule, 40, 0, PERIOD_NS) == (schedule, None) and not moves(schedule, 40)
    for number, tick in ((41, 1), (43, 3)):  # two samples are lost
        moved, change = advance(schedule, number, tick, PERIOD_NS)
        assert change == Change(number, number, LOADED, LOADED._replace(law="pi"))
        assert moves(moved, number) and not moves(moved, number - 1) and not moves(moved, number + 1)
        assert at(moved, number) == change.after == moved.target
        assert advance(moved, number + 1, tick + 1, PERIOD_NS) == (moved, None)


def test_a_change_during_a_ramp_begins_where_the_ramp_is():
    soft = ScheduledChange(0.0, ("controller.impedance.stiffness_n_per_m=5e3",))
    schedule = ParameterSchedule(LOADED, scheduled(LOADED, (soft, PI._replace(at_s=0.09)), PERIOD_NS))
    schedule, first = advance(schedule, 100, 0, PERIOD_NS)
    assert moves(schedule, 100) and moves(schedule, 210) and not moves(schedule, 211)
    schedule, second = advance(schedule, 120, 20, PERIOD_NS)
    assert second.before == acting(first, 119) and second.before not in (LOADED, first.after)
    assert second.after == first.after._replace(law="pi")
    assert (second.first, second.last) == (120, 230)
