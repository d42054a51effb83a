"""Causes, conditions, events, modes and facts by the names that people type."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import NamedTuple, TypeVar

from hydrohil.explanation.conditions import CONDITIONS
from hydrohil.explanation.walk import FACTS
from hydrohil.services.supervisor.modes import Event
from hydrohil.services.supervisor.rules import RULES
from hydrohil.shared.contract.messages import GateCause, Mode, TripCause
from hydrohil.shared.errors import UnknownNameError

GATE = "gate."  # before the name of a condition of the gate, where the supervisor may have a rule of the same name
Value = TypeVar("Value")


class Breakable(NamedTuple):
    """What one name breaks: a rule of the supervisor or a condition of the gate; the other set is empty."""

    rules: frozenset[TripCause]
    conditions: frozenset[GateCause]


def find(name: str, known: Mapping[str, Value], what: str) -> Value:
    """The value of a name, whatever its case and dashes. Raises UnknownNameError."""
    plain = {_plain(known_name): value for known_name, value in known.items()}
    if _plain(name) in plain:
        return plain[_plain(name)]
    nearest = get_close_matches(_plain(name), plain, 3, 0.5)
    offered = [known_name for known_name in known if _plain(known_name) in nearest] or list(known)
    hint = "did you mean" if nearest else "expected one of"
    raise UnknownNameError(f"{what} {name!r} is unknown: {hint} {', '.join(offered)}")


def _plain(name: str) -> str:
    return name.lower().replace("-", "_")


def find_breakable(name: str) -> Breakable:
    """The rule of that name, or after `gate.` the condition. Raises UnknownNameError."""
    known = {rule.cause.name: Breakable(frozenset([rule.cause]), frozenset()) for rule in RULES}
    known |= {f"{GATE}{cause.name}": Breakable(frozenset(), frozenset([cause])) for cause in CONDITIONS}
    return find(name, known, "rule or condition")


def breakable_names() -> list[str]:
    """Every name that `find_breakable` knows: rules, most severe first, then the gate's conditions."""
    return [rule.cause.name for rule in RULES] + [f"{GATE}{cause.name}" for cause in CONDITIONS]


def find_cause(name: str) -> tuple[TripCause | None, GateCause | None]:
    """Cause of a trip and cause of a cut of this name; `gate.NAME` is of a cut alone. Raises UnknownNameError."""
    of_gate = name.lower().startswith(GATE)
    trips = {} if of_gate else {cause.name: cause for cause in TripCause if cause}
    cuts = {cause.name: cause for cause in GateCause if cause}
    names = {known: known for known in cuts | trips}
    found = find(name[len(GATE) :] if of_gate else name, names, "cause")
    return trips.get(found), cuts.get(found)


def find_event(name: str) -> Event:
    """The operator's event. Raises UnknownNameError."""
    return find(name, {event.name.lower(): event for event in Event} | {"recover": Event.HOLD_RECOVER}, "event")


def find_mode(name: str) -> Mode:
    """The mode. Raises UnknownNameError."""
    return find(name, {mode.name: mode for mode in Mode}, "mode")


def find_fact(name: str) -> str:
    """The fact, as the mode machine calls it. Raises UnknownNameError."""
    return find(name, {fact: fact for fact in FACTS}, "fact")
