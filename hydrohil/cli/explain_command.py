"""`hydrohil explain`: walk supervisor and gate by hand, one sample a step, or have one cause told in words."""

import json
import sys
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Annotated, Any

import typer

from hydrohil.cli.options import AsJson, app, console, errors, fail
from hydrohil.shared.exit_status import EXIT_USAGE

_GATE = "gate."
_HELP = """  arm start stop estop reset recover release   the operator's events; an empty line is a sample without one
  break NAME ...   mend NAME ... | all         a rule, or gate.NAME: a condition of the gate
  set FLAG ...     clear FLAG ...              a fact: {flags}
  mode NAME        why NAME        show        names        quit"""


class UnknownError(Exception):
    """A word that means nothing here; the message names the nearest."""


@app.command()
def explain(
    cause: Annotated[str | None, typer.Argument(help="Tell this cause of a trip or a cut in words.")] = None,
    mode: Annotated[str | None, typer.Option(help="Mode to begin in.")] = None,
    broken: Annotated[str, typer.Option(help="Rules that do not hold, and gate.NAME; separated by commas.")] = "",
    facts: Annotated[str | None, typer.Option(help="Facts that are true; default: may_arm,can_recover,held.")] = None,
    event: Annotated[str, typer.Option(help="Events, a sample each; separated by commas.")] = "",
    as_json: AsJson = False,
) -> None:
    """Walk the mode machine: set flags, see what supervisor and gate decide. The code is that of a cell.

    Examples: `hydrohil explain`, `hydrohil explain FORCE_RAW`, `echo arm | hydrohil explain`,
    `hydrohil explain FORCE_RAW --json`, `hydrohil explain --mode RUNNING --broken FORCE_RAW,JOINT_LIMIT --event reset --json`
    """
    try:
        if cause is not None and as_json:
            return print(json.dumps(_told_of(cause), indent=2))
        if cause is not None:
            return console.print(*_words_of(cause), sep="\n", highlight=False, soft_wrap=True)
        if mode is None and not broken and facts is None and not event and not as_json:
            return _converse()
        scene = _asked(mode or "DISARMED", broken, facts, event)
    except UnknownError as error:
        raise fail(error, EXIT_USAGE) from None
    return _show(scene, as_json=as_json)


def _asked(mode: str, broken: str, facts: str | None, events: str) -> Any:
    """The scene that the options describe."""
    from hydrohil.explain.explain import after, reached

    scene = _broken(reached(_mode(mode)), _listed(broken))
    if facts is not None:
        scene = scene._replace(flags=frozenset(_flag(name) for name in _listed(facts)))
    for name in _listed(events):
        scene = after(scene, _event(name))
    return scene


def _listed(text: str) -> list[str]:
    return text.replace(",", " ").split()


def _converse() -> None:
    """Lines until the end of the input; from a pipe, a line that means nothing ends it."""
    from hydrohil.explain.explain import FLAGS, Scene

    scene, interactive = Scene(), sys.stdin.isatty()
    if interactive:
        console.print(_HELP.format(flags=" ".join(FLAGS)), highlight=False, markup=False)
        _show(scene)
    while True:
        try:
            line = input("> " if interactive else "")
        except (EOFError, KeyboardInterrupt):
            return console.print() if interactive else None
        words = line.split("#")[0].split()
        if words[:1] in (["quit"], ["exit"]):
            return None
        try:
            scene = _obey(scene, words)
        except UnknownError as error:
            if not interactive:
                raise
            errors.print(str(error), style="red")


def _obey(scene: Any, words: list[str]) -> Any:
    """The scene after one line, shown."""
    from hydrohil.explain.explain import FLAGS, after, reached

    verb, names = (words[0].lower(), words[1:]) if words else ("nothing", [])
    match verb:
        case "help" | "?":
            console.print(_HELP.format(flags=" ".join(FLAGS)), highlight=False, markup=False)
            return scene
        case "names":
            console.print(", ".join(_every_name()), highlight=False, soft_wrap=True)
            return scene
        case "why":
            for name in names or [_cause_in(scene)]:
                console.print(*_words_of(name), sep="\n", highlight=False, soft_wrap=True)
            return scene
        case "break":
            scene = _broken(scene, names)
        case "mend":
            scene = _mended(scene, names)
        case "set":
            scene = scene._replace(flags=scene.flags | {_flag(name) for name in names})
        case "clear":
            scene = scene._replace(flags=scene.flags - {_flag(name) for name in names})
        case "mode":
            kept = {"broken": scene.broken, "flags": scene.flags, "conditions": scene.conditions}
            scene = reached(_mode(" ".join(names)))._replace(**kept)
        case "show":
            pass
        case _:
            scene = after(scene, _event(verb))
    _show(scene)
    return scene


def _cause_in(scene: Any) -> str:
    return str(scene.cause.name)


def _broken(scene: Any, names: Iterable[str]) -> Any:
    for name in names:
        rule, condition = _rule_or_condition(name)
        scene = scene._replace(broken=scene.broken | rule, conditions=scene.conditions | condition)
    return scene


