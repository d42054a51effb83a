"""What a recording says of itself: counts of its messages, and the qualification of its host."""

from collections.abc import Mapping
from typing import Any

from hydrohil.services.recorder.link_counts import Link
from hydrohil.services.recorder.recording import Recording
from hydrohil.shared.host.qualified import Standing, plain
from hydrohil.shared.trips.gaps import Sequence


def recording_report(recording: Recording, counted: Mapping[Link, Sequence], rows: Mapping[str, int]) -> dict[str, Any]:
    """Files, rows and gaps of a recording; `rows` by topic."""
    gaps = {f"{link.topic} {link.sender}": sequence.missing for link, sequence in counted.items()}
    return {
        "path": str(recording.path),
        "rows": sum(rows.values()),
        "gaps": sum(gaps.values()),
        "bytes": recording.bytes,
        "files": [str(path) for path in recording.parts],
        "failure": recording.failure,
        "rows_by_topic": dict(rows),
        "gaps_by_topic": gaps,
        "unordered": sum(sequence.unordered for sequence in counted.values()),
    }


def counts_table(report: dict[str, Any]) -> str:
    """Rows and missing messages of each topic, in Markdown; of a `recording_report`."""
    rows: dict[str, int] = report["rows_by_topic"]
    gaps: dict[str, int] = report["gaps_by_topic"]
    lines = []
    for topic in sorted(rows):
        missing = sum(n for link, n in gaps.items() if link.split(" ")[0] == topic)
        lines.append(f"| {topic} | {rows[topic]} | {missing} |")
    verdict = "complete: no message is missing" if not report["gaps"] else f"**{report['gaps']} messages are missing**"
    return "\n".join(["## Recording", "", verdict, "", "| topic | rows | missing |", "|-|-:|-:|", *lines])


def properties(qualified: Standing) -> dict[str, object]:
    """A host's qualification as columns of a catalogue of trials; figures that were not measured are left out."""
    return {"words": qualified.words} | {name: value for name, value in (plain(qualified) or {}).items() if value is not None}
