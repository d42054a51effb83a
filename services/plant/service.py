"""The plant's process: samples on a grid, drains the bus at the latch, lets the gate decide, writes to the device."""

import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.counters import Counters
from hydrohil.services.plant.device import Device, Faults, Timeline
from hydrohil.services.plant.gatekeeper import Gatekeeper
from hydrohil.services.plant.plant_clock import PlantClock
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.plant.requests import PlantRequests
from hydrohil.services.plant.warmup import Warmups
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_TRIAL, FaultEvent, GateState, GroundTruth, Sample
from hydrohil.shared.host.clock import SLACK_NS
from hydrohil.shared.host.lease import UNCHOSEN, LeaseChoice
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.link_stats import due
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.units import SUBSTEP_NS

LOCKSTEP_TIMEOUT_S = 5.0
DESCRIPTION_EVERY = 100  # samples, for services that join late
_POLL_S = 0.05


class PeerSilentError(Exception):
    """A peer did not answer in lockstep."""


class Plant:
    """Repeats one cycle: a sample, the latch at which its command takes effect, the operator's requests."""

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
        """Subscribe; `stopped()` ends `run`, `lease` chooses how long permits and commands stay fresh."""
        self.bus, self.device, self.timeline, self.stopped = bus, device, timeline, stopped
        self.clock, self.counters = PlantClock(timeline), Counters()
        self.lease, self.faults = lease, LiveFaults(bus)
        self.warmups = Warmups(bus, self.clock.grid, enabled=warmups)
        self.keeper = Gatekeeper(bus, device, timeline, limits, self.counters)
        self.requests = PlantRequests(
            bus,
            device,
            self.keeper,
            self.clock,
            self.faults,
            loaded=self.publish_description,
            status=self.status,
        )
        self._trial_zero_ns = 0
        self._last: Sample | None = None
        self._ground_truth: GroundTruth | None = None
        self._faults: Faults = ()

    def run(self) -> None:
        """Cycle until `stopped()`; leaves the valves at zero current."""
        try:
            while not self.stopped():
                self.sample()
                self.update_outputs()
                self.serve()
        finally:
            self.device.write((ZERO_CODE, ZERO_CODE, ZERO_CODE))

    def sample(self) -> None:
        """Wait for the sample's instant, read the converters, publish."""
        clock, keeper, timeline = self.clock, self.keeper, self.timeline
        if self._last is not None and timeline.tick != NO_TRIAL and not clock.lockstep:
            self.warmups.send(clock.due, self._last)
        self._wait(clock.due)
        if clock.lockstep:
            self._receive_lockstep(clock.due)
        else:
            keeper.receive(clock.now_ns(), at_latch=False, late=self._apply_late)
        clock.advance_to(clock.due)
        number, time_ns = timeline.number, clock.due_ns
        tick = timeline.tick = clock.schedule.tick(number)
        self.bus.conditions.observe_sample(number, tick)
        if tick == clock.schedule.first_tick:
            self._begin_trial()
        reading = self.device.read()
        keeper.issue_sample(number, time_ns, clock.now_ns(), reading.force_counts)
        self._serve_stops()  # before the sample is composed, so that it reports them
        gate = keeper.gate
        self._publish(
            Sample(
                number=number,
                time_ns=time_ns,
                tick=tick,
                trial_time_ns=time_ns - self._trial_zero_ns if tick != NO_TRIAL else 0,
                encoder_counts=reading.encoder_counts,
                force_counts=reading.force_counts,
                dac_counts=gate.codes,
                gate=gate.state,
                gate_cause=gate.cause,
                gate_open_samples=gate.open_samples,
                recover_signs=gate.recover_signs,
                command_number=gate.command_number,
                command_late_substeps=keeper.late_substeps,
                command_age_ns=keeper.command_age_ns,
            )
        )

    def _publish(self, sample: Sample) -> None:
        self.bus.run = self.bus.run._replace(arming_id=self.keeper.arming_id)
        self.bus.publish("plant/sample", sample, (sample.number, sample.time_ns))
        self._last = sample
        self._ground_truth = self.device.ground_truth()
        if self.clock.lockstep:
            self._publish_ground_truth()
        if sample.number % DESCRIPTION_EVERY == 0:
            self.publish_description()

    def _begin_trial(self) -> None:
        self.device.begin()
        self.keeper.begin_trial()
        self.counters.reset()
        self._trial_zero_ns = self.clock.due_ns + self.clock.schedule.bias_ns

    def update_outputs(self) -> None:
        """At the latch the newest valid permit and command decide, and what the gate gives is written to the D/A."""
        self.faults.spend()
        clock, keeper = self.clock, self.keeper
        latch = clock.latch
        if clock.lockstep:
            self._await_answers()
        else:
            self._wait(latch)
            keeper.receive(clock.now_ns(), at_latch=True, late=self._apply_late)
        clock.advance_to(latch)
        self._count()
        self._serve_stops()
        keeper.judge(clock.now_ns(), at_latch=True)
        self._follow_permit()
        self._publish_ground_truth()
        self._publish_faults()
        if due(self.timeline.number, clock.period_ns):
            keeper.publish_link_stats()
        clock.next_sample()

    def _publish_ground_truth(self) -> None:
        """Once a sample: in lockstep while the others answer it, else after the latch, so that it delays no command."""
        ground_truth, self._ground_truth = self._ground_truth, None
        if ground_truth is not None:
            self.bus.publish("plant/ground_truth", ground_truth, (self.timeline.number, self.clock.due_ns))

    def _publish_faults(self) -> None:
        """Publish each fault that has begun or ended with this sample."""
        before, self._faults = self._faults, self.device.faults()[0]
        if before == self._faults:
            return
        for acting, changed in ((0, Counter(before) - Counter(self._faults)), (1, Counter(self._faults) - Counter(before))):
            for fault in changed.elements():
                event = FaultEvent(
                    number=self.timeline.number,
                    tick=self.timeline.tick,
                    acting=acting,
                    kind=fault.kind,
                    target=fault.target,
                    value=fault.value,
                )
                self.bus.publish("plant/fault", event, (self.timeline.number, self.clock.due_ns))

    def _count(self) -> None:
        """Count which answers were in time; the plant alone decides that, here, when it has drained the bus at the latch."""
        number, clock = self.timeline.number, self.clock
        if self.timeline.tick == NO_TRIAL:
            return
        answered = self.keeper.command_answers(number)
        self.counters.latch(self.timeline.tick, answered=answered, judged=self.keeper.permit_answers(number))
        if clock.lockstep:  # the plant takes all answers of this sample at the latch
            return
        latch_ns = clock.latch_delay_ns
        self.warmups.observe(self.keeper.command_age_ns if answered else latch_ns, latch_ns)

    def _await_answers(self) -> None:
        """Lockstep: wait until command and permit answer this sample, or the trial ends; raises PeerSilentError with names."""
        deadline = time.monotonic() + LOCKSTEP_TIMEOUT_S
        number = self.timeline.number
        while self.clock.lockstep and not self.stopped() and not self.keeper.stop_pressed:
            self._receive_lockstep(self.clock.latch)
            missing = self.keeper.awaited(number)
            if not missing:
                return
            if time.monotonic() > deadline:
                raise PeerSilentError(
                    f"no answer from {' and '.join(missing)} to sample {number} within {LOCKSTEP_TIMEOUT_S:g} s"
                )
            self.serve()
            self.bus.wait(_POLL_S)

    def _receive_lockstep(self, substep: int) -> None:
        """Lockstep: take what has come by a sub-step of simulated time; only faults make it late."""
        self.keeper.receive_lockstep(substep * SUBSTEP_NS, self.clock.latch_delay_ns, self._apply_at)

    def _apply_late(self, message: Received) -> None:
        """A command that answers an older sample takes effect at the sub-step at which it arrived."""
        self._apply_at(message, self.clock.grid.substep_at(message.arrival_ns))

    def _apply_at(self, message: Received, substep: int) -> None:
        clock = self.clock
        arrived = min(max(substep, self.timeline.substep), clock.latch)
        clock.advance_to(arrived)
        if self.timeline.tick != NO_TRIAL:
            self.counters.late_commands += 1
        late_substeps = max(1, arrived - message.header.echo_time_ns // SUBSTEP_NS - clock.schedule.latch)
        self.keeper.judge_late(clock.now_ns(), late_substeps)

    def _follow_permit(self) -> None:
        """A permit announces the trial's first sample; without a running permit there is no trial."""
        first_sample = self.keeper.announced_sample()
        if first_sample is None:
            self.clock.schedule.forget()
        elif first_sample > self.timeline.number:
            self.clock.schedule.announce(first_sample)

    def _wait(self, substep: int) -> None:
        """Wait until a sub-step is due. A plant whose overrun exceeds its lease cuts before it integrates or writes anything."""
        clock, keeper = self.clock, self.keeper
        if clock.lockstep:
            clock.grid.restart_at(substep)
            return
        late_ns = clock.grid.wait(substep)
        if self.timeline.tick != NO_TRIAL:
            self.counters.woke(late_ns, shifts=late_ns > SLACK_NS)
        lease_ns = self.lease.after(late_ns, armed=keeper.arming_id != 0)
        if lease_ns != UNCHOSEN:
            keeper.set_lease(lease_ns)
            self.publish_description()
        awaits_lockstep = clock.schedule.lockstep and keeper.gate.state == GateState.SHUT  # RECOVER goes by the wall clock
        if self.lease.chosen and not awaits_lockstep and late_ns > keeper.limits.permit_ttl_ns:
            keeper.judge(clock.now_ns(), at_latch=False, overrun=True)

    def _serve_stops(self) -> None:
        """Answer emergency stops; they wait for the next sample or latch at most, a load, which takes long, for its turn."""
        for request in self.bus.stops():
            self.requests.answer(request)

    def serve(self) -> None:
        """Answer the requests that have come since the last sample."""
        for request in self.bus.requests():
            self.requests.answer(request)

    def publish_description(self) -> None:
        """Publish the machine's description; a lease of 0 means that none is chosen yet."""
        limits = self.keeper.limits
        if not self.lease.chosen:
            limits = limits._replace(permit_ttl_ns=UNCHOSEN, command_ttl_ns=UNCHOSEN)
        self.bus.publish("plant/description", describe(self.clock.schedule.config, limits))

    def status(self) -> dict[str, Any]:
        """The plant's own part of its status: whether it is ready, where it is, what it has counted."""
        tick = self.timeline.tick
        return {
            "ready": self.lease.chosen and self.keeper.connected,
            "number": self.timeline.number,
            "tick": tick if tick != NO_TRIAL else None,
            "lease_ms": self.keeper.limits.permit_ttl_ns / 1e6 if self.lease.chosen else None,
            "counters": self.counters.summary(),
            "warmups": self.warmups.sent,
        }
