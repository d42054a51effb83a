"""The configurations that follow one another in a trial, by its ticks: the same for the live service and for a rollout. Pure."""

from collections.abc import Iterable
from typing import NamedTuple

from hydrohil.services.controller.config import ControllerConfig, ScheduledChange
from hydrohil.services.controller.parameter_change import Change, acting, assigned, begun
from hydrohil.shared.units import NS_PER_S


class ParameterSchedule(NamedTuple):
    """What acts, and what is to act."""

    loaded: ControllerConfig
    waiting: tuple[tuple[int, ControllerConfig], ...] = ()  # first tick of each
    change: Change | None = None  # the newest that has begun

    @property
    def target(self) -> ControllerConfig:
        """What acts, or is being ramped to."""
        return self.loaded if self.change is None else self.change.after


def scheduled(
    loaded: ControllerConfig, changes: Iterable[ScheduledChange], period_ns: int
) -> tuple[tuple[int, ControllerConfig], ...]:
    """First tick and configuration of each change, by the nominal period; those of one tick are one. Raises ValueError."""
    config, waiting = loaded, {}
    for number, change in sorted(enumerate(changes), key=lambda entry: entry[1].at_s):
        try:
            config = assigned(config, change.set)
        except ValueError as error:
            raise ValueError(f"changes.{number}: {error}") from None
        waiting[-(-round(change.at_s * NS_PER_S) // period_ns)] = config
    return tuple(waiting.items())


def advance(schedule: ParameterSchedule, number: int, tick: int, period_ns: int) -> tuple[ParameterSchedule, Change | None]:
    """The schedule at this sample, and the change that begins with it."""
    due = [config for first, config in schedule.waiting if first <= tick]
    if not due:
        return schedule, None
    before = schedule.loaded if schedule.change is None else acting(schedule.change, number - 1)
    change = begun(number, before, due[-1], period_ns)
    return schedule._replace(waiting=schedule.waiting[len(due) :], change=change), change


def at(schedule: ParameterSchedule, number: int) -> ControllerConfig:
    """What acts at this sample."""
    return schedule.loaded if schedule.change is None else acting(schedule.change, number)


def moves(schedule: ParameterSchedule, number: int) -> bool:
    """Whether other parameters act at this sample than at the one before."""
    return schedule.change is not None and schedule.change.first <= number <= schedule.change.last