def _mended(scene: Any, names: Iterable[str]) -> Any:
    for name in names:
        if name.lower() == "all":
            scene = scene._replace(broken=frozenset(), conditions=frozenset())
            continue
        rule, condition = _rule_or_condition(name)
        scene = scene._replace(broken=scene.broken - rule, conditions=scene.conditions - condition)
    return scene


def _rule_or_condition(name: str) -> tuple[frozenset[Any], frozenset[Any]]:
    """One of them is named, the other set is empty."""
    from hydrohil.explain.explain import CONDITIONS
    from hydrohil.services.supervisor.rules import RULES

    rules = {rule.cause.name: rule.cause for rule in RULES}
    known = rules | {f"{_GATE}{cause.name}": cause for cause in CONDITIONS}
    found = _one_of(name, known, "rule or condition")
    return (frozenset(), frozenset([found])) if name.lower().startswith(_GATE) else (frozenset([found]), frozenset())


def _event(name: str) -> Any:
    from hydrohil.services.supervisor.modes import Event

    events = {event.name.lower(): event for event in Event}
    return _one_of(name, events | {"recover": Event.HOLD_RECOVER}, "event")


def _mode(name: str) -> Any:
    from hydrohil.shared.contract.messages import Mode

    return _one_of(name, {mode.name: mode for mode in Mode}, "mode")


def _flag(name: str) -> str:
    from hydrohil.explain.explain import FLAGS

    return str(_one_of(name, {flag: flag for flag in FLAGS}, "fact"))


def _one_of(name: str, known: dict[str, Any], what: str) -> Any:
    """The value of a name, whatever its case and dashes; UnknownError names the nearest."""
    plain = {_plain(known_name): value for known_name, value in known.items()}
    if _plain(name) in plain:
        return plain[_plain(name)]
    nearest = get_close_matches(_plain(name), plain, 3, 0.5)
    written = [known_name for known_name in known if _plain(known_name) in nearest] or list(known)
    raise UnknownError(f"{what} {name!r} is unknown: {'did you mean' if nearest else 'expected one of'} {', '.join(written)}")


def _plain(name: str) -> str:
    return name.lower().replace("-", "_")


def _every_name() -> list[str]:
    from hydrohil.explain.explain import CONDITIONS
    from hydrohil.services.supervisor.rules import RULES

    return [rule.cause.name for rule in RULES] + [f"{_GATE}{cause.name}" for cause in CONDITIONS]


def _words_of(name: str) -> list[str]:
    """What must hold, the default limit and what to do, of each cause with this name."""
    lines = []
    for told in _told_of(name):
        at_gate = told["by"] == "gate"
        of = "condition of the gate" if at_gate else f"rule of the supervisor{told['limit']}"
        lines.append(f"[bold]{_GATE * at_gate}{told['cause']}[/], {of}")
        lines += [f"  must hold: {told['must_hold']}", f"  to do:     {told['to_do']}"] if told["must_hold"] else []
    return lines


def _told_of(name: str) -> list[dict[str, str]]:
    """Each cause with this name: the supervisor's rule, the gate's condition, or both."""
    from hydrohil.explain.explain import limit_of
    from hydrohil.shared.contract.messages import GateCause, TripCause
    from hydrohil.shared.trips.causes import CUTS, TRIPS

    of_gate = name.lower().startswith(_GATE)
    trips = {} if of_gate else {cause.name: cause for cause in TripCause if cause}
    cuts = {cause.name: cause for cause in GateCause if cause}
    found = _one_of(name[len(_GATE) :] if of_gate else name, cuts | trips, "cause").name
    told = []
    if found in trips:
        told.append(_told("supervisor", found, limit_of(trips[found]), TRIPS.get(trips[found])))
    if found in cuts:
        told.append(_told("gate", found, "", CUTS.get(cuts[found])))
    return told


def _told(by: str, cause: str, limit: str, row: Any) -> dict[str, str]:
    holds, remedy = ("", "") if row is None else (row.holds, row.remedy)
    return {"cause": cause, "by": by, "limit": limit, "must_hold": holds, "to_do": remedy}


def _show(scene: Any, *, as_json: bool = False) -> None:
    from hydrohil.explain.explain import told

    seen = told(scene)
    if as_json:
        print(json.dumps(seen, indent=2))
        return
    gate = seen["gate"]
    why = "" if seen["cause"] == "NONE" else f" by {seen['cause']}"
    current = "lets the command through" if gate["current"] else f"zero current: {gate['cause']}"
    console.print(f"[bold]{seen['mode']}[/]{why}; gate {gate['state']}, {current}", highlight=False)
    broken = [*seen["broken"], *(f"{_GATE}{name}" for name in gate["broken"])]
    if broken:
        decides = "" if seen["decides"] == "NONE" else f"; of the rules {seen['decides']} decides"
        console.print(f"  does not hold: {', '.join(broken)}{decides}", highlight=False)
    console.print(f"  facts: {', '.join(name for name, true in seen['facts'].items() if true) or 'none'}", highlight=False)
    for outcome in dict.fromkeys(seen["events"].values()):
        events = ", ".join(event for event, then in seen["events"].items() if then == outcome)
        console.print(f"  {outcome:<32} <- {events}", highlight=False, soft_wrap=True)
