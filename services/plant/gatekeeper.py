"""Permits and commands from the bus, through the gate, to the device; every change of mind is published."""

from collections.abc import Callable, Iterator

from hydrohil.services.plant.cause_values import cause_values
from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.counters import Counters
from hydrohil.services.plant.device import Device, Timeline
from hydrohil.services.plant.gate import GateInput, GateMemory, gate_step
from hydrohil.services.plant.ledger import Ledger
from hydrohil.services.plant.mailbox import Mailbox
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.converters import N_PER_FORCE_COUNT
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, GateCause, GateEvent
from hydrohil.shared.transport.bus import Bus, same_run
from hydrohil.shared.transport.impairment_queue import FOREVER_NS
from hydrohil.shared.transport.inbox import Inbox
from hydrohil.shared.transport.link_stats import link_stats
from hydrohil.shared.transport.protection import worst
from hydrohil.shared.units import SUBSTEP_NS


class Gatekeeper:
    """The only one who writes to the device."""

    def __init__(self, bus: Bus, device: Device, timeline: Timeline, limits: GateLimits, counters: Counters) -> None:
        """Shut: nothing moves before a permit and a command allow it."""
        self.limits = limits
        self.ledger = Ledger()
        self.mailbox = Mailbox(self.ledger)
        self.commands: Inbox = bus.subscribe("controller/command")
        self.permits: Inbox = bus.subscribe("supervisor/permit")
        self._passed = (bus.subscribe("controller/sample_dropped"), bus.subscribe("supervisor/sample_dropped"))
        self._dropped_samples: dict[str, int] = {}
        self.gate = GateMemory()
        self.estop = False
        self.force_counts = 0
        self.late_substeps = self.command_age_ns = 0
        self.last_cut = int(GateCause.NONE)  # of this trial
        self.last_cut_ns = self.last_cut_clock_ns = 0  # and when that was, on the plant's grid and by its clock
        self._bus, self._device, self._timeline, self._counters = bus, device, timeline, counters
        self._revoked: set[int] = set()  # all of them: the gate's own memory holds the last 16

    def begin_trial(self) -> None:
        """Gate history starts anew, with zero current; what was revoked, or is bound, stays revoked."""
        self._revoke(self.gate.arming_id)
        self.gate = GateMemory(revoked=self.gate.revoked)
        self._device.write(self.gate.codes)
        self.late_substeps = 0
        self.last_cut, self.last_cut_ns, self.last_cut_clock_ns = int(GateCause.NONE), 0, 0

    def receive_permits(self, simulated_ns: int = FOREVER_NS) -> None:
        """Hold the newest permit."""
        for message in self.permits.take(simulated_ns):
            if not self.mailbox.take_permit(message, self._bus.run):
                self.permits.acceptance.other_run += 1

    def receive_lockstep(self, simulated_ns: int, latch_ns: int, late: Callable[[Received, int], None]) -> None:
        """Lockstep: hold the newest command; its age is simulated time. `late` gets the sub-step of one that a fault delayed."""
        self._receive_dropped()  # first: a permit on a sample's absence is sent before the word that the sample was passed
        self.receive_permits(simulated_ns)
        for message in self._receive_commands(simulated_ns):
            delay_ns = self.commands.delay_ns(message)
            self.command_age_ns = max(latch_ns, delay_ns)
            if delay_ns > latch_ns:
                late(message, (message.header.echo_time_ns + delay_ns) // SUBSTEP_NS)

    def _receive_dropped(self) -> None:
        for message in (message for inbox in self._passed for message in inbox.take()):
            if same_run(message.header, self._bus.run):
                self._dropped_samples[message.header.sender] = message.body.number

    def dealt_with(self) -> tuple[tuple[str, int], tuple[str, int]]:
        """Lockstep: the newest sample that nobody waits for: its answer has come, or a fault has it, or took the sample."""
        passed = self._dropped_samples
        return (
            ("controller", max(self.mailbox.answered, self.commands.arrived(), passed.get("controller", NO_COMMAND))),
            ("supervisor", max(self.mailbox.judged, self.permits.arrived(), passed.get("supervisor", NO_COMMAND))),
        )

    def receive(self, now_ns: int, *, at_latch: bool, late: Callable[[Received], None]) -> None:
        """Real clock: hold the newest command; `late` is called for one that answers an older sample."""
        self.receive_permits()
        for message in self._receive_commands():
            self.command_age_ns = self.mailbox.observe_command(now_ns).age_ns - (now_ns - message.arrival_ns)
            if not at_latch or message.header.echo_number < self._timeline.number:
                late(message)
            elif self._timeline.tick != NO_TRIAL:
                self._counters.command_age_ns.append(self.command_age_ns)

    def _receive_commands(self, simulated_ns: int = FOREVER_NS) -> Iterator[Received]:
        """Commands of this run, each held when it is given; those of another are counted."""
        for message in self.commands.take(simulated_ns):
            if self.mailbox.take_command(message, self._bus.run):
                yield message
            else:
                self.commands.acceptance.other_run += 1

    def judge(self, now_ns: int, *, at_latch: bool, overrun: bool = False) -> None:
        """Let the gate decide on what is held, and write what it gives."""
        link = worst(self.commands.protection.look(now_ns), self.permits.protection.look(now_ns))
        seen = GateInput(
            self.mailbox.observe_permit(now_ns),
            self.mailbox.observe_command(now_ns),
            self.force_counts,
            self.force_counts * N_PER_FORCE_COUNT,
            self._timeline.tick,
            self.estop,
            overrun,
            link.faults,
            link.epoch_conflicts,
        )
        if seen.permit.arming_id in self._revoked:
            self._revoke(seen.permit.arming_id)
        before, self.gate = self.gate, gate_step(self.gate, self.limits, seen, at_latch)
        self._revoked.update(self.gate.revoked)
        self._device.write(self.gate.codes)
        if before.arming_id != 0 and self.gate.arming_id == 0:
            self.last_cut, self.last_cut_clock_ns = self.gate.cause, now_ns
            self.last_cut_ns = self._timeline.substep * SUBSTEP_NS
            self.publish_link_stats()
        if (before.state, before.cause) != (self.gate.state, self.gate.cause):
            self._tell(before, seen)

    @property
    def revoked(self) -> frozenset[int]:
        """Every arming id that a cut has revoked."""
        return frozenset(self._revoked) - {0}

    def _revoke(self, arming_id: int) -> None:
        """Let the gate know a number that must never open it; it may have forgotten."""
        if arming_id != 0 and arming_id not in self.gate.revoked:
            self.gate = self.gate._replace(revoked=(arming_id, *self.gate.revoked[:-1]))

    def publish_link_stats(self) -> None:
        """Publish what was made of the frames that came."""
        number = self._timeline.number
        told = link_stats(number, (self.commands, self.permits))
        self._bus.publish("plant/link_stats", told, (number, self._timeline.substep * SUBSTEP_NS))

    def _tell(self, before: GateMemory, seen: GateInput) -> None:
        number, tick = self._timeline.number, self._timeline.tick
        measured, limit = cause_values(self.gate.cause, before, seen, self.limits)
        event = GateEvent(
            number, tick, self.gate.state, self.gate.cause, seen.permit.age_ns, seen.command.age_ns, measured, limit
        )
        self._bus.publish("plant/gate", event, (number, self._timeline.substep * SUBSTEP_NS))
