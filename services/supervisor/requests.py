"""What an operator may ask of the supervisor: events, which act at a sample, and the rest, which is answered at once."""

import os
from collections.abc import Callable
from typing import Any

from hydrohil.services.supervisor.cell_view import CellView, Loaded
from hydrohil.services.supervisor.event_queue import EVENTS, MOST_WAITING, EventQueue, granted
from hydrohil.services.supervisor.modes import DISARMED, TRIPPED, Event
from hydrohil.services.supervisor.state import SupervisorMemory
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.deadline_window import quality
from hydrohil.shared.contract.envelope import Envelope
from hydrohil.shared.contract.messages import Mode, TripCause
from hydrohil.shared.contract.timeliness import LATE_IN_A_ROW
from hydrohil.shared.host.qualified import plain
from hydrohil.shared.host.two_phase_load import TwoPhaseLoad
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.link_stats import nonzero_counts
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request
from hydrohil.shared.trips.causes import trip_words


class SupervisorRequests:
    """Answers the operator's requests. `memory()` is the supervisor's memory now, `judge_now()` a step without a new sample."""

    def __init__(
        self,
        bus: Bus,
        cell: CellView,
        faults: LiveFaults,
        *,
        memory: Callable[[], SupervisorMemory],
        judge_now: Callable[[], None],
        loaded: Callable[[Envelope], None],
    ) -> None:
        """`loaded` is called after another experiment was taken over."""
        self._bus, self._cell, self._faults = bus, cell, faults
        self._memory, self._judge_now, self._loaded = memory, judge_now, loaded
        self._loading = TwoPhaseLoad(bus, faults, busy=self._busy, check=cell.check, take=self._take)
        self.events = EventQueue()

    def answer(self, request: Request) -> None:
        """Answer one request, or let its event wait for the next step."""
        if request.verb in EVENTS:
            return self._queue(request)
        if request.verb == "load":
            return self._loading.load(request)
        if request.verb == "commit":
            return self._loading.commit(request)
        if request.verb == "status":
            return request.reply(self.status())
        if request.verb in ("inject", "clear"):
            return self._faults.answer(request, self._cell.samples.number)
        return request.refuse(f"the supervisor knows no request {request.verb!r}")

    def _queue(self, request: Request) -> None:
        """Events act at the next sample; an emergency stop does not wait for one."""
        if self._cell.description is None or self._cell.sample is None:
            return request.refuse("no sample has come from the plant yet: start it (`hydrohil plant`)")
        if request.verb != "estop" and len(self.events) >= MOST_WAITING:
            return request.refuse(f"{MOST_WAITING} requests wait already, and one acts a sample: ask again")
        self.events.put(EVENTS[request.verb], request)
        if request.verb == "estop":
            self._judge_now()
        return None

    def _busy(self) -> str:
        mode = Mode(self._memory().mode)
        return "" if mode == Mode.DISARMED else f"the mode is {mode.name}: stop or reset first"

    def _take(self, envelope: Envelope, loaded: Loaded) -> None:
        self._cell.load(envelope, loaded)
        self._loaded(envelope)

    def answer_event(self, event: Event, request: Request | None, message: Received) -> None:
        """Answer the event that has acted at this sample.

        A reset that is held is one: those that wait behind it get its answer and act at no later sample.
        """
        if request is not None:
            self._answer_event(event, request, message)
        if event == Event.RESET:
            for held in self.events.take_resets():
                self._answer_event(event, held, message)

    def _answer_event(self, event: Event, request: Request, message: Received) -> None:
        mode = Mode(self._memory().mode)
        if granted(event, mode):
            return request.reply(self.status())
        return request.refuse(f"{event.name.lower().replace('_', ' ')} refused in mode {mode.name}: {self._why(message)}")

    def _why(self, message: Received) -> str:
        if self._memory().pressed:
            return "the emergency stop is pressed; when the reason is gone: `hydrohil reset` (it releases gate and supervisor)"
        if self._memory().mode == TRIPPED:
            return f"{self._trip_words()}; the cause must be gone, then `hydrohil reset`"
        return self._cell.prearm_problem(message) or "see `hydrohil status`"

    def _trip_words(self) -> str:
        """Cause, number and limit of the latched trip."""
        memory = self._memory()
        return trip_words(memory.cause, memory.measured, memory.limit, memory.trip_number)

    def _warnings(self) -> list[str]:
        """Late answers that do not trip yet: the lease decides when they do."""
        late = self._memory().observer.answers.in_a_row
        if late <= LATE_IN_A_ROW or self._cell.description is None:
            return []
        return [f"{late} answers in a row were late or missing; the lease bears {self._cell.params.limits.lease_samples}"]

    def status(self) -> dict[str, Any]:
        """Mode and trip, what is loaded, what is warned of, and what the links have counted."""
        memory = self._memory()
        if memory.mode == DISARMED:  # reading a file must not delay a step while something may move
            self._cell.look_up_qualification()
        return {
            "pid": os.getpid(),
            "injected": self._faults.acting(),
            "ready": self._cell.complete,
            "mode": Mode(memory.mode).name,
            "cause": TripCause(memory.cause).name,
            "words": self._trip_words() if memory.cause else "",
            "measured": memory.measured,
            "limit": memory.limit,
            "arming_id": memory.arming_id,
            "force_bias_n": memory.observer.bias.mean_n,
            "machine": "" if self._cell.description is None else self._cell.description.machine.name,
            "machine_hash": "" if self._cell.description is None else self._cell.description.machine_hash.hex(),
            "experiment": self._bus.run.experiment.hex(),
            "run": self._bus.run.run,
            "in_time": quality(memory.observer.answers.missed),
            "warnings": self._warnings(),
            "qualification": plain(self._cell.qualification),
            "qualified": self._cell.qualification.words,
            "link_stats": nonzero_counts(self._cell.inboxes),
        }
