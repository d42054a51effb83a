"""One run in a live cell: load in two phases, arm, start, watch, stop."""

import secrets
import time
from collections.abc import Callable, Mapping
from contextlib import closing
from typing import Any, NamedTuple

from hydrohil.cell.collect import Collector, GapError
from hydrohil.cell.process_faults import ProcessFaults
from hydrohil.cell.processes import LOOP, CellError, TrippedError, UnqualifiedError, ask, statuses
from hydrohil.claims.trace import Trace
from hydrohil.experiment.experiment import Experiment, to_plain
from hydrohil.experiment.sections import tare_ticks
from hydrohil.shared.contract.codec import Received, Rejected
from hydrohil.shared.contract.envelope import seal
from hydrohil.shared.contract.faults import of_group
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, Mode, ParameterEvent
from hydrohil.shared.host.qualified import beyond, of_plain
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.trips.events import change_words
from hydrohil.shared.trips.report import Document
from hydrohil.shared.trips.ring import AFTER_NS
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS
from hydrohil.simulation.rollout import duration_ticks

_RUN_BITS = 48
_WATCH_S = 0.05
_FAULT_S = 0.002  # while a process fault waits for its time
_SILENCE_S = 6.0  # longer than the plant waits for an answer in lockstep


class Loaded(NamedTuple):
    """What a cell answers when it has taken an experiment."""

    run: int
    warnings: tuple[str, ...]  # of the controller: it runs nevertheless


class Live(NamedTuple):
    """What a live run gave."""

    trace: Trace | None
    gap: str  # why there is no trace
    tripped: str  # why the rig tripped, in words; "" if it did not
    status: dict[str, dict[str, Any]]
    warnings: tuple[str, ...]  # of the cell, when it took the experiment
    process_faults: tuple[str, ...] = ()  # those that were carried out, and when
    changed: tuple[str, ...] = ()  # parameters that were changed by hand, and when
    trip_report: Document | None = None


Progress = Callable[[float], object]  # is given the seconds of the trial


def load(bus: Bus, experiment: Experiment, seed: int, clock: str, *, unqualified: bool = False) -> Loaded:
    """All validate and return the hash, then all commit; returns the run's number and what the controller warns of.

    Raises CellError; UnqualifiedError where this host is not qualified for the rate and that is not `unqualified` on purpose.
    """
    supervisor = ask(bus, "supervisor", "status")
    if supervisor["mode"] == Mode.TRIPPED.name:
        raise TrippedError(f"the rig has tripped: {supervisor['words']}; remove the cause, then `hydrohil reset`")
    run = secrets.randbits(_RUN_BITS)
    envelope = sealed(experiment, run, seed, clock)
    answers = {service: ask(bus, service, "load", envelope=envelope, unqualified=unqualified) for service in LOOP}
    if clock == "real" and not unqualified:
        _refuse_beyond_qualified(answers["supervisor"], experiment)
    digests = {service: answer["digest"] for service, answer in answers.items()}
    if len(set(digests.values())) != 1:
        raise CellError(f"the services disagree on the experiment's hash: {digests}")
    for service in LOOP:
        ask(bus, service, "commit", digest=digests[service])
    return Loaded(run, tuple(map(str, answers["controller"].get("warnings") or ())))


def _refuse_beyond_qualified(answer: dict[str, Any], experiment: Experiment) -> None:
    """Refuse at once what the supervisor would refuse to arm; its answer names what is on record of its host."""
    period_ns = experiment.plant.sample_period_substeps * SUBSTEP_NS
    if what := beyond(of_plain(answer.get("qualification")).qualified, period_ns):
        raise UnqualifiedError(what)


def sealed(experiment: Experiment, run: int, seed: int, clock: str) -> str:
    """The text that every service loads."""
    return seal(
        to_plain(experiment),
        run=run,
        seed=seed,
        clock=clock,
        tare_ticks=tare_ticks(experiment.plant),
        duration_ticks=duration_ticks(experiment.duration_s, experiment.plant),
    )


def arm(bus: Bus, timeout_s: float = 3.0) -> None:
    """Arm as soon as every service agrees; raises CellError with the last reason."""
    deadline = time.monotonic() + timeout_s
    while True:
        try:
            ask(bus, "supervisor", "arm")
            return
        except CellError:
            if time.monotonic() > deadline:
                raise
            time.sleep(_WATCH_S)


