"""The plant's process: samples on a grid, drains the bus at the latch, lets the gate decide, writes to the device."""

import gc
import os
import time
from collections.abc import Callable
from typing import Any

from services.plant.about import about
from services.plant.config import GateLimits, PlantConfig
from services.plant.counters import Counters
from services.plant.device import Device, Timeline
from services.plant.gate import OPEN, GateInput, GateMemory, gate_step
from services.plant.ledger import Ledger
from services.plant.mailbox import Mailbox
from services.plant.trial import Schedule
from shared.bus import Bus, Inbox, Request, Run
from shared.clock import SLACK_NS, Grid
from shared.codec import Received
from shared.converters import N_PER_FORCE_COUNT, ZERO_CODE
from shared.envelope import Envelope, section, unseal
from shared.messages import NO_TRIAL, GateCause, GateEvent, Mode, Sample
from shared.units import NS_PER_S, SUBSTEP_NS

LOCKSTEP_TIMEOUT_S = 5.0
MEASURED_S = 2.0  # of wake-ups before a lease is chosen
MIN_LEASE_NS, MAX_LEASE_NS = 20_000_000, 200_000_000
LEASE_PER_LATENESS = 3
ABOUT_EVERY = 100  # samples: for those who join late
UNCHOSEN = 0


class PeerSilentError(Exception):
    """A peer did not answer in lockstep."""


