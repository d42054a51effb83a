"""Messages in, rows out: batches per topic, placed at their samples, with figures, lanes, scene and events."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from hydrohil.services.recorder import scene
from hydrohil.services.recorder.rows import Rows, Times, alike, only, times_of
from hydrohil.services.recorder.sample_index import Place, SampleIndex, sample_numbers
from hydrohil.services.recorder.state_timeline import changes, state_timelines
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.columns import MS, Matrix, column_names, figure_values, figures, flat_rows
from hydrohil.shared.contract.converters import UNIMATE_CONVERTERS
from hydrohil.shared.contract.messages import (
    Command,
    ControllerState,
    FaultEvent,
    GateEvent,
    InboxCounts,
    LinkStats,
    ParameterEvent,
    Permit,
    PlantDescription,
    Sample,
)
from hydrohil.shared.contract.timeliness import answered_in_time
from hydrohil.shared.trips.events import (
    COUNT_NAMES,
    Event,
    fault_event,
    gate_event,
    late_event,
    link_stats_event,
    parameter_event,
    permit_events,
)

BATCH_ROWS = 1024  # a batch is a chunk of the file, with about 1 kB around it and 2 kB of index in memory; `flush` comes earlier
COUNT_ROWS = 10  # counters are told once a second; what is counted is in the recorder's answers at once
ANSWER_LATENCY = "figure/latency/answer"
# Told in words or as counters; the messages of every other topic are rows, for their arrays have fixed lengths.
WITHOUT_ROWS = (PlantDescription, LinkStats, FaultEvent, ParameterEvent)


class Run(NamedTuple):
    """Messages of one topic, with their places."""

    messages: list[Received]
    places: list[Place]

    def part(self, rows: slice) -> "Run":
        """Some of the rows."""
        return Run(self.messages[rows], self.places[rows])


class Writer:
    """Turns what arrived into rows for `emit`. Knows one plant at a time."""

    def __init__(self, emit: Callable[[Rows], None], batch_rows: int = BATCH_ROWS, count_rows: int = COUNT_ROWS) -> None:
        """Nothing waits, no plant is known."""
        self._emit = emit
        self._batch_rows, self._count_rows = batch_rows, count_rows
        self._waiting: dict[str, list[Received]] = {}
        self._counters: dict[str, list[tuple[Place, tuple[float, ...]]]] = {}  # rows that wait, by entity
        self._counts: dict[tuple[str, str], InboxCounts] = {}  # receiver and topic: what was told last
        self._places = SampleIndex()
        self._plant_epoch: int | None = None
        self._late = 0  # answers in a row that were late or missing, in a trial
        self.description: PlantDescription | None = None
        self.rows: dict[str, int] = {}
        self.begin()

    def begin(self) -> None:
        """A new recording begins: everything waiting goes out, then names, lanes and modes are told again."""
        self.flush(everything=True)
        self._permit: Permit | None = None
        self._arming_id = 0
        self.rows = {}
        self.retell()

    def retell(self) -> None:
        """Another file begins: what a reader of it alone must know is told again, with the next rows."""
        self._named: dict[str, tuple[str, ...]] = {}
        self._timeline: dict[tuple[str, bool], float] = {}
        if self.description is not None:
            self._describe(self.description)

    def take(self, *messages: Received) -> None:
        """Messages of one topic."""
        topic, kind = messages[0].topic, type(messages[0].body)
        if kind in WITHOUT_ROWS:
            self.rows[topic] = self.rows.get(topic, 0) + len(messages)
            for message in messages:
                self._tell_rare(message)
            return
        if kind is Sample:
            for message in messages:  # one by one: where another plant begins, what waits is written first
                self._take_sample(message)
                self._wait(topic, (message,))
            return
        if kind is Permit:
            for message in messages:
                self._publish_permit(message)
        self._wait(topic, messages)

    def _wait(self, topic: str, messages: Sequence[Received]) -> None:
        """Until a batch is full. Those that wait for their sample are looked at once a batch, not at each that comes."""
        waiting = self._waiting.setdefault(topic, [])
        batches = len(waiting) // self._batch_rows
        waiting.extend(messages)
        if len(waiting) // self._batch_rows > batches:
            self._flush_topic(topic, everything=len(waiting) >= 2 * self._batch_rows)

    def flush(self, everything: bool = False) -> None:
        """Write what waits; rows whose sample has not come yet go on waiting unless `everything`."""
        for topic in list(self._waiting):
            self._flush_topic(topic, everything)
        if everything:
            for entity in list(self._counters):
                self._write_counter(entity)

    def tell(self, event: Event, place: Place | None = None) -> None:
        """Write a line to the event log, at the newest sample unless a place is given."""
        place = self._places.newest if place is None else place
        self._emit(Rows(f"log/{event.source}", "text", times_of([place]), [(event.level, event.text)]))

    def scalar(self, entity: str, value: float) -> None:
        """Write one number at the newest sample."""
        self._count(entity, self._places.newest, (value,))

    def _count(self, entity: str, place: Place, values: tuple[float, ...]) -> None:
        """A row of counters; several make a batch."""
        rows = self._counters.setdefault(entity, [])
        rows.append((place, values))
        if len(rows) >= self._count_rows:
            self._write_counter(entity)

    def _write_counter(self, entity: str) -> None:
        rows = self._counters.pop(entity)
        for part in alike([place.trial_time_ns is None for place, _ in rows]):
            places, values = zip(*rows[part], strict=True)
            self._emit(Rows(entity, "scalars", times_of(list(places)), np.array(values, np.float64)))

    def _tell_rare(self, message: Received) -> None:
        """What is told in words or in counters, not as rows of its topic."""
        body = message.body
        if isinstance(body, LinkStats):
            self._publish_link_stats(message)
        elif isinstance(body, FaultEvent):
            self.tell(fault_event(body, message.header.sender), self._places.at(body.number))
        elif isinstance(body, ParameterEvent):
            self.tell(parameter_event(body), self._places.at(body.number))
        elif body != self.description:  # the plant repeats it for those who join late
            self.description = body
            self._describe(body)

    def _take_sample(self, message: Received) -> None:
        body = message.body
        self._follow_plant(message.header.epoch)
        place = self._places.add(body, message.arrival_ns)
        self._late = 0 if body.tick <= 0 or answered_in_time(body) else self._late + 1
        event = late_event(self._late, body.number)
        if event is not None:
            self.tell(event, place)

    def _describe(self, description: PlantDescription) -> None:
        lines = "\n".join(
            f"| {field} | {value} |" for field, value in description._asdict().items() if not isinstance(value, tuple)
        )
        channels = [*description.encoders, description.force, *description.converters]
        table = "\n".join(
            f"| {c.name} | {c.scale:g} {c.unit} | {c.offset:g} | {c.bits} | {c.low} .. {c.high} |" for c in channels
        )
        heads = f"| | |\n|-|-|\n{lines}", f"| channel | per count | offset | bits | counts |\n|-|-|-|-|-|\n{table}"
        self._emit(Rows("machine", "document", None, "\n\n".join((f"## {description.machine}", *heads))))

    def _follow_plant(self, epoch: int) -> None:
        if self._plant_epoch is not None and epoch != self._plant_epoch:
            self.flush(everything=True)
            self._places.clear()  # another plant numbers its samples from its own start
        self._plant_epoch = epoch

    def _publish_permit(self, message: Received) -> None:
        place = self._places.at(message.header.echo_number)
        for event in permit_events(self._permit, message.body):
            self.tell(event, place)
        if message.header.arming_id != self._arming_id and message.header.arming_id:
            self.tell(Event("supervisor", "INFO", f"arming id {message.header.arming_id}"), place)
        self._permit, self._arming_id = message.body, message.header.arming_id

    def _publish_link_stats(self, message: Received) -> None:
        """The counts of each inbox as one row, and a line where one grew that should not."""
        place = self._places.at(message.header.echo_number)
        receiver = message.header.sender
        for now in message.body.inboxes:
            entity = f"link_stats/{receiver}/{now.topic}"
            if self._named.get(entity) != COUNT_NAMES:
                self._named[entity] = COUNT_NAMES
                self._emit(Rows(entity, "names", None, COUNT_NAMES))
            self._count(entity, place, now[1:])
            event = link_stats_event(receiver, self._counts.get((receiver, now.topic)), now)
            self._counts[receiver, now.topic] = now
            if event is not None:
                self.tell(event, place)

    def _flush_topic(self, topic: str, everything: bool) -> None:
        waiting = self._waiting.pop(topic, [])
        numbers = sample_numbers(waiting)
        newest = self._places.newest.number
        if not everything and numbers and max(numbers) > newest:
            early = [n > newest for n in numbers]
            self._waiting[topic] = [m for m, e in zip(waiting, early, strict=True) if e]
            waiting = [m for m, e in zip(waiting, early, strict=True) if not e]
            numbers = [n for n, e in zip(numbers, early, strict=True) if not e]
        run = Run(waiting, [self._places.at(n) for n in numbers])
        for rows in alike([place.trial_time_ns is None for place in run.places]):
            self._write(topic, run.part(rows))

    def _write(self, topic: str, run: Run) -> None:
        """Write a run, all in a trial or all outside, as one batch."""
        first = run.messages[0]
        message, times = type(first.body), times_of(run.places)
        names = column_names(first.body, first.header)
        matrix = flat_rows([m.body for m in run.messages], [m.header.seq for m in run.messages])
        entity = f"topic/{topic}"
        if self._named.get(entity) != names:
            self._named[entity] = names
            self._emit(Rows(entity, "names", None, names))
        self._emit(Rows(entity, "scalars", times, matrix))
        self.rows[topic] = self.rows.get(topic, 0) + len(run.messages)
        self._write_state_timelines(message, names, matrix, times)
        converters = self.description.converters if self.description else UNIMATE_CONVERTERS
        for figure in figures(message, converters):
            values = figure_values(figure, names, matrix)
            if values is not None:
                self._emit(Rows(figure.entity, "scalars", times, values))
        self._write_rest(message, run, names, matrix, times)

    def _write_state_timelines(self, message: type, names: tuple[str, ...], matrix: Matrix, times: Times) -> None:
        in_trial = times.trial_ns is not None
        for timeline in state_timelines(message):
            if timeline.column not in names:
                continue
            column = matrix[:, names.index(timeline.column)]
            if timeline.column == "clamped":
                column = (column != 0).astype(np.float64)
            at = changes(column, self._timeline.get((timeline.entity, in_trial)))
            self._timeline = {
                k: v for k, v in self._timeline.items() if k[0] != timeline.entity
            }  # told again where the trial begins
            self._timeline[timeline.entity, in_trial] = float(column[-1])
            if len(at):
                self._emit(Rows(timeline.entity, "state", only(times, at), [timeline.text(column[i]) for i in at]))

    def _write_rest(self, message: type, run: Run, names: tuple[str, ...], matrix: Matrix, times: Times) -> None:
        of: Any = scene.machine(self.description)
        made: list[Rows] = []
        if message is Sample:
            made = scene.joint_rows(names, matrix, times, of)
        elif message is ControllerState:
            made = scene.tip_rows(names, matrix, times, of)
        elif message is GateEvent:
            told = [gate_event(m.body) for m in run.messages]
            made = [Rows("log/gate", "text", times, [(event.level, event.text) for event in told])]
        elif message is Command:
            made = [Rows(ANSWER_LATENCY, "scalars", times, _answer_ms(run))]
        for rows in made:
            self._emit(rows)


def _answer_ms(run: Run) -> Matrix:
    """From a sample's arrival at the recorder to its command's, in ms; NaN if the sample never came."""
    arrived = np.array([m.arrival_ns for m in run.messages], np.float64)
    sampled = np.array([place.arrival_ns or np.nan for place in run.places], np.float64)
    answered: Matrix = ((arrived - sampled) * MS)[:, None]
    return answered
