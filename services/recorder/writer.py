"""Messages in, rows out: messages wait for their samples and for a full batch, rare ones become log lines and counters."""

from collections.abc import Callable, Sequence

from hydrohil.services.recorder.counter_rows import COUNT_ROWS, CounterRows
from hydrohil.services.recorder.rows import Rows, equal_runs, times_of
from hydrohil.services.recorder.sample_index import IndexedSample, SampleIndex, sample_numbers
from hydrohil.services.recorder.topic_rows import Batch, TopicRows
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import (
    FaultEvent,
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
    late_event,
    link_stats_event,
    parameter_event,
    permit_events,
)

BATCH_ROWS = 1024  # a batch is a chunk of the file, with about 1 kB around it and 2 kB of index in memory; `flush` comes earlier
# These become log lines or counters; the messages of every other topic are rows, for their arrays have fixed lengths.
WITHOUT_ROWS = (PlantDescription, LinkStats, FaultEvent, ParameterEvent)


class Writer:
    """Turns messages into rows for `emit`. Follows one plant at a time."""

    def __init__(self, emit: Callable[[Rows], None], batch_rows: int = BATCH_ROWS, count_rows: int = COUNT_ROWS) -> None:
        """No message waits, no plant is known."""
        self._emit, self._batch_rows = emit, batch_rows
        self._waiting: dict[str, list[Received]] = {}
        self._counters = CounterRows(emit, count_rows)
        self._topic_rows = TopicRows(emit)
        self._counts: dict[tuple[str, str], InboxCounts] = {}  # receiver and topic: its last counts
        self._samples = SampleIndex()
        self._plant_epoch: int | None = None
        self._late = 0  # answers in a row that were late or missing, in a trial
        self.description: PlantDescription | None = None
        self.rows: dict[str, int] = {}
        self.begin_recording()

    def begin_recording(self) -> None:
        """Write all messages that wait; then modes, names and states are written again."""
        self.flush(everything=True)
        self._permit: Permit | None = None
        self._arming_id = 0
        self.rows = {}
        self.begin_file()

    def begin_file(self) -> None:
        """Write again, with the next rows, what a reader of this file alone must know."""
        self._topic_rows.begin_file()
        if self.description is not None:
            self._describe(self.description)

    def take(self, *messages: Received) -> None:
        """Messages of one topic."""
        topic, kind = messages[0].topic, type(messages[0].body)
        if kind in WITHOUT_ROWS:
            self.rows[topic] = self.rows.get(topic, 0) + len(messages)
            for message in messages:
                self._take_rare(message)
            return
        if kind is Sample:
            for message in messages:  # one by one: where another plant begins, all waiting messages are written first
                self._take_sample(message)
                self._wait(topic, (message,))
            return
        if kind is Permit:
            for message in messages:
                self._log_permit(message)
        self._wait(topic, messages)

    def flush(self, everything: bool = False) -> None:
        """Write all waiting messages; those whose sample has not come yet go on waiting unless `everything`."""
        for topic in list(self._waiting):
            self._flush_topic(topic, everything)
        if everything:
            self._counters.flush()

    def log(self, event: Event, sample: IndexedSample | None = None) -> None:
        """Write a line to the event log, at the newest sample unless another is given."""
        sample = self._samples.newest if sample is None else sample
        self._emit(Rows(f"log/{event.source}", "text", times_of([sample]), [(event.level, event.text)]))

    def scalar(self, entity: str, value: float) -> None:
        """Write one number at the newest sample."""
        self._counters.add(entity, self._samples.newest, (value,))

    def _wait(self, topic: str, messages: Sequence[Received]) -> None:
        """Wait until a batch is full. Messages that are ahead of their sample are examined once a batch."""
        waiting = self._waiting.setdefault(topic, [])
        batches = len(waiting) // self._batch_rows
        waiting.extend(messages)
        if len(waiting) // self._batch_rows > batches:
            self._flush_topic(topic, everything=len(waiting) >= 2 * self._batch_rows)

    def _flush_topic(self, topic: str, everything: bool) -> None:
        waiting = self._waiting.pop(topic, [])
        numbers = sample_numbers(waiting)
        newest = self._samples.newest.number
        if not everything and numbers and max(numbers) > newest:
            early = [n > newest for n in numbers]
            self._waiting[topic] = [m for m, e in zip(waiting, early, strict=True) if e]
            waiting = [m for m, e in zip(waiting, early, strict=True) if not e]
            numbers = [n for n, e in zip(numbers, early, strict=True) if not e]
        batch = Batch(waiting, [self._samples.at(n) for n in numbers])
        for run in equal_runs([sample.trial_time_ns is None for sample in batch.samples]):
            rows = batch.rows(run)
            self._topic_rows.write(topic, rows, self.description)
            self.rows[topic] = self.rows.get(topic, 0) + len(rows.messages)

    def _take_sample(self, message: Received) -> None:
        body = message.body
        self._follow_plant(message.header.epoch)
        sample = self._samples.add(body, message.arrival_ns)
        self._late = 0 if body.tick <= 0 or answered_in_time(body) else self._late + 1
        event = late_event(self._late, body.number)
        if event is not None:
            self.log(event, sample)

    def _follow_plant(self, epoch: int) -> None:
        if self._plant_epoch is not None and epoch != self._plant_epoch:
            self.flush(everything=True)
            self._samples.clear()  # another plant numbers its samples from its own start
        self._plant_epoch = epoch

    def _take_rare(self, message: Received) -> None:
        """A message that becomes log lines or counters."""
        body = message.body
        if isinstance(body, LinkStats):
            self._write_link_stats(message)
        elif isinstance(body, FaultEvent):
            self.log(fault_event(body, message.header.sender), self._samples.at(body.number))
        elif isinstance(body, ParameterEvent):
            self.log(parameter_event(body), self._samples.at(body.number))
        elif body != self.description:  # the plant repeats it for services that join late
            self.description = body
            self._describe(body)

    def _log_permit(self, message: Received) -> None:
        sample = self._samples.at(message.header.echo_number)
        for event in permit_events(self._permit, message.body):
            self.log(event, sample)
        if message.header.arming_id != self._arming_id and message.header.arming_id:
            self.log(Event("supervisor", "INFO", f"arming id {message.header.arming_id}"), sample)
        self._permit, self._arming_id = message.body, message.header.arming_id

    def _write_link_stats(self, message: Received) -> None:
        """The counts of each inbox as one row, and a line where one grew that should not."""
        sample = self._samples.at(message.header.echo_number)
        receiver = message.header.sender
        for now in message.body.inboxes:
            entity = f"link_stats/{receiver}/{now.topic}"
            self._topic_rows.name_columns(entity, COUNT_NAMES)
            self._counters.add(entity, sample, now[1:])
            event = link_stats_event(receiver, self._counts.get((receiver, now.topic)), now)
            self._counts[receiver, now.topic] = now
            if event is not None:
                self.log(event, sample)

    def _describe(self, description: PlantDescription) -> None:
        self._emit(Rows("machine", "document", None, machine_document(description)))


def machine_document(description: PlantDescription) -> str:
    """The plant's description in Markdown."""
    machine = description.machine
    values = description._asdict() | {"machine": machine.name, "machine_hash": description.machine_hash.hex()}
    lines = "\n".join(f"| {field} | {value} |" for field, value in values.items())
    channels = [*machine.encoders, machine.force, *machine.converters]
    table = "\n".join(f"| {c.name} | {c.scale:g} {c.unit} | {c.offset:g} | {c.bits} | {c.low} .. {c.high} |" for c in channels)
    tables = f"| | |\n|-|-|\n{lines}", f"| channel | per count | offset | bits | counts |\n|-|-|-|-|-|\n{table}"
    return "\n\n".join((f"## {machine.title}", *tables))
