"""The controller's process: clocked by the samples that it answers."""

import os
import time
from collections.abc import Callable
from typing import Any

from hydrohil.services.controller.checks import check
from hydrohil.services.controller.config import Changes, ControllerConfig, Reference, controller_params, segment_table
from hydrohil.services.controller.contact_environment import contact_environment
from hydrohil.services.controller.live_parameters import Loaded, Parameters
from hydrohil.services.controller.parameter_change import Change, handed_over
from hydrohil.services.controller.parameter_schedule import ParameterSchedule, scheduled
from hydrohil.services.controller.preflight import preflight
from hydrohil.services.controller.step import control_start, control_step
from hydrohil.shared.contract.codec import Received, encode
from hydrohil.shared.contract.configured_machine import geometry
from hydrohil.shared.contract.envelope import Envelope, checked, section
from hydrohil.shared.contract.messages import NO_TRIAL, Command, GateState, PlantDescription, Sample, SampleDropped
from hydrohil.shared.host.process import options_of, parser, serve
from hydrohil.shared.host.two_phase_load import Checked, TwoPhaseLoad
from hydrohil.shared.machine.description import LINKS
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.impairment_queue import ImpairedSample
from hydrohil.shared.transport.link_stats import due, link_stats, nonzero_counts
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request
from hydrohil.shared.transport.step_lock import StepLock
from hydrohil.shared.units import SUBSTEP_NS

IDLE = ControllerConfig(target="joint")
_WAKE_S, _EXAMINING_S = 0.1, 0.002
_NO_FIRST_TICK = 0  # no trial is loaded: the law never runs


