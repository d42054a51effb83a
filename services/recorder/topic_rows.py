"""A batch of one topic's messages as rows: exact values, figures, state timelines, scene, log lines of the gate."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hydrohil.services.recorder import scene
from hydrohil.services.recorder.rows import Rows, Times, selected, times_of
from hydrohil.services.recorder.sample_index import IndexedSample
from hydrohil.services.recorder.state_timeline import changes, state_timelines
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.columns import MS, Matrix, column_names, figure_values, figures, flat_rows
from hydrohil.shared.contract.messages import Command, ControllerState, GateEvent, PlantDescription, Sample
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.trips.events import gate_event

ANSWER_LATENCY = "figure/latency/answer"


class Batch(NamedTuple):
    """Messages of one topic, all in a trial or all outside, with the samples that they belong to."""

    messages: list[Received]
    samples: list[IndexedSample]

    def rows(self, chosen: slice) -> "Batch":
        """Some of the rows."""
        return Batch(self.messages[chosen], self.samples[chosen])


class TopicRows:
    """Writes batches. Keeps what it has written once a file: column names, and the last state of each timeline."""

    def __init__(self, emit: Callable[[Rows], None]) -> None:
        """A file begins."""
        self._emit = emit
        self.begin_file()

    def begin_file(self) -> None:
        """Names and states are written again, with the next rows: each file of a recording opens alone."""
        self._names: dict[str, tuple[str, ...]] = {}
        self._states: dict[str, tuple[bool, float]] = {}  # of each timeline: in a trial, last value

    def name_columns(self, entity: str, names: tuple[str, ...]) -> None:
        """Write the names of an entity's columns, unless this file has them."""
        if self._names.get(entity) != names:
            self._names[entity] = names
            self._emit(Rows(entity, "names", None, names))

    def write(self, topic: str, batch: Batch, description: PlantDescription | None) -> None:
        """Write a batch."""
        first = batch.messages[0]
        message, times = type(first.body), times_of(batch.samples)
        names = column_names(first.body, first.header)
        matrix = flat_rows([m.body for m in batch.messages], [m.header.seq for m in batch.messages])
        entity = f"topic/{topic}"
        self.name_columns(entity, names)
        self._emit(Rows(entity, "scalars", times, matrix))
        self._write_states(message, names, matrix, times)
        converters = (description.machine if description else UNIMATE).converters
        for figure in figures(message, converters):
            values = figure_values(figure, names, matrix)
            if values is not None:
                self._emit(Rows(figure.entity, "scalars", times, values))
        for rows in _scene_and_log(message, batch, names, matrix, times, machine=scene.machine(description)):
            self._emit(rows)

    def _write_states(self, message: type, names: tuple[str, ...], matrix: Matrix, times: Times) -> None:
        """Write each timeline where its state changes, and where a trial begins or ends."""
        in_trial = times.trial_ns is not None
        for timeline in state_timelines(message):
            if timeline.column not in names:
                continue
            column = matrix[:, names.index(timeline.column)]
            if timeline.column == "clamped":
                column = (column != 0).astype(np.float64)
            was_in_trial, last = self._states.get(timeline.entity, (None, None))
            at = changes(column, last if was_in_trial == in_trial else None)
            self._states[timeline.entity] = (in_trial, float(column[-1]))
            if len(at):
                self._emit(Rows(timeline.entity, "state", selected(times, at), [timeline.text(column[i]) for i in at]))


def _scene_and_log(
    message: type, batch: Batch, names: tuple[str, ...], matrix: Matrix, times: Times, *, machine: scene.Machine
) -> list[Rows]:
    """Rows that only some messages have."""
    if message is Sample:
        return scene.joint_rows(names, matrix, times, machine)
    if message is ControllerState:
        return scene.tip_rows(names, matrix, times, machine)
    if message is GateEvent:
        events = [gate_event(m.body) for m in batch.messages]
        return [Rows("log/gate", "text", times, [(event.level, event.text) for event in events])]
    if message is Command:
        return [Rows(ANSWER_LATENCY, "scalars", times, _answer_ms(batch))]
    return []


def _answer_ms(batch: Batch) -> Matrix:
    """From a sample's arrival at the recorder to its command's, in ms; NaN if the sample never came."""
    command_ns = np.array([m.arrival_ns for m in batch.messages], np.float64)
    sample_ns = np.array([sample.arrival_ns or np.nan for sample in batch.samples], np.float64)
    latency_ms: Matrix = ((command_ns - sample_ns) * MS)[:, None]
    return latency_ms
