"""`hydrohil explain`: walk supervisor and gate by hand, one sample a step, or have one cause explained in words."""

import json
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer

from hydrohil.cli.options import CONFIDENCE, AsJson, app, console, errors, fail, printable
from hydrohil.shared.exit_status import EXIT_USAGE

if TYPE_CHECKING:
    from hydrohil.explanation.walk import Scene

_HELP = """  arm start stop estop reset recover release   the operator's events; an empty line is a sample without one
  break NAME ...   mend NAME ... | all         a rule, or gate.NAME: a condition of the gate
  set FACT ...     clear FACT ...              a fact: {facts}
  mode NAME        why NAME        show        names        quit"""


@app.command(rich_help_panel=CONFIDENCE)
def explain(
    cause: Annotated[str | None, typer.Argument(help="Explain this cause of a trip or a cut in words.")] = None,
    mode: Annotated[str | None, typer.Option(help="Mode to begin in.")] = None,
    broken: Annotated[str, typer.Option(help="Rules that do not hold, and gate.NAME; separated by commas.")] = "",
    facts: Annotated[str | None, typer.Option(help="Facts that are true; default: may_arm,can_recover,held.")] = None,
    event: Annotated[str, typer.Option(help="Events, a sample each; separated by commas.")] = "",
    as_json: AsJson = False,
) -> None:
    """Walk the mode machine: set facts, see what supervisor and gate decide. The code is that of a cell.

    Examples: `hydrohil explain`, `hydrohil explain FORCE_RAW`, `echo arm | hydrohil explain`,
    `hydrohil explain FORCE_RAW --json`, `hydrohil explain --mode RUNNING --broken FORCE_RAW,JOINT_LIMIT --event reset --json`
    """
    from hydrohil.shared.errors import UnknownNameError

    try:
        if cause is not None:
            return _show_cause(cause, as_json=as_json)
        if mode is None and not broken and facts is None and not event and not as_json:
            return _converse()
        scene = _scene(mode or "DISARMED", broken, facts, event)
    except UnknownNameError as error:
        raise fail(error, EXIT_USAGE) from None
    return _show(scene, as_json=as_json)


def _scene(mode: str, broken: str, facts: str | None, events: str) -> "Scene":
    """The scene that the options describe."""
    from hydrohil.explanation.names import find_event, find_fact, find_mode
    from hydrohil.explanation.walk import after, reached

    scene = _break(reached(find_mode(mode)), _listed(broken))
    if facts is not None:
        scene = scene._replace(facts=frozenset(find_fact(name) for name in _listed(facts)))
    for name in _listed(events):
        scene = after(scene, find_event(name))
    return scene


def _listed(text: str) -> list[str]:
    return text.replace(",", " ").split()


def _converse() -> None:
    """Obey lines until the end of the input; from a pipe, a line that cannot be read ends it."""
    from hydrohil.explanation.walk import Scene
    from hydrohil.shared.errors import UnknownNameError

    scene, interactive = Scene(), sys.stdin.isatty()
    if interactive:
        _show_help()
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
        except UnknownNameError as error:
            if not interactive:
                raise
            errors.print(printable(str(error)), style="red", markup=False)


def _show_help() -> None:
    from hydrohil.explanation.walk import FACTS

    console.print(_HELP.format(facts=" ".join(FACTS)), highlight=False, markup=False)


def _obey(scene: "Scene", words: list[str]) -> "Scene":
    """The scene after one line, shown."""
    from hydrohil.explanation.names import breakable_names, find_event, find_fact, find_mode
    from hydrohil.explanation.walk import after, reached

    verb, names = (words[0].lower(), words[1:]) if words else ("nothing", [])
    match verb:
        case "help" | "?":
            _show_help()
            return scene
        case "names":
            console.print(", ".join(breakable_names()), highlight=False, soft_wrap=True)
            return scene
        case "why":
            for name in names or [scene.cause.name]:
                _show_cause(name, as_json=False)
            return scene
        case "break":
            scene = _break(scene, names)
        case "mend":
            scene = _mend(scene, names)
        case "set":
            scene = scene._replace(facts=scene.facts | {find_fact(name) for name in names})
        case "clear":
            scene = scene._replace(facts=scene.facts - {find_fact(name) for name in names})
        case "mode":
            start = reached(find_mode(" ".join(names)))
            scene = start._replace(broken=scene.broken, facts=scene.facts, conditions=scene.conditions)
        case "show":
            pass
        case _:
            scene = after(scene, find_event(verb))
    _show(scene)
    return scene


def _break(scene: "Scene", names: Iterable[str]) -> "Scene":
    from hydrohil.explanation.names import find_breakable

    for name in names:
        found = find_breakable(name)
        scene = scene._replace(broken=scene.broken | found.rules, conditions=scene.conditions | found.conditions)
    return scene


def _mend(scene: "Scene", names: Iterable[str]) -> "Scene":
    from hydrohil.explanation.names import find_breakable

    for name in names:
        if name.lower() == "all":
            scene = scene._replace(broken=frozenset(), conditions=frozenset())
            continue
        found = find_breakable(name)
        scene = scene._replace(broken=scene.broken - found.rules, conditions=scene.conditions - found.conditions)
    return scene


def _show_cause(name: str, *, as_json: bool) -> None:
    """What must hold, the default limit and what to do, of each cause with this name."""
    from hydrohil.explanation.causes import explain as explanations
    from hydrohil.explanation.names import GATE

    found = explanations(name)
    if as_json:
        print(json.dumps([one._asdict() for one in found], indent=2))
        return
    for one in found:
        at_gate = one.by == "gate"
        what = "condition of the gate" if at_gate else "rule of the supervisor"
        what += f", limit by default {one.limit}" if one.limit else ""
        lines = [f"[bold]{GATE * at_gate}{one.cause}[/], {what}"]
        lines += [f"  must hold: {one.must_hold}", f"  to do:     {one.to_do}"] if one.must_hold else []
        console.print(*lines, sep="\n", highlight=False, soft_wrap=True)


def _show(scene: "Scene", *, as_json: bool = False) -> None:
    from hydrohil.explanation.names import GATE
    from hydrohil.explanation.walk import describe

    state = describe(scene)
    if as_json:
        print(json.dumps(state, indent=2))
        return
    gate = state["gate"]
    why = "" if state["cause"] == "NONE" else f" by {state['cause']}"
    current = "lets the command through" if gate["current"] else f"zero current: {gate['cause']}"
    console.print(f"[bold]{state['mode']}[/]{why}; gate {gate['state']}, {current}", highlight=False)
    broken = [*state["broken"], *(f"{GATE}{name}" for name in gate["broken"])]
    if broken:
        decides = "" if state["decides"] == "NONE" else f"; of the rules {state['decides']} decides"
        console.print(f"  does not hold: {', '.join(broken)}{decides}", highlight=False)
    console.print(f"  facts: {', '.join(name for name, true in state['facts'].items() if true) or 'none'}", highlight=False)
    for outcome in dict.fromkeys(state["events"].values()):
        events = ", ".join(event for event, then in state["events"].items() if then == outcome)
        console.print(f"  {outcome:<32} <- {events}", highlight=False, soft_wrap=True)
