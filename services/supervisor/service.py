"""The supervisor's process: judges every sample, and its absence; says who may move."""

import os
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.lockstep_queue import LockstepQueue
from hydrohil.services.supervisor.modes import DISARMED, TRIPPED, Event
from hydrohil.services.supervisor.observe import LinkHealth
from hydrohil.services.supervisor.params import supervisor_params
from hydrohil.services.supervisor.prearm_checks import Declared, prearm_problem
from hydrohil.services.supervisor.state import SupervisorInput, SupervisorMemory
from hydrohil.services.supervisor.step import supervisor_step
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.deadline_window import quality
from hydrohil.shared.contract.envelope import Envelope, section
from hydrohil.shared.contract.messages import NO_COMMAND, Mode, Permit, PlantDescription, SampleDropped, TripCause
from hydrohil.shared.contract.timeliness import LATE_IN_A_ROW
from hydrohil.shared.host.process import draw_number, options_of, parser, serve
from hydrohil.shared.host.qualified import UNKNOWN, Standing, beyond, plain, standing
from hydrohil.shared.host.realtime import is_fifo
from hydrohil.shared.host.two_phase_load import Checked, TwoPhaseLoad
from hydrohil.shared.transport.bus import Bus, same_run
from hydrohil.shared.transport.impairment_queue import ImpairedSample
from hydrohil.shared.transport.link_stats import due, link_stats, nonzero_counts
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.protection import worst
from hydrohil.shared.transport.requests import Request
from hydrohil.shared.transport.step_lock import StepLock
from hydrohil.shared.trips.causes import trip_words
from hydrohil.shared.units import NS_PER_S

_IDLE_WAKE_S = 0.1
_LOCKSTEP_SILENCE_NS = 6 * NS_PER_S  # the plant gives up on a peer after 5 s
_MOST_ASKED = 64  # a third of a second of events, one a sample
_EVENTS = {
    "arm": Event.ARM,
    "start": Event.START,
    "stop": Event.STOP,
    "estop": Event.ESTOP,
    "reset": Event.RESET,
    "recover": Event.HOLD_RECOVER,
    "release": Event.RELEASE,
}
_EXPECTED = {
    Event.ARM: (Mode.ARMED,),
    Event.START: (Mode.RUNNING,),
    Event.STOP: (Mode.DISARMED, Mode.TRIPPED),
    Event.ESTOP: (Mode.TRIPPED,),
    Event.RESET: (Mode.DISARMED,),
    Event.HOLD_RECOVER: (Mode.RECOVER,),
    Event.RELEASE: (Mode.TRIPPED,),
}


class Loaded(NamedTuple):
    """An experiment's section, and whether the operator allows a rate that this host is not qualified for."""

    config: SupervisorConfig
    unqualified: bool


