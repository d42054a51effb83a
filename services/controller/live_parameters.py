"""Parameters that an operator or the experiment changes while a trial runs: examined, begun at a sample, taken back after it."""

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from hydrohil.services.controller.checks import examine
from hydrohil.services.controller.config import ControllerConfig, Reference
from hydrohil.services.controller.contact_environment import ContactEnvironment
from hydrohil.services.controller.parameter_change import Change, assigned, differences
from hydrohil.services.controller.parameter_schedule import ParameterSchedule, advance, at, moves
from hydrohil.services.controller.preflight import preflight
from hydrohil.shared.contract.assignments import text_of
from hydrohil.shared.contract.messages import NO_TRIAL, ParameterEvent
from hydrohil.shared.machine.description import Geometry, Triple
from hydrohil.shared.transport.requests import Request

_REMEMBERED = 256


class Loaded(NamedTuple):
    """What a change must agree with: the rest of the experiment."""

    schedule: ParameterSchedule
    reference: Reference
    q0: Triple
    pitch_rad: float
    met: ContactEnvironment
    geometry: Geometry
    lockstep: bool


class RequestedChange(NamedTuple):
    """A change by hand that does not act yet."""

    request: Request
    after: ControllerConfig
    examination: Iterator[None]


class Parameters:
    """The loaded experiment's parameters and how they change in its trial."""

    def __init__(self) -> None:
        """No experiment is loaded."""
        self.loaded: Loaded | None = None
        self.schedule = ParameterSchedule(ControllerConfig())
        self.busy = False  # parameters have changed in this trial, or will: each sample is looked at
        self.by_hand: deque[ParameterEvent] = deque(maxlen=_REMEMBERED)  # since the load
        self._requested: RequestedChange | None = None  # under examination
        self._accepted: Request | None = None  # acts at the next sample

    def load(self, loaded: Loaded) -> None:
        """Another experiment."""
        self.loaded = loaded
        self.by_hand.clear()
        self._begin_anew()

    def ask(self, request: Request, tick: int) -> None:
        """Examine a requested change; its request is answered when the change acts, or with the reason why it cannot."""
        assignments = request.arguments.get("set")
        if not isinstance(assignments, list) or not all(isinstance(text, str) for text in assignments):
            return request.refuse("`set` is no list of path=value: send such as controller.law=pi")
        loaded = self.loaded
        if loaded is None:
            return request.refuse("no experiment is loaded (`hydrohil run NAME` loads one)")
        try:
            self._refuse_now(loaded, tick)
            after = assigned(self.schedule.target, assignments)
        except ValueError as error:
            return request.refuse(str(error))
        pushed = loaded.met if after.impedance != self.schedule.target.impedance else None  # None: the load has checked it
        examination = examine(after, loaded.reference, loaded.q0, loaded.pitch_rad, pushed, geometry=loaded.geometry)
        self._requested = RequestedChange(request, after, examination)
        self.busy = True
        return None

    def _refuse_now(self, loaded: Loaded, tick: int) -> None:
        if tick == NO_TRIAL:
            raise ValueError("no trial runs: give the value with the load (`hydrohil run NAME --set PATH=VALUE`)")
        if loaded.lockstep:
            raise ValueError("a lockstep trial runs, which must repeat itself: schedule the change in its section [[changes]]")
        if loaded.schedule.waiting:
            raise ValueError("the section [[changes]] of this trial decides what changes: schedule it there")
        if self._requested is not None or self._accepted is not None:
            raise ValueError("another change does not act yet: ask again")

    @property
    def examines(self) -> bool:
        """Whether something is being examined."""
        return self._requested is not None

    def examine(self) -> None:
        """Examine the requested change one step further; a change that passes acts at the next sample."""
        if self._requested is None:
            return
        request, after, examination = self._requested
        try:
            next(examination)
        except StopIteration:
            self._requested, self._accepted = None, request
            self.schedule = self.schedule._replace(waiting=((NO_TRIAL, after),))
        except (ValueError, ArithmeticError) as error:
            self._requested = None
            request.refuse(str(error))

    def advance(self, number: int, tick: int, period_ns: int) -> tuple[Change | None, ControllerConfig | None]:
        """The change that begins at this sample; and what acts, if it is not what acted at the one before."""
        if tick == NO_TRIAL:
            moved = self.schedule.change is not None
            self._begin_anew()
            return None, self.schedule.loaded if moved else None
        self.schedule, change = advance(self.schedule, number, tick, period_ns)
        return change, at(self.schedule, number) if moves(self.schedule, number) else None

    def events(self, change: Change, tick: int) -> tuple[ParameterEvent, ...]:
        """The change as messages, one for each value; the request is answered with the same values."""
        request, self._accepted = self._accepted, None
        ramp = change.last - change.first + 1
        events = tuple(
            ParameterEvent(
                number=change.first,
                tick=tick,
                by_hand=int(request is not None),
                path=path,
                old=text_of(old),
                new=text_of(new),
                ramp_samples=ramp,
            )
            for path, old, new in differences(change.before, change.after)
        )
        if request is not None:
            self.by_hand.extend(events)
            changed = [{"path": event.path, "old": event.old, "new": event.new} for event in events]
            warnings = list(preflight(change.after, self.loaded.met)) if self.loaded is not None else []
            request.reply({"number": change.first, "ramp_samples": ramp, "changed": changed, "warnings": warnings})
        return events

    def changed(self) -> list[str]:
        """The values that are not as loaded, for a status."""
        found = differences(self.schedule.loaded, self.schedule.target)
        return [f"{path} {text_of(old)} -> {text_of(new)}" for path, old, new in found]

    def _begin_anew(self) -> None:
        """The loaded values, and what the experiment schedules."""
        for request in (self._accepted, self._requested and self._requested.request):
            if request is not None:
                request.refuse("the trial has ended before the change could act")
        self._requested = self._accepted = None
        if self.loaded is not None:
            self.schedule = self.loaded.schedule
        self.busy = bool(self.schedule.waiting)