class Silence:
    """When each service was last heard of, by the sample that its newest message names."""

    def __init__(self) -> None:
        """Every service counts as heard of just now."""
        self._numbers = dict.fromkeys(LOOP, NO_COMMAND)
        self._heard = dict.fromkeys(LOOP, time.monotonic())

    def hear(self, newest: Mapping[str, Received | Rejected | None]) -> None:
        """Take the newest message of each service in."""
        for service, message in newest.items():
            if isinstance(message, Received) and message.header.echo_number != self._numbers[service]:
                self._numbers[service], self._heard[service] = message.header.echo_number, time.monotonic()

    def of(self) -> list[str]:
        """The services that have fallen silent; where all have, those that did not answer the plant's last sample."""
        now = time.monotonic()
        silent = [service for service in LOOP if now - self._heard[service] > _SILENCE_S]
        return [service for service in silent if self._numbers[service] < self._numbers["plant"]] or silent


def watch(collector: Collector, experiment: Experiment, progress: Progress, poll_s: float = _WATCH_S) -> None:
    """Wait until the supervisor ends or trips the trial; `progress` gets the seconds of the trial. CellError on silence."""
    began, silence = False, Silence()
    while True:
        time.sleep(poll_s)
        permit, sample, command = collector.permits.peek(), collector.samples.peek(), collector.commands.peek()
        silence.hear({"plant": sample, "controller": command, "supervisor": permit})
        if isinstance(sample, Received) and sample.body.tick != NO_TRIAL:
            progress(sample.body.trial_time_ns * 1e-9)
        if isinstance(permit, Received):
            began = began or permit.body.mode == Mode.RUNNING
            if permit.body.mode == Mode.TRIPPED or (began and permit.body.mode == Mode.DISARMED):
                return
        if silent := silence.of():
            raise CellError(f"the {' and the '.join(silent)} has fallen silent; see `hydrohil status`")


def run_live(bus: Bus, experiment: Experiment, seed: int, clock: str, progress: Progress, *, unqualified: bool = False) -> Live:
    """Load, arm, start, watch to the end; always disarms. A CellError after a trip carries the trip's report."""
    loaded = load(bus, experiment, seed, clock, unqualified=unqualified)
    with closing(Collector(bus)) as collector:
        process_faults = ProcessFaults(bus, of_group(experiment.faults, "process"), experiment.duration_s)
        _play(bus, experiment, collector, process_faults, progress)
        return _gather(bus, experiment, loaded, collector, tuple(process_faults.done))


def _play(bus: Bus, experiment: Experiment, collector: Collector, process_faults: ProcessFaults, progress: Progress) -> None:
    """Play the loaded experiment, from arming to its end. Raises CellError."""

    def observe(trial_s: float) -> None:
        process_faults.at(trial_s)
        progress(trial_s)

    try:
        arm(bus)
        ask(bus, "supervisor", "start")
        watch(collector, experiment, observe, _FAULT_S if process_faults.pending else _WATCH_S)
    except CellError as error:
        bus.ask("supervisor", "stop", {}, 1.0)
        ended = CellError("; ".join((str(error), *process_faults.done)))
        ended.trip_report = collector.report(bus.identity.cell)
        raise ended from error
    except BaseException:  # Ctrl-C, or an exception of the caller's `progress`: the rig is disarmed in every case
        bus.ask("supervisor", "stop", {}, 1.0)
        raise
    finally:
        process_faults.end()


def _gather(bus: Bus, experiment: Experiment, loaded: Loaded, collector: Collector, process_faults: tuple[str, ...]) -> Live:
    """What the run has left: its trace, and how it ended."""
    time.sleep(_WATCH_S)  # the last answers are under way
    status = statuses(bus)
    tripped, report = collector.trip(loaded.run), None
    changed = collector.changed(loaded.run) or remembered_changes(status)  # a message may be lost
    if tripped:
        time.sleep(AFTER_NS / NS_PER_S)  # what comes after belongs to the report
        report = collector.report(bus.identity.cell)
    trace, gap = _trace(collector, loaded.run, duration_ticks(experiment.duration_s, experiment.plant), tripped=bool(tripped))
    return Live(
        trace,
        gap=gap,
        tripped=tripped,
        status=status,
        warnings=loaded.warnings,
        process_faults=process_faults,
        changed=changed,
        trip_report=report,
    )


def _trace(collector: Collector, run: int, ticks: int, *, tripped: bool) -> tuple[Trace | None, str]:
    """The trace, or why there is none."""
    try:
        trace = collector.trace(run, ticks)
    except GapError as error:
        return None, str(error)
    if not tripped and len(trace.tick) != ticks:
        return None, f"the trial ended after {len(trace.tick)} of {ticks} samples"
    return trace, ""


def remembered_changes(status: Mapping[str, dict[str, Any]]) -> tuple[str, ...]:
    """What the controller's status says was changed by hand since the load, in words."""
    events = status.get("controller", {}).get("by_hand", ())
    return tuple(change_words(ParameterEvent(**event)) for event in events)