class Plant:
    """Samples, latches and requests, in that order, for ever."""

    def __init__(
        self, bus: Bus, device: Device, timeline: Timeline, limits: GateLimits, stopped: Callable[[], bool], *, fixed_lease: bool
    ) -> None:
        """Take the places on the bus; nothing moves before a permit and a command allow it."""
        self.bus, self.device, self.timeline, self.limits = bus, device, timeline, limits
        self.grid, self.ledger, self.counters = Grid(), Ledger(), Counters()
        self.mailbox = Mailbox(self.ledger)
        self.commands: Inbox = bus.subscribe("controller/command")
        self.permits: Inbox = bus.subscribe("supervisor/permit")
        self.schedule = Schedule(PlantConfig())
        self.pending: tuple[Envelope, PlantConfig] | None = None
        self.gate = GateMemory()
        self.stopped = stopped
        self.estop = False
        self.due = 0  # sub-step of the next sample
        self.late_substeps = self.command_age_ns = 0
        self.reading_force = 0
        self.lease_chosen = fixed_lease
        self._started_ns = time.monotonic_ns()
        self._worst_ns = 0
        self._trial_zero_ns = 0

    def run(self) -> None:
        """Until told to stop; leaves the valves at zero."""
        try:
            while not self.stopped():
                self.sample()
                self.latch()
                self.serve()
        finally:
            self.device.write((ZERO_CODE, ZERO_CODE, ZERO_CODE))

    # -- the sample ------------------------------------------------------------------------------------------------

    def sample(self) -> None:
        """Wait for the grid, read the converters, publish."""
        self._wait(self.due)
        self._receive(at_latch=False)
        self._advance_to(self.due)
        number = self.timeline.number
        self.timeline.tick = tick = self.schedule.tick(number)
        if tick == self.schedule.first_tick and tick != NO_TRIAL:
            self._begin_trial()
        reading = self.device.read()
        self.reading_force = reading.force_counts
        time_ns = self.due * SUBSTEP_NS
        self.ledger.issue(number, time_ns, self._now_ns())
        self.bus.run = self.bus.run._replace(arming=self.mailbox.arming)
        gate = self.gate
        self.bus.publish(
            "plant/sample",
            Sample(
                number,
                time_ns,
                tick,
                time_ns - self._trial_zero_ns if tick != NO_TRIAL else 0,
                reading.encoder_counts,
                reading.force_counts,
                gate.codes,
                gate.state,
                gate.cause,
                gate.open_samples,
                gate.recover_signs,
                gate.command_number,
                self.late_substeps,
                self.command_age_ns,
            ),
            (number, time_ns),
        )
        self.counters.samples += 1
        truth = self.device.truth()
        if truth is not None:
            self.bus.publish("plant/truth", truth, (number, time_ns))
        if number % ABOUT_EVERY == 0:
            self._tell_about()

    def _begin_trial(self) -> None:
        self.device.begin()
        self.gate = GateMemory(burned=self.gate.burned)
        self.counters.reset()
        self.late_substeps = 0
        self._trial_zero_ns = self.due * SUBSTEP_NS + self.schedule.bias_ns

    # -- the latch -------------------------------------------------------------------------------------------------

    def latch(self) -> None:
        """Let the newest valid permit and command decide, and write what the gate gives."""
        due = self.due + self.schedule.latch
        if self._lockstep():
            self._await_answers()
        else:
            self._wait(due)
        number = self.timeline.number
        self._receive(at_latch=True)
        self._advance_to(due)
        self.late_substeps = 0
        self.counters.unanswered += self.mailbox.answered < number
        self.counters.late_permits += self.mailbox.judged < number
        self._judge(at_latch=True)
        self._follow_permit()
        self.due += self.schedule.interval(self.timeline.tick)
        self.timeline.number = number + 1

    def _await_answers(self) -> None:
        """Until command and permit answer this sample; PeerSilentError names who does not."""
        deadline = time.monotonic() + LOCKSTEP_TIMEOUT_S
        while not self.stopped():
            self._take_messages()
            missing = [
                name
                for name, answered in (("controller", self.mailbox.answered), ("supervisor", self.mailbox.judged))
                if answered < self.timeline.number
            ]
            if not missing:
                return
            if time.monotonic() > deadline:
                raise PeerSilentError(f"the {' and the '.join(missing)} did not answer sample {self.timeline.number} within 5 s")
            self.serve()
            if self.estop:
                return
            self.bus.wait(0.05)

    def _take_messages(self) -> None:
        for message in self.permits.take():
            self.mailbox.take_permit(message, self.bus.run)
        for message in self.commands.take():
            if self.mailbox.take_command(message, self.bus.run):
                self.command_age_ns = self.schedule.latch * SUBSTEP_NS

    def _receive(self, *, at_latch: bool) -> None:
        """Drain the bus; a command that answers an older sample takes effect at the sub-step at which it arrived."""
        if self._lockstep():
            return
        for message in self.permits.take():
            self.mailbox.take_permit(message, self.bus.run)
        for message in self.commands.take():
            if not self.mailbox.take_command(message, self.bus.run):
                continue
            now_ns = self._now_ns()
            self.command_age_ns = self.mailbox.command_seen(now_ns).age_ns - (now_ns - message.arrival_ns)
            late = message.header.echo_number < self.timeline.number or not at_latch
            if late:
                self._apply_late(message)
            elif self.timeline.tick != NO_TRIAL:
                self.counters.command_age_ns.append(self.command_age_ns)

    def _apply_late(self, message: Received) -> None:
        arrived = min(max(self.grid.substep_at(message.arrival_ns), self.timeline.substep), self.due + self.schedule.latch)
        self._advance_to(arrived)
        self.late_substeps = max(1, arrived - (message.header.echo_time_ns // SUBSTEP_NS + self.schedule.latch))
        self.counters.late_commands += 1
        self._judge(at_latch=False)

    # -- the gate --------------------------------------------------------------------------------------------------

    def _judge(self, *, at_latch: bool, overslept: bool = False) -> None:
        now_ns = self._now_ns()
        force_n = self.reading_force * N_PER_FORCE_COUNT
        seen = GateInput(
            self.mailbox.permit_seen(now_ns),
            self.mailbox.command_seen(now_ns),
            self.reading_force,
            force_n,
            self.timeline.tick,
            self.estop,
            overslept,
        )
        before, self.gate = self.gate, gate_step(self.gate, self.limits, seen, at_latch)
        self.device.write(self.gate.codes)
        if (before.state, before.cause) != (self.gate.state, self.gate.cause):
            measured, limit = _numbers(self.gate.cause, seen, self.limits)
            event = GateEvent(self.timeline.number, self.timeline.tick, self.gate.state, self.gate.cause, measured, limit)
            self.bus.publish("plant/gate", event, (self.timeline.number, self.timeline.substep * SUBSTEP_NS))

    def _follow_permit(self) -> None:
        """A permit announces the trial's first sample; without a running permit there is no trial."""
        permit = self.mailbox.permit
        if permit is None or permit.body.mode != Mode.RUNNING:
            self.schedule.forget()
        elif permit.body.first_sample > self.timeline.number and self.schedule.envelope is not None:
            self.schedule.announce(permit.body.first_sample)

    # -- time ------------------------------------------------------------------------------------------------------

    def _lockstep(self) -> bool:
        return self.schedule.lockstep and self.timeline.tick != NO_TRIAL

    def _now_ns(self) -> int:
        """The clock by which ages are judged: the wall's, or simulated time in lockstep."""
        return self.timeline.substep * SUBSTEP_NS if self._lockstep() else time.monotonic_ns()

    def _advance_to(self, substep: int) -> None:
        self.timeline.substep = max(self.timeline.substep, substep)

    def _wait(self, substep: int) -> None:
        """Until a sub-step is due. A plant that overslept its lease cuts before it integrates or writes anything."""
        if self._lockstep():
            self.grid.restart_at(substep)
            return
        late_ns = self.grid.wait(substep)
        self.counters.lateness_ns.append(late_ns)
        self.counters.shifts += late_ns > SLACK_NS
        self._choose_lease(late_ns)
        if self.lease_chosen and late_ns > self.limits.permit_ttl_ns:
            self._judge(at_latch=False, overslept=True)

    def _choose_lease(self, late_ns: int) -> None:
        """After two seconds of wake-ups: 20 ms, or three times the worst lateness, at most 200 ms."""
        if self.lease_chosen:
            return
        elapsed_ns = time.monotonic_ns() - self._started_ns
        self._worst_ns = max(self._worst_ns, late_ns)
        if elapsed_ns < MEASURED_S * NS_PER_S:
            return
        lease_ns = min(max(MIN_LEASE_NS, LEASE_PER_LATENESS * self._worst_ns), MAX_LEASE_NS)
        self.limits = self.limits._replace(permit_ttl_ns=lease_ns, command_ttl_ns=lease_ns)
        self.device.watchdog(lease_ns // SUBSTEP_NS)
        self.lease_chosen = True
        self._tell_about()

    # -- requests --------------------------------------------------------------------------------------------------

    def serve(self) -> None:
        """Answer what was asked since the last sample."""
        for request in self.bus.requests():
            handler = getattr(self, f"_on_{request.verb}", None)
            if handler is None:
                request.refuse(f"the plant knows no request {request.verb!r}")
            else:
                handler(request)

    def _tell_about(self) -> None:
        limits = self.limits if self.lease_chosen else self.limits._replace(permit_ttl_ns=UNCHOSEN, command_ttl_ns=UNCHOSEN)
        self.bus.publish("plant/about", about(self.schedule.config, limits))

    def _on_load(self, request: Request) -> None:
        if self.gate.state == OPEN or self.mailbox.arming:
            return request.refuse("a trial is armed or running: stop it first (`hydrohil stop`)")
        try:
            envelope = unseal(str(request.arguments.get("envelope")))
            config = section(envelope, "plant", PlantConfig)
            Schedule(config, envelope)
            about(config, self.limits)
        except ValueError as error:
            return request.refuse(str(error))
        self.pending = (envelope, config)
        return request.reply({"digest": envelope.digest.hex()})

    def _on_commit(self, request: Request) -> None:
        if self.pending is None or self.pending[0].digest.hex() != request.arguments.get("digest"):
            return request.refuse("nothing with this hash was loaded: load it first")
        envelope, config = self.pending
        self.schedule = Schedule(config, envelope)
        self.device.load(config, envelope.seed, self.schedule.first_tick, self.schedule.ticks)
        self.bus.run = Run(envelope.run, envelope.digest, 0)
        gc.collect()
        self.grid.restart_at(self.due)
        self._tell_about()
        return request.reply({"digest": envelope.digest.hex()})

    def _on_estop(self, request: Request) -> None:
        self.estop = True
        self._judge(at_latch=False)
        request.reply({"dac_counts": list(self.gate.codes)})

    def _on_reset(self, request: Request) -> None:
        self.estop = False
        request.reply({})

    def _on_status(self, request: Request) -> None:
        request.reply(self.status())

    def status(self) -> dict[str, Any]:
        """What an operator wants to know."""
        return {
            "pid": os.getpid(),
            "ready": self.lease_chosen and self.mailbox.permit is not None and self.mailbox.command is not None,
            "number": self.timeline.number,
            "tick": self.timeline.tick if self.timeline.tick != NO_TRIAL else None,
            "gate": self.gate.state,
            "gate_cause": GateCause(self.gate.cause).name,
            "dac_counts": list(self.gate.codes),
            "estop": self.estop,
            "lease_ms": self.limits.permit_ttl_ns / 1e6 if self.lease_chosen else None,
            "experiment": self.bus.run.experiment.hex(),
            "run": self.bus.run.run,
            "counters": self.counters.summary(),
            "discarded": {
                "controller/command": dict(self.commands.acceptance.discarded),
                "supervisor/permit": dict(self.permits.acceptance.discarded),
                "foreign_run": self.mailbox.foreign_runs,
            },
            "lost": {
                "controller/command": self.commands.acceptance.lost,
                "supervisor/permit": self.permits.acceptance.lost,
            },
        }


def _numbers(cause: int, seen: GateInput, limits: GateLimits) -> tuple[float, float]:
    """Measured value and limit behind a decision."""
    numbers = {
        GateCause.PERMIT_STALE: (seen.permit.age_ns / 1e9, limits.permit_ttl_ns / 1e9),
        GateCause.COMMAND_STALE: (seen.command.age_ns / 1e9, limits.command_ttl_ns / 1e9),
        GateCause.FORCE_ABOVE_LIMIT: (seen.force_n, limits.force_limit_n),
        GateCause.FORCE_INVALID: (float(seen.force_counts), float(limits.max_force_counts)),
    }
    return numbers.get(GateCause(cause), (0.0, 0.0))
