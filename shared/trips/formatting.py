"""A trip report for people: lines for a terminal, Markdown for a recording."""

from hydrohil.shared.trips.report import Document

_MS = 1e3


def lines(document: Document) -> list[str]:
    """The sentence, the rule, what to do, ages and counters."""
    found = [document["sentence"]]
    if document["must_hold"]:
        found.append(f"rule: {document['cause']} of the {document['by']}: {document['must_hold']}")
    if document["to_do"]:
        found.append(f"to do: {document['to_do']}")
    found += document.get("changed", [])
    found += ["ages at the trip:"] if document["ages"] else []
    found += [f"  {hop['age_s'] * _MS:9.3f} ms  {hop['hop']}, on {hop['clock']} clock" for hop in document["ages"]]
    counted = _counted(document)
    return found + (["counted since each start:"] if counted else []) + [f"  {line}" for line in counted]


def markdown(document: Document) -> str:
    """The same as a document of a recording."""
    ages = "\n".join(f"| {hop['hop']} | {hop['age_s'] * _MS:.3f} | {hop['clock']} |" for hop in document["ages"])
    counted = "\n".join(f"* {line}" for line in _counted(document))
    parts = [
        f"## Trip: {document['cause']}",
        document["sentence"],
        f"Must hold: {document['must_hold']}. To do: {document['to_do']}." if document["must_hold"] else "",
        "\n".join(f"* {line}" for line in document.get("changed", [])),
        f"| hop | age in ms | on whose clock |\n|-|-:|-|\n{ages}" if ages else "",
        counted,
    ]
    return "\n\n".join(part for part in parts if part)


def _counted(document: Document) -> list[str]:
    """One line a receiver and topic with anything but accepted messages."""
    found = []
    for receiver, topics in document["counters"].items():
        for topic, counts in topics.items():
            named = [f"{count} {name.replace('_', ' ')}" for name, count in counts.items() if count and name != "accepted"]
            if named:
                found.append(f"{receiver} of {topic}: {', '.join(named)}")
    return found or (["nothing lost, nothing discarded"] if document["counters"] else [])
