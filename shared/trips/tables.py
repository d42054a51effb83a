"""Messages as columns of plain lists: the signals of a trip report, ready to be written as JSON."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.columns import column_names

Table = dict[str, list[Any]]  # one list a column, all of the same length
Tables = Mapping[str, Table]  # by topic

SAMPLE, GATE, GROUND_TRUTH = "plant/sample", "plant/gate", "plant/ground_truth"
COMMAND, STATE, PERMIT = "controller/command", "controller/state", "supervisor/permit"
STAMPS = (
    "arrival_ns",
    "seq",
    "epoch",
    "arming_id",
    "echo_number",
    "echo_time_ns",
)  # of the frame; arrival by the receiver's clock


def table(messages: Sequence[Received]) -> Table:
    """Columns of one topic's messages; one whose arrays have other lengths than the newest is left out."""
    if not messages:
        return {}
    names = (*STAMPS, *column_names(messages[-1].body))
    rows = [row for row in map(_row, messages) if len(row) == len(names)]
    return {name: list(column) for name, column in zip(names, zip(*rows, strict=True), strict=True)}


def tables(messages: Mapping[str, Iterable[Received]]) -> dict[str, Table]:
    """Columns of every topic that has any."""
    return {topic: table(kept) for topic, some in messages.items() if (kept := list(some))}


def _row(message: Received) -> tuple[Any, ...]:
    header = message.header
    row: list[Any] = [message.arrival_ns, header.seq, header.epoch, header.arming_id, header.echo_number, header.echo_time_ns]
    for value in message.body:
        if isinstance(value, tuple):
            row.extend(value)
        else:
            row.append(value)
    return tuple(row)


def row_of(table: Table, number: int, column: str = "number") -> int | None:
    """First row whose column says `number`; None if there is none."""
    try:
        return table[column].index(number)
    except (KeyError, ValueError):
        return None