class Supervisor:
    """One verdict a sample, one permit a verdict."""

    def __init__(self, bus: Bus, qualification: Callable[[], Standing] = lambda: UNKNOWN) -> None:
        """Disarmed. `qualification` reads what is on record of this host."""
        self.bus, self.faults = bus, LiveFaults(bus)
        self._qualification, self.qualification = qualification, qualification()
        self.samples, self.descriptions = bus.subscribe("plant/sample"), bus.subscribe("plant/description")
        self.states = bus.subscribe("controller/state")
        self._inboxes = (self.samples, self.states, self.descriptions)
        self._lockstep_queue = LockstepQueue(bus, self.states)
        self.memory = SupervisorMemory()
        self.description: PlantDescription | None = None
        self.envelope: Envelope | None = None
        self.config = SupervisorConfig()
        self._loading = TwoPhaseLoad(bus, self.faults, busy=self._busy, check=self._check, take=self._take)
        self.unqualified = False  # the operator wants this run above the qualified rate
        self.asked: list[tuple[Event, Request]] = []
        self.sample: Received | None = None
        self.controller: Received | None = None
        self.permit: Permit | None = None
        self._drawn = draw_number()
        self._others = 0  # frames of another run at the last verdict

    def run(self, stopped: Callable[[], bool]) -> None:
        """Until nonzero_counts to stop: samples are judged where they arrive, their absence and requests here."""
        step_lock = StepLock(self.step)
        self.bus.step_on_arrival(step_lock)
        while not stopped():
            self.bus.wait(self._patience_s())
            if step_lock.run_between_steps(self.serve):
                self.bus.wake()

    def serve(self) -> None:
        """Answer what was asked; what acts waits for the next step."""
        for request in self.bus.requests():
            self._serve(request)

    def step(self) -> None:
        """Judge everything that has come, or that nothing has."""
        for message in self.descriptions.take():
            self._learn(message.body)
        for message in self.states.take():
            self.controller = message
            self.states.acceptance.other_run += not same_run(message.header, self.bus.run)
        messages, impaired_samples = self._lockstep_queue.due(self.samples.take()), self.samples.impaired_samples()
        for impaired in impaired_samples:
            self._judge_silence(impaired)
        for message in messages:
            self.sample = message
            self.samples.acceptance.other_run += not same_run(message.header, self.bus.run)
            self._judge(message, 0)
        for impaired in impaired_samples:
            self._tell(impaired)
        if not messages:
            self._judge_absence()

    def _patience_s(self) -> float:
        """How long until the absence of a sample is judged, if none comes."""
        if self.description is None or self.sample is None:
            return _IDLE_WAKE_S
        left_s = (self.sample.arrival_ns + self.description.permit_ttl_ns - time.monotonic_ns()) / NS_PER_S
        return min(left_s, _IDLE_WAKE_S) if left_s >= 0.0 else _IDLE_WAKE_S

    def _learn(self, description: PlantDescription) -> None:
        if description != self.description:
            self.description = description
            self._prepare()

    def _prepare(self) -> None:
        if self.description is not None:
            bias, duration = (0, 0) if self.envelope is None else (self.envelope.tare_ticks, self.envelope.duration_ticks)
            self.params = supervisor_params(self.config, self.description, bias, duration)

    def _judge_absence(self) -> None:
        """Wall time without a sample is a cause to trip; in lockstep, where the plant waits, only after it has given up."""
        if self.sample is None or self.description is None:
            return
        if self.memory.mode == DISARMED and not self.asked:  # a request must be answered now, not when the plant returns
            return
        stale_ns = time.monotonic_ns() - self.sample.arrival_ns
        if stale_ns > (_LOCKSTEP_SILENCE_NS if self._lockstep else self.description.permit_ttl_ns):
            self._judge(self.sample, stale_ns)

    def _judge_silence(self, impaired: ImpairedSample) -> None:
        """In lockstep simulated time without a sample is the same cause, where a fault takes or delays them."""
        if self.sample is not None and self.description is not None and impaired.silence_ns > self.description.permit_ttl_ns:
            self._judge(self.sample, impaired.silence_ns)

    def _tell(self, impaired: ImpairedSample) -> None:
        """Lockstep: the plant need not wait for the verdict on a sample that a fault took."""
        if not impaired.taken:
            self.bus.publish("supervisor/sample_dropped", SampleDropped(impaired.number), (impaired.number, impaired.time_ns))

    def _judge(self, message: Received, stale_ns: int) -> None:
        """Step once with the oldest request, publish the permit, answer the request."""
        if self.description is None:
            return
        self.faults.spend()
        event, request = self.asked.pop(0) if self.asked else (Event.NOTHING, None)
        ready = self.controller is not None and self.controller.body.ready == 1
        asked = SupervisorInput(
            int(event), self._drawn, self._prearm_problem(message) == "", ready, stale_ns, self._links(message)
        )
        before = self.memory
        self.memory, self.permit = supervisor_step(self.memory, self.params, message.body, asked)
        if self.memory.arming_id not in (0, before.arming_id):
            self._drawn = draw_number()
        self.bus.run = self.bus.run._replace(arming_id=self.memory.arming_id)
        echo = (message.body.number, message.body.time_ns)
        self.bus.publish("supervisor/permit", self.permit, echo)
        trips = self.memory.mode == TRIPPED and before.mode != TRIPPED
        if trips or (stale_ns == 0 and due(message.body.number, self.description.sample_period_ns)):
            self.bus.publish("supervisor/link_stats", link_stats(message.body.number, self._inboxes), echo)
        if request is not None:
            self._reply(event, request, message)
        if event == Event.RESET:
            self._reply_held(message)

    def _reply_held(self, message: Received) -> None:
        """A reset that is held is one: those that wait behind it get its answer and act at no later sample."""
        held = [request for event, request in self.asked if event == Event.RESET]
        self.asked = [(event, request) for event, request in self.asked if event != Event.RESET]
        for request in held:
            self._reply(Event.RESET, request, message)

    def _links(self, message: Received) -> LinkHealth:
        """What the inboxes have shown, by wall time or, in lockstep, by the sample's; frames of another run since then."""
        now_ns = message.body.time_ns if self._lockstep else time.monotonic_ns()
        observed = worst(*(inbox.protection.observe(now_ns) for inbox in self._inboxes))
        others = sum(inbox.acceptance.other_run for inbox in self._inboxes)
        before, self._others = self._others, others
        answered = NO_COMMAND if self.controller is None else self.controller.header.echo_number
        return LinkHealth(observed.faults, observed.epoch_conflicts, others - before, message.body.number - answered)

    @property
    def _lockstep(self) -> bool:
        return self.envelope is not None and self.envelope.clock == "lockstep"

    def _prearm_problem(self, message: Received) -> str:
        """Why the services do not agree, "" if they do."""
        controller = None if self.controller is None else self.controller.header
        declared = (
            self.envelope,
            self.config,
            self.description,
            self.bus.run,
            message.header,
            controller,
            self._beyond_qualified(),
        )
        return prearm_problem(Declared(*declared))

    def _beyond_qualified(self) -> str:
        """Why the loaded rate is above what this host is qualified for; "" where it is not, or time does not pass by the wall."""
        if self.description is None or self._lockstep or self.unqualified:
            return ""
        return beyond(self.qualification.qualified, self.description.sample_period_ns)

    def _reply(self, event: Event, request: Request, message: Received) -> None:
        mode = Mode(self.memory.mode)
        if mode in _EXPECTED[event]:
            return request.reply(self.status())
        return request.refuse(f"{event.name.lower().replace('_', ' ')} refused in mode {mode.name}: {self._why(message)}")

    def _why(self, message: Received) -> str:
        if self.memory.pressed:
            return "the emergency stop is pressed; when the reason is gone: `hydrohil reset` (it releases gate and supervisor)"
        if self.memory.mode == TRIPPED:
            return f"{self.trip_words()}; the cause must be gone, then `hydrohil reset`"
        return self._prearm_problem(message) or "see `hydrohil status`"

    def _warnings(self) -> list[str]:
        """What is borne, and should be known: the lease decides when it is not borne any more."""
        late = self.memory.observer.answers.in_a_row
        if late <= LATE_IN_A_ROW or self.description is None:
            return []
        return [f"{late} answers in a row were late or missing; the lease bears {self.params.limits.lease_samples}"]

    def trip_words(self) -> str:
        """Cause, number and limit of the latched trip."""
        memory = self.memory
        return trip_words(memory.cause, memory.measured, memory.limit, memory.trip_number)

    def _serve(self, request: Request) -> None:
        if request.verb in _EVENTS:
            return self._queue(request)
        if request.verb == "load":
            return self._loading.load(request)
        if request.verb == "commit":
            return self._loading.commit(request)
        if request.verb == "status":
            return request.reply(self.status())
        if request.verb in ("inject", "clear"):
            return self.faults.answer(request, self.samples.number)
        return request.refuse(f"the supervisor knows no request {request.verb!r}")

    def _queue(self, request: Request) -> None:
        """Events act at the next sample; an emergency stop does not wait for one."""
        if self.description is None or self.sample is None:
            return request.refuse("no sample has come from the plant yet: start it (`hydrohil plant`)")
        if request.verb != "estop" and len(self.asked) >= _MOST_ASKED:
            return request.refuse(f"{_MOST_ASKED} requests wait already, and one acts a sample: ask again")
        self.asked.append((_EVENTS[request.verb], request))
        if request.verb == "estop":
            self.asked.insert(0, self.asked.pop())
            self._judge(self.sample, 0 if self.sample is None else time.monotonic_ns() - self.sample.arrival_ns)
        return None

    def _busy(self) -> str:
        mode = Mode(self.memory.mode)
        return "" if mode == Mode.DISARMED else f"the mode is {mode.name}: stop or reset first"

    def _check(self, envelope: Envelope, arguments: dict[str, Any]) -> Checked[Loaded]:
        config = section(envelope, "supervisor", SupervisorConfig)
        self._look_up()
        loaded = Loaded(config, unqualified=arguments.get("unqualified") is True)
        return Checked(loaded, {"qualification": plain(self.qualification)})

    def _take(self, envelope: Envelope, loaded: Loaded) -> None:
        self.envelope, self.config, self.unqualified = envelope, loaded.config, loaded.unqualified
        self._lockstep_queue.begin(-envelope.tare_ticks if self._lockstep else None)
        self._prepare()

    def _look_up(self) -> None:
        """What is on record of this host may have changed; while something may move nobody waits for a file."""
        if self.memory.mode == DISARMED:
            self.qualification = self._qualification()

    def status(self) -> dict[str, Any]:
        """What an operator wants to know."""
        self._look_up()
        return {
            "pid": os.getpid(),
            "injected": self.faults.acting(),
            "ready": self.description is not None and self.sample is not None and self.controller is not None,
            "mode": Mode(self.memory.mode).name,
            "cause": TripCause(self.memory.cause).name,
            "words": self.trip_words() if self.memory.cause else "",
            "measured": self.memory.measured,
            "limit": self.memory.limit,
            "arming_id": self.memory.arming_id,
            "force_bias_n": self.memory.observer.bias.mean_n,
            "experiment": self.bus.run.experiment.hex(),
            "run": self.bus.run.run,
            "in_time": quality(self.memory.observer.answers.missed),
            "warnings": self._warnings(),
            "qualification": plain(self.qualification),
            "qualified": self.qualification.words,
            "link_stats": nonzero_counts(self._inboxes),
        }


def main(arguments: list[str] | None = None) -> int:
    """Run until a signal; returns the exit status."""
    line = parser("supervisor", __doc__)
    options = options_of(line, line.parse_args(arguments))

    def run(bus: Bus, stopped: Callable[[], bool]) -> None:
        Supervisor(bus, lambda: standing(fifo=is_fifo())).run(stopped)

    return serve("supervisor", options, run)