class Controller:
    """Answers every sample: the loaded law while the gate is open, zero current while it is shut."""

    def __init__(self, bus: Bus) -> None:
        """Nothing loaded: track."""
        self.bus, self.faults = bus, LiveFaults(bus)
        self.samples, self.descriptions = bus.subscribe("plant/sample"), bus.subscribe("plant/description")
        self.warmups, self.warmed_up = bus.subscribe("plant/warmup"), 0
        self._inboxes = (self.samples, self.warmups, self.descriptions)
        self.description: PlantDescription | None = None
        self.config, self.first_tick = IDLE, _NO_FIRST_TICK
        self.reference: Reference = ()
        self.parameters = Parameters()
        self._loading = TwoPhaseLoad(bus, self.faults, busy=self._busy, check=self._check, take=self._take)
        self.answered, self.tick = 0, NO_TRIAL
        self.revoked = False  # the gate, at the last sample

    def run(self, stopped: Callable[[], bool]) -> None:
        """Run until `stopped()`: the bus's thread answers samples, this one serves requests."""
        step_lock = StepLock(self.step)
        self.bus.step_on_arrival(step_lock)
        while not stopped():
            self.bus.wait(_EXAMINING_S if self.parameters.examines else _WAKE_S)
            if step_lock.run_between_steps(self.serve):
                self.bus.wake()

    def step(self) -> None:
        """Answer every sample that has come."""
        for message in self.descriptions.take():
            self._learn(message.body)
        for message in self.samples.take():
            self._answer(message)
        for impaired in self.samples.impaired_samples():
            self._publish_dropped(impaired)
        for message in self.warmups.take():
            self._warm_up(message)

    def serve(self) -> None:
        """Answer the requests that have come, and examine the parameters that they ask for."""
        for request in self.bus.requests():
            self._serve(request)
        self.parameters.examine()

    def _learn(self, description: PlantDescription) -> None:
        if description != self.description:
            self.description = description
            self._prepare()

    def _prepare(self) -> None:
        if self.description is None:
            return
        self.params = controller_params(self.config, self.description, self.first_tick)
        self.table = segment_table(self.reference)
        self.memory = control_start(self.params)

    def _answer(self, message: Received) -> None:
        """One sample in, one command and one state out."""
        if self.description is None:
            return
        self.faults.spend()
        began_ns = time.perf_counter_ns()
        sample, header = message.body, message.header
        change = self._change_parameters(sample, self.description) if self.parameters.busy else None
        self.memory, codes, state = control_step(self.memory, self.params, self.table, sample)
        echo = (sample.number, sample.time_ns)
        self.bus.run = self.bus.run._replace(arming_id=header.arming_id)
        self.bus.publish("controller/command", Command(codes), echo)
        os.sched_yield()  # to the transport's thread, which sends it
        state = state._replace(compute_ns=time.perf_counter_ns() - began_ns)
        self.bus.publish("controller/state", state, echo)
        self.answered += 1
        self.tick = sample.tick
        if change is not None:
            for event in self.parameters.events(change, sample.tick):
                self.bus.publish("controller/parameter_change", event, echo)
        revoked = sample.gate == GateState.REVOKED
        if due(sample.number, self.description.sample_period_ns) or (revoked and not self.revoked):
            self.bus.publish("controller/link_stats", link_stats(sample.number, self._inboxes), echo)
        self.revoked = revoked

    def _warm_up(self, warmup: Received) -> None:
        """Answer the last sample once more and send nothing: what the next one needs is in the processor's cache then."""
        if self.description is None or warmup.body.number != self.samples.number:
            return
        _, codes, state = control_step(self.memory, self.params, self.table, warmup.body)
        for topic, body in (("controller/command", Command(codes)), ("controller/state", state)):
            encode(topic, warmup.header, body)
        self.warmed_up += 1

    def _change_parameters(self, sample: Sample, description: PlantDescription) -> Change | None:
        """Change the parameters that change at this sample."""
        change, config = self.parameters.advance(sample.number, sample.tick, description.sample_period_ns)
        if change is not None:
            self.memory = handed_over(self.memory, change)
        if config is not None:
            self.params = controller_params(config, description, self.first_tick)
        return change

    def _publish_dropped(self, impaired: ImpairedSample) -> None:
        """Lockstep: a fault took this sample, so the plant gets no answer to it."""
        if not impaired.taken:
            self.bus.publish("controller/sample_dropped", SampleDropped(impaired.number), (impaired.number, impaired.time_ns))

    def _serve(self, request: Request) -> None:
        if request.verb == "load":
            self._loading.load(request)
        elif request.verb == "commit":
            self._loading.commit(request)
        elif request.verb == "status":
            request.reply(self.status())
        elif request.verb == "parameters":
            self.parameters.ask(request, self.tick)
        elif request.verb in ("inject", "clear"):
            self.faults.answer(request, self.samples.number)
        else:
            request.refuse(f"the controller knows no request {request.verb!r}")

    def _busy(self) -> str:
        return "the plant has not described itself yet: start it, or wait a second" if self.description is None else ""

    def _check(self, envelope: Envelope, _: dict[str, Any]) -> Checked[Loaded]:
        try:
            config = section(envelope, "controller", ControllerConfig)
            reference = section(envelope, "reference", Reference)
            plant = envelope.experiment["plant"]
            met, pitch_rad = contact_environment(plant), plant["machine"]["q4_rad"]
            q0 = tuple(plant["initial_q"][link] for link in LINKS)
            changes = checked(envelope.experiment.get("changes", []), "changes", Changes)
            waiting = scheduled(config, changes, plant["sample_period_substeps"] * SUBSTEP_NS) if changes else ()
            lengths = geometry(plant["machine"])
            acting = (config, *(after for _, after in waiting))
            for one in acting:
                check(one, reference, q0, pitch_rad, met, geometry=lengths)
        except (LookupError, TypeError, ArithmeticError) as error:  # [plant] is read as it came
            raise ValueError(str(error)) from error
        loaded = Loaded(
            ParameterSchedule(config, waiting), reference, q0, pitch_rad, met, lengths, lockstep=envelope.clock == "lockstep"
        )
        return Checked(loaded, {"warnings": list(dict.fromkeys(line for one in acting for line in preflight(one, met)))})

    def _take(self, envelope: Envelope, loaded: Loaded) -> None:
        self.config, self.reference = loaded.schedule.loaded, loaded.reference
        self.parameters.load(loaded)
        self.first_tick = -envelope.tare_ticks
        self._prepare()

    def status(self) -> dict[str, Any]:
        """What `hydrohil status` shows of the controller."""
        return {
            "pid": os.getpid(),
            "injected": self.faults.acting(),
            "ready": self.description is not None and self.answered > 0,
            "law": self.parameters.schedule.target.law,
            "target": self.config.target,
            "changed": self.parameters.changed(),
            "by_hand": [event._asdict() for event in self.parameters.by_hand],
            "answered": self.answered,
            "warmed_up": self.warmed_up,
            "machine": "" if self.description is None else self.description.machine.name,
            "machine_hash": "" if self.description is None else self.description.machine_hash.hex(),
            "experiment": self.bus.run.experiment.hex(),
            "run": self.bus.run.run,
            "link_stats": nonzero_counts(self._inboxes),
        }


def main(arguments: list[str] | None = None) -> int:
    """Run until a signal; returns the exit status."""
    line = parser("controller", __doc__)
    options = options_of(line, line.parse_args(arguments))
    return serve("controller", options, lambda bus, stopped: Controller(bus).run(stopped))
