"""The plant's process: samples on a grid, drains the bus at the latch, lets the gate decide, writes to the device."""

import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.counters import Counters
from hydrohil.services.plant.device import Device, Faults, Timeline
from hydrohil.services.plant.gatekeeper import Gatekeeper
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.plant.requests import answer
from hydrohil.services.plant.trial import Schedule
from hydrohil.services.plant.warmup import Warmups
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_TRIAL, FaultEvent, GateState, GroundTruth, Mode, Sample
from hydrohil.shared.host.clock import SLACK_NS, Grid
from hydrohil.shared.host.lease import UNCHOSEN, LeaseChoice
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.link_stats import due
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.units import SUBSTEP_NS

LOCKSTEP_TIMEOUT_S = 5.0
DESCRIPTION_EVERY = 100  # samples: for those who join late
_POLL_S = 0.05


class PeerSilentError(Exception):
    """A peer did not answer in lockstep."""


class Plant:
    """Samples, latches and requests, in that order, for ever."""

    def __init__(
        self,
        bus: Bus,
        device: Device,
        timeline: Timeline,
        limits: GateLimits,
        stopped: Callable[[], bool],
        lease: LeaseChoice,
        *,
        warmups: bool = True,
    ) -> None:
        """Take the places on the bus."""
        self.bus, self.device, self.timeline, self.stopped = bus, device, timeline, stopped
        self.grid, self.counters = Grid(), Counters()
        self.lease, self.faults = lease, LiveFaults(bus)
        self.warmups = Warmups(bus, self.grid, wanted=warmups)
        self.keeper = Gatekeeper(bus, device, timeline, limits, self.counters)
        self.schedule = Schedule(PlantConfig())
        self.pending: Schedule | None = None
        self.due = 0  # sub-step of the next sample
        self._trial_zero_ns = 0
        self._last: Sample | None = None
        self._ground_truth: GroundTruth | None = None
        self._faults: Faults = ()

    def run(self) -> None:
        """Until told to stop; leaves the valves at zero."""
        try:
            while not self.stopped():
                self.sample()
                self.latch()
                self.serve()
        finally:
            self.device.write((ZERO_CODE, ZERO_CODE, ZERO_CODE))

    def sample(self) -> None:
        """Wait for the grid, read the converters, publish."""
        if self._last is not None and self.timeline.tick != NO_TRIAL and not self._lockstep():
            self.warmups.send(self.due, self._last)
        self._wait(self.due)
        if self._lockstep():
            self._receive_lockstep(self.due)
        else:
            self.keeper.receive(self.now_ns(), at_latch=False, late=self._apply_late)
        self._advance_to(self.due)
        number, time_ns = self.timeline.number, self.due * SUBSTEP_NS
        tick = self.timeline.tick = self.schedule.tick(number)
        self.bus.conditions.see(number, tick)
        if tick == self.schedule.first_tick:
            self._begin_trial()
        reading = self.device.read()
        keeper = self.keeper
        keeper.force_counts = reading.force_counts
        keeper.ledger.issue(number, time_ns, self.now_ns())
        self._serve_stops()  # before the sample is made, so that it tells
        gate = keeper.gate
        sample = Sample(
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
            keeper.late_substeps,
            keeper.command_age_ns,
        )
        self._publish(sample)

    def _publish(self, sample: Sample) -> None:
        echo = (sample.number, sample.time_ns)
        self.bus.run = self.bus.run._replace(arming_id=self.keeper.mailbox.arming_id)
        self.bus.publish("plant/sample", sample, echo)
        self._last = sample
        self._ground_truth = self.device.ground_truth()
        if self._lockstep():
            self._publish_ground_truth()
        if sample.number % DESCRIPTION_EVERY == 0:
            self.publish_description()

    def _begin_trial(self) -> None:
        self.device.begin()
        self.keeper.begin_trial()
        self.counters.reset()
        self._trial_zero_ns = self.due * SUBSTEP_NS + self.schedule.bias_ns

    def latch(self) -> None:
        """Let the newest valid permit and command decide, and write what the gate gives."""
        self.faults.spend()
        latch = self.due + self.schedule.latch
        if self._lockstep():
            self._await_answers()
        else:
            self._wait(latch)
            self.keeper.receive(self.now_ns(), at_latch=True, late=self._apply_late)
        self._advance_to(latch)
        self.keeper.late_substeps = 0
        self._count()
        self._serve_stops()
        self.keeper.judge(self.now_ns(), at_latch=True)
        self._follow_permit()
        self._publish_ground_truth()
        self._publish_faults()
        if due(self.timeline.number, self.schedule.period * SUBSTEP_NS):
            self.keeper.publish_link_stats()
        self.due += self.schedule.interval(self.timeline.tick)
        self.timeline.number += 1

    def _publish_ground_truth(self) -> None:
        """Once a sample: in lockstep while the others answer it, else after the latch, until when the command's way is free."""
        ground_truth, self._ground_truth = self._ground_truth, None
        if ground_truth is not None:
            self.bus.publish("plant/ground_truth", ground_truth, (self.timeline.number, self.due * SUBSTEP_NS))

    def _publish_faults(self) -> None:
        """Each fault that has begun or ended with this sample."""
        before, self._faults = self._faults, self.device.faults()[0]
        if before == self._faults:
            return
        for acting, changed in ((0, Counter(before) - Counter(self._faults)), (1, Counter(self._faults) - Counter(before))):
            for fault in changed.elements():
                event = FaultEvent(self.timeline.number, self.timeline.tick, acting, fault.kind, fault.target, fault.value)
                self.bus.publish("plant/fault", event, (self.timeline.number, self.due * SUBSTEP_NS))

    def _count(self) -> None:
        """What was in time is decided here, at the latch's drain, and nowhere else."""
        mailbox, number = self.keeper.mailbox, self.timeline.number
        if self.timeline.tick == NO_TRIAL:
            return
        answered = mailbox.answered >= number
        self.counters.latch(self.timeline.tick, answered=answered, judged=mailbox.judged >= number)
        if self._lockstep():  # whose answers all come at the latch
            return
        latch_ns = self.schedule.latch * SUBSTEP_NS
        self.warmups.observe(self.keeper.command_age_ns if answered else latch_ns, latch_ns)

    def _await_answers(self) -> None:
        """Lockstep: until command and permit answer this sample, or a load ends the trial; PeerSilentError names who does not."""
        deadline = time.monotonic() + LOCKSTEP_TIMEOUT_S
        number = self.timeline.number
        while self._lockstep() and not self.stopped() and not self.keeper.estop:
            self._receive_lockstep(self.due + self.schedule.latch)
            missing = [name for name, dealt_with in self.keeper.dealt_with() if dealt_with < number]
            if not missing:
                return
            if time.monotonic() > deadline:
                raise PeerSilentError(
                    f"no answer from {' and '.join(missing)} to sample {number} within {LOCKSTEP_TIMEOUT_S:g} s"
                )
            self.serve()
            self.bus.wait(_POLL_S)

    def _receive_lockstep(self, substep: int) -> None:
        """Lockstep: what has come by a sub-step of simulated time; only faults make it late."""
        self.keeper.receive_lockstep(substep * SUBSTEP_NS, self.schedule.latch * SUBSTEP_NS, self._apply_at)

    def _apply_late(self, message: Received) -> None:
        """A command that answers an older sample takes effect at the sub-step at which it arrived."""
        self._apply_at(message, self.grid.substep_at(message.arrival_ns))

    def _apply_at(self, message: Received, substep: int) -> None:
        latest = self.due + self.schedule.latch
        arrived = min(max(substep, self.timeline.substep), latest)
        self._advance_to(arrived)
        self.keeper.late_substeps = max(1, arrived - message.header.echo_time_ns // SUBSTEP_NS - self.schedule.latch)
        if self.timeline.tick != NO_TRIAL:
            self.counters.late_commands += 1
        self.keeper.judge(self.now_ns(), at_latch=False)

    def _follow_permit(self) -> None:
        """A permit announces the trial's first sample; without a running permit there is no trial."""
        permit = self.keeper.mailbox.permit
        if permit is None or permit.body.mode != Mode.RUNNING:
            self.schedule.forget()
        elif permit.body.first_sample > self.timeline.number:
            self.schedule.announce(permit.body.first_sample)

    def _lockstep(self) -> bool:
        return self.schedule.lockstep and self.timeline.tick != NO_TRIAL

    def now_ns(self) -> int:
        """The clock by which ages are judged: the wall's, or simulated time in lockstep."""
        return self.timeline.substep * SUBSTEP_NS if self._lockstep() else time.monotonic_ns()

    def _advance_to(self, substep: int) -> None:
        self.timeline.substep = max(self.timeline.substep, substep)

    def _wait(self, substep: int) -> None:
        """Until a sub-step is due. A plant that overran its lease cuts before it integrates or writes anything."""
        if self._lockstep():
            self.grid.restart_at(substep)
            return
        late_ns = self.grid.wait(substep)
        if self.timeline.tick != NO_TRIAL:
            self.counters.woke(late_ns, shifts=late_ns > SLACK_NS)
        lease_ns = self.lease.after(late_ns, armed=self.keeper.mailbox.arming_id != 0)
        if lease_ns != UNCHOSEN:
            self.keeper.limits = self.keeper.limits._replace(permit_ttl_ns=lease_ns, command_ttl_ns=lease_ns)
            self.device.watchdog(lease_ns // SUBSTEP_NS)
            self.publish_description()
        awaits_lockstep = self.schedule.lockstep and self.keeper.gate.state == GateState.SHUT  # RECOVER goes by the wall
        if self.lease.chosen and not awaits_lockstep and late_ns > self.keeper.limits.permit_ttl_ns:
            self.keeper.judge(self.now_ns(), at_latch=False, overrun=True)

    def _serve_stops(self) -> None:
        """An emergency stop waits for the next sample or latch at most; a load, which takes long, for its turn."""
        for request in self.bus.stops():
            answer(self, request)

    def serve(self) -> None:
        """Answer what was asked since the last sample."""
        for request in self.bus.requests():
            answer(self, request)

    def publish_description(self) -> None:
        """Describe the machine; a lease of 0 says that none is chosen yet."""
        limits = self.keeper.limits
        if not self.lease.chosen:
            limits = limits._replace(permit_ttl_ns=UNCHOSEN, command_ttl_ns=UNCHOSEN)
        self.bus.publish("plant/description", describe(self.schedule.config, limits))

    def status(self) -> dict[str, Any]:
        """What an operator wants to know."""
        keeper = self.keeper
        tick = self.timeline.tick
        return {
            "ready": self.lease.chosen and keeper.permits.acceptance.accepted > 0 and keeper.commands.acceptance.accepted > 0,
            "number": self.timeline.number,
            "tick": tick if tick != NO_TRIAL else None,
            "lease_ms": keeper.limits.permit_ttl_ns / 1e6 if self.lease.chosen else None,
            "counters": self.counters.summary(),
            "warmups": self.warmups.sent,
        }
