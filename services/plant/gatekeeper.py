"""Permits and commands from the bus, through the gate, to the device; every change of the gate is published."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from hydrohil.services.plant.cause_values import cause_values
from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.counters import Counters
from hydrohil.services.plant.device import Device, Timeline
from hydrohil.services.plant.gate import GateInput, GateMemory, gate_step
from hydrohil.services.plant.ledger import Ledger
from hydrohil.services.plant.mailbox import Mailbox
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, GateCause, GateEvent, Mode
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.transport.bus import Bus, same_run
from hydrohil.shared.transport.impairment_queue import FOREVER_NS
from hydrohil.shared.transport.inbox import Inbox
from hydrohil.shared.transport.link_stats import link_stats, nonzero_counts
from hydrohil.shared.transport.protection import worst
from hydrohil.shared.units import SUBSTEP_NS


class LastCut(NamedTuple):
    """The last cut of this trial."""

    cause: int = int(GateCause.NONE)
    grid_ns: int = 0  # on the plant's grid
    clock_ns: int = 0  # by the clock that judges ages


class Gatekeeper:
    """The owner of the gate's state: no other class writes to the device or changes a decision of the gate."""

    def __init__(self, bus: Bus, device: Device, timeline: Timeline, limits: GateLimits, counters: Counters) -> None:
        """The gate is shut: nothing moves before a permit and a command allow it."""
        self.commands: Inbox = bus.subscribe("controller/command")
        self.permits: Inbox = bus.subscribe("supervisor/permit")
        self._dropped = (bus.subscribe("controller/sample_dropped"), bus.subscribe("supervisor/sample_dropped"))
        self._dropped_samples: dict[str, int] = {}
        self._bus, self._device, self._timeline, self._counters = bus, device, timeline, counters
        self._ledger = Ledger()
        self._mailbox = Mailbox(self._ledger)
        self._limits = limits
        self._gate = GateMemory()
        self._estop = False
        self._force_counts = 0
        self._late_substeps = self._command_age_ns = 0
        self._last_cut = LastCut()
        self._revoked: set[int] = set()  # every one; the gate's own memory holds the last 16

    @property
    def gate(self) -> GateMemory:
        """What the gate has decided; `codes` stands at the D/A."""
        return self._gate

    @property
    def limits(self) -> GateLimits:
        """What the gate judges against, with the lease that is in force."""
        return self._limits

    @property
    def late_substeps(self) -> int:
        """Sub-steps by which the command that acts missed its latch; 0 if it was in time."""
        return self._late_substeps

    @property
    def command_age_ns(self) -> int:
        """Time from a sample to the newest command that answers one, in ns."""
        return self._command_age_ns

    @property
    def arming_id(self) -> int:
        """Arming id of the permit held, 0 without one."""
        return self._mailbox.arming_id

    @property
    def revoked(self) -> frozenset[int]:
        """Every arming id that a cut has revoked."""
        return frozenset(self._revoked) - {0}

    @property
    def stop_pressed(self) -> bool:
        """Whether an emergency stop has not been released yet."""
        return self._estop

    @property
    def connected(self) -> bool:
        """Whether a permit and a command have been accepted since the start."""
        return self.permits.acceptance.accepted > 0 and self.commands.acceptance.accepted > 0

    def armed(self, now_ns: int) -> bool:
        """Whether the gate is bound, or a permit within its lease has an arming id; a supervisor that died arms nothing."""
        if self._gate.arming_id != 0:
            return True
        permit = self._mailbox.observe_permit(now_ns)
        return permit.arming_id != 0 and 0 <= permit.age_ns <= self._limits.permit_ttl_ns

    def announced_sample(self) -> int | None:
        """First sample of the trial that the permit held allows to run; None without such a permit."""
        permit = self._mailbox.permit
        if permit is None or permit.body.mode != Mode.RUNNING:
            return None
        return int(permit.body.first_sample)

    def command_answers(self, number: int) -> bool:
        """Whether the command held answers this sample or a later one."""
        return self._mailbox.answered >= number

    def permit_answers(self, number: int) -> bool:
        """Whether the permit held answers this sample or a later one."""
        return self._mailbox.judged >= number

    def awaited(self, number: int) -> list[str]:
        """Lockstep: services whose answer to sample `number` has not come, unless a fault holds it or took the sample."""
        dropped = self._dropped_samples
        newest = {
            "controller": max(self._mailbox.answered, self.commands.arrived(), dropped.get("controller", NO_COMMAND)),
            "supervisor": max(self._mailbox.judged, self.permits.arrived(), dropped.get("supervisor", NO_COMMAND)),
        }
        return [name for name, answered in newest.items() if answered < number]

    def begin_trial(self) -> None:
        """Forget the gate's history and write zero current; an arming that was revoked, or is bound, stays revoked."""
        self._revoke(self._gate.arming_id)
        self._gate = GateMemory(revoked=self._gate.revoked)
        self._device.write(self._gate.codes)
        self._late_substeps = 0
        self._last_cut = LastCut()

    def set_lease(self, lease_ns: int) -> None:
        """Permits and commands are fresh for this long from now on; the device's watchdog waits as long."""
        self._limits = self._limits._replace(permit_ttl_ns=lease_ns, command_ttl_ns=lease_ns)
        self._device.watchdog(lease_ns // SUBSTEP_NS)

    def issue_sample(self, number: int, time_ns: int, now_ns: int, force_counts: int) -> None:
        """Remember a sample that is about to be published: answers are dated by it, and its force is judged."""
        self._force_counts = force_counts
        self._ledger.issue(number, time_ns, now_ns)

    def receive_permits(self, simulated_ns: int = FOREVER_NS) -> None:
        """Hold the newest permit."""
        for message in self.permits.take(simulated_ns):
            if not self._mailbox.take_permit(message, self._bus.run):
                self.permits.acceptance.other_run += 1

    def receive_lockstep(self, simulated_ns: int, latch_ns: int, late: Callable[[Received, int], None]) -> None:
        """Lockstep: hold the newest command; its age is simulated time. `late` gets the sub-step of one that a fault delayed."""
        self._receive_dropped()  # before the permits: that on a missing sample is sent before this report, so it is here too
        self.receive_permits(simulated_ns)
        for message in self._receive_commands(simulated_ns):
            delay_ns = self.commands.delay_ns(message)
            self._command_age_ns = max(latch_ns, delay_ns)
            if delay_ns > latch_ns:
                late(message, (message.header.echo_time_ns + delay_ns) // SUBSTEP_NS)

    def _receive_dropped(self) -> None:
        for message in (message for inbox in self._dropped for message in inbox.take()):
            if same_run(message.header, self._bus.run):
                self._dropped_samples[message.header.sender] = message.body.number

    def receive(self, now_ns: int, *, at_latch: bool, late: Callable[[Received], None]) -> None:
        """Real clock: hold the newest command; `late` is called for one that answers an older sample."""
        self.receive_permits()
        for message in self._receive_commands():
            self._command_age_ns = self._mailbox.observe_command(now_ns).age_ns - (now_ns - message.arrival_ns)
            if not at_latch or message.header.echo_number < self._timeline.number:
                late(message)
            elif self._timeline.tick != NO_TRIAL:
                self._counters.command_age_ns.append(self._command_age_ns)

    def _receive_commands(self, simulated_ns: int = FOREVER_NS) -> Iterator[Received]:
        """Commands of this run, each held when it is given; those of another are counted."""
        for message in self.commands.take(simulated_ns):
            if self._mailbox.take_command(message, self._bus.run):
                yield message
            else:
                self.commands.acceptance.other_run += 1

    def stop(self, now_ns: int) -> None:
        """Emergency stop: the gate cuts now, and stays shut until the stop is released."""
        self._estop = True
        self.judge(now_ns, at_latch=False)

    def release_stop(self, now_ns: int) -> None:
        """The emergency stop ends; this alone opens nothing."""
        self._estop = False
        self.judge(now_ns, at_latch=False)

    def judge_late(self, now_ns: int, late_substeps: int) -> None:
        """Judge a command that has missed its latch by `late_substeps`."""
        self._late_substeps = late_substeps
        self.judge(now_ns, at_latch=False)

    def judge(self, now_ns: int, *, at_latch: bool, overrun: bool = False) -> None:
        """Let the gate decide on what is held, and write what it gives."""
        if at_latch:
            self._late_substeps = 0
        link = worst(self.commands.protection.observe(now_ns), self.permits.protection.observe(now_ns))
        observed = GateInput(
            permit=self._mailbox.observe_permit(now_ns),
            command=self._mailbox.observe_command(now_ns),
            force_counts=self._force_counts,
            force_n=self._force_counts * UNIMATE.force.scale,
            tick=self._timeline.tick,
            estop=self._estop,
            overrun=overrun,
            link_faults=link.faults,
            epoch_conflicts=link.epoch_conflicts,
        )
        if observed.permit.arming_id in self._revoked:
            self._revoke(observed.permit.arming_id)
        before, self._gate = self._gate, gate_step(self._gate, self._limits, observed, at_latch)
        self._revoked.update(self._gate.revoked)
        self._device.write(self._gate.codes)
        if before.arming_id != 0 and self._gate.arming_id == 0:
            self._last_cut = LastCut(self._gate.cause, self._timeline.substep * SUBSTEP_NS, now_ns)
            self.publish_link_stats()
        if (before.state, before.cause) != (self._gate.state, self._gate.cause):
            self._publish_change(before, observed)

    def _revoke(self, arming_id: int) -> None:
        """Give the gate an arming id that must never open it; its own memory may have lost it."""
        if arming_id != 0 and arming_id not in self._gate.revoked:
            self._gate = self._gate._replace(revoked=(arming_id, *self._gate.revoked[:-1]))

    def publish_link_stats(self) -> None:
        """Publish how many frames were accepted and discarded, by cause."""
        number = self._timeline.number
        counts = link_stats(number, (self.commands, self.permits))
        self._bus.publish("plant/link_stats", counts, (number, self._timeline.substep * SUBSTEP_NS))

    def _publish_change(self, before: GateMemory, observed: GateInput) -> None:
        number, gate = self._timeline.number, self._gate
        measured, limit = cause_values(gate.cause, before, observed, self._limits)
        event = GateEvent(
            number=number,
            tick=self._timeline.tick,
            state=gate.state,
            cause=gate.cause,
            permit_age_ns=observed.permit.age_ns,
            command_age_ns=observed.command.age_ns,
            measured=measured,
            limit=limit,
        )
        self._bus.publish("plant/gate", event, (number, self._timeline.substep * SUBSTEP_NS))

    def status(self) -> dict[str, Any]:
        """The gate's part of the plant's status."""
        return {
            "gate": self._gate.state,
            "gate_cause": GateCause(self._gate.cause).name,
            "last_cut": GateCause(self._last_cut.cause).name,
            "last_cut_ns": self._last_cut.grid_ns,
            "last_cut_clock_ns": self._last_cut.clock_ns,
            "revoked_arming_ids": len(self.revoked),
            "estop": self._estop,
            "link_stats": nonzero_counts((self.commands, self.permits)),
        }
