"""The supervisor's process: judges every sample, and its absence; its permits allow motion."""

import time
from collections.abc import Callable

from hydrohil.services.supervisor.cell_view import CellView
from hydrohil.services.supervisor.lockstep_queue import LockstepQueue
from hydrohil.services.supervisor.modes import DISARMED, TRIPPED
from hydrohil.services.supervisor.requests import SupervisorRequests
from hydrohil.services.supervisor.state import SupervisorInput, SupervisorMemory
from hydrohil.services.supervisor.step import supervisor_step
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.envelope import Envelope
from hydrohil.shared.contract.messages import Permit, SampleDropped
from hydrohil.shared.host.process import draw_number, options_of, parser, serve
from hydrohil.shared.host.qualified import UNKNOWN, Standing, standing
from hydrohil.shared.host.realtime import is_fifo
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.impairment_queue import ImpairedSample
from hydrohil.shared.transport.link_stats import due, link_stats
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.step_lock import StepLock
from hydrohil.shared.units import NS_PER_S

_IDLE_WAKE_S = 0.1
_LOCKSTEP_SILENCE_NS = 6 * NS_PER_S  # the plant gives up on a peer after 5 s


class Supervisor:
    """One verdict a sample, one permit a verdict."""

    def __init__(self, bus: Bus, qualification: Callable[[], Standing] = lambda: UNKNOWN) -> None:
        """Disarmed. `qualification` reads what is on record of this host."""
        self.bus, self.faults = bus, LiveFaults(bus)
        self.cell = CellView(bus, qualification)
        self.requests = SupervisorRequests(
            bus,
            self.cell,
            self.faults,
            memory=lambda: self.memory,
            judge_now=self._judge_now,
            loaded=self._begin,
        )
        self.memory = SupervisorMemory()
        self.permit: Permit | None = None
        self._lockstep_queue = LockstepQueue(bus, self.cell.states)
        self._next_arming_id = draw_number()

    def run(self, stopped: Callable[[], bool]) -> None:
        """Until `stopped()`: samples are judged where they arrive, their absence and requests here."""
        step_lock = StepLock(self.step)
        self.bus.step_on_arrival(step_lock)
        while not stopped():
            self.bus.wait(self._patience_s())
            if step_lock.run_between_steps(self.serve):
                self.bus.wake()

    def serve(self) -> None:
        """Answer the requests that have come; an event waits for the next step."""
        for request in self.bus.requests():
            self.requests.answer(request)

    def step(self) -> None:
        """Judge every sample that has come, or that none has."""
        cell = self.cell
        cell.receive()
        messages, impaired_samples = self._lockstep_queue.due(cell.samples.take()), cell.samples.impaired_samples()
        for impaired in impaired_samples:
            self._judge_silence(impaired)
        for message in messages:
            cell.sampled(message)
            self._judge(message, 0)
        for impaired in impaired_samples:
            self._publish_dropped(impaired)
        if not messages:
            self._judge_absence()

    def _begin(self, envelope: Envelope) -> None:
        """Another experiment is loaded: samples that waited are forgotten."""
        self._lockstep_queue.begin(-envelope.tare_ticks if self.cell.lockstep else None)

    def _patience_s(self) -> float:
        """How long until the absence of a sample is judged, if none comes."""
        sample, description = self.cell.sample, self.cell.description
        if description is None or sample is None:
            return _IDLE_WAKE_S
        left_s = (sample.arrival_ns + description.permit_ttl_ns - time.monotonic_ns()) / NS_PER_S
        return min(left_s, _IDLE_WAKE_S) if left_s >= 0.0 else _IDLE_WAKE_S

    def _judge_absence(self) -> None:
        """Wall time without a sample is a cause to trip; in lockstep, where the plant waits, only after it has given up."""
        sample, description = self.cell.sample, self.cell.description
        if sample is None or description is None:
            return
        if self.memory.mode == DISARMED and not self.requests.events:  # an event is answered now, not when the plant returns
            return
        stale_ns = time.monotonic_ns() - sample.arrival_ns
        if stale_ns > (_LOCKSTEP_SILENCE_NS if self.cell.lockstep else description.permit_ttl_ns):
            self._judge(sample, stale_ns)

    def _judge_silence(self, impaired: ImpairedSample) -> None:
        """In lockstep simulated time without a sample is the same cause, where a fault takes or delays them."""
        sample, description = self.cell.sample, self.cell.description
        if sample is not None and description is not None and impaired.silence_ns > description.permit_ttl_ns:
            self._judge(sample, impaired.silence_ns)

    def _judge_now(self) -> None:
        """Judge the newest sample once more, by its age: an emergency stop does not wait for the next."""
        if self.cell.sample is not None:
            self._judge(self.cell.sample, time.monotonic_ns() - self.cell.sample.arrival_ns)

    def _publish_dropped(self, impaired: ImpairedSample) -> None:
        """Lockstep: the plant need not wait for the verdict on a sample that a fault took."""
        if not impaired.taken:
            self.bus.publish("supervisor/sample_dropped", SampleDropped(impaired.number), (impaired.number, impaired.time_ns))

    def _judge(self, message: Received, stale_ns: int) -> None:
        """Step once with the oldest event, publish the permit, answer the event's request."""
        cell = self.cell
        if cell.description is None:
            return
        self.faults.spend()
        event, request = self.requests.events.next()
        inputs = SupervisorInput(
            event=int(event),
            new_arming_id=self._next_arming_id,
            agreed=cell.prearm_problem(message) == "",
            controller_ready=cell.controller is not None and cell.controller.body.ready == 1,
            stale_ns=stale_ns,
            links=cell.link_health(message, message.body.time_ns if cell.lockstep else time.monotonic_ns()),
        )
        before = self.memory
        self.memory, self.permit = supervisor_step(before, cell.params, message.body, inputs)
        if self.memory.arming_id not in (0, before.arming_id):
            self._next_arming_id = draw_number()
        self.bus.run = self.bus.run._replace(arming_id=self.memory.arming_id)
        echo = (message.body.number, message.body.time_ns)
        self.bus.publish("supervisor/permit", self.permit, echo)
        trips = self.memory.mode == TRIPPED and before.mode != TRIPPED
        if trips or (stale_ns == 0 and due(message.body.number, cell.description.sample_period_ns)):
            self.bus.publish("supervisor/link_stats", link_stats(message.body.number, cell.inboxes), echo)
        self.requests.answer_event(event, request, message)


def main(arguments: list[str] | None = None) -> int:
    """Run until a signal; returns the exit status."""
    line = parser("supervisor", __doc__)
    options = options_of(line, line.parse_args(arguments))

    def run(bus: Bus, stopped: Callable[[], bool]) -> None:
        Supervisor(bus, lambda: standing(fifo=is_fifo())).run(stopped)

    return serve("supervisor", options, run)
