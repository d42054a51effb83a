"""Supervisor and gate without a machine: facts and broken rules in, verdict out, by the functions that decide in a cell.

One step is one sample: the first broken rule by the rules' own fold, the mode by `next_mode`, the gate by `gate_step`.
Only the facts that a cell computes from its samples are set here; no decision is written a second time.
"""

from typing import Any, NamedTuple

from hydrohil.explanation.conditions import LIMITS, ZERO, gate_input
from hydrohil.services.plant.gate import GateMemory, gate_step
from hydrohil.services.supervisor.modes import Event, Facts, next_mode
from hydrohil.services.supervisor.rule import Rule
from hydrohil.services.supervisor.rules import RULES, fold
from hydrohil.shared.contract.messages import GateCause, GateState, Mode, TripCause

FACTS = tuple(name for name in Facts._fields if name != "broken")
_PERMITTED = (Mode.ARMED, Mode.RUNNING, Mode.RECOVER)


class Scene(NamedTuple):
    """Everything that the next step depends on."""

    mode: Mode = Mode.DISARMED
    broken: frozenset[TripCause] = frozenset()  # rules that do not hold
    facts: frozenset[str] = frozenset(("may_arm", "can_recover", "held"))  # those that are true
    conditions: frozenset[GateCause] = frozenset()  # of the gate, that do not hold
    cause: TripCause = TripCause.NONE  # latched by the trip
    arming_id: int = 0
    arming_ids: int = 0  # drawn so far
    gate: GateMemory = GateMemory()
    pressed: bool = False  # an emergency stop that no reset has released


def _by_name(rule: Rule) -> Rule:
    """The row with a predicate that asks whether its cause is among the broken ones."""
    cause = rule.cause
    return rule._replace(
        holds=lambda broken, _: cause not in broken,
        measured=lambda _, __: 0.0,
        limit=lambda _, __: 0.0,
    )


_first_broken: Any = fold(tuple(_by_name(rule) for rule in RULES))


def deciding(broken: frozenset[TripCause]) -> TripCause:
    """The cause that wins: of several broken rules the most severe."""
    return TripCause(_first_broken(broken, None)[0])


def broken_now(scene: Scene) -> frozenset[TripCause]:
    """The rules that do not hold, with the one that the supervisor reads from the gate's last state."""
    cut = scene.mode == Mode.RUNNING and scene.gate.state == GateState.REVOKED
    return scene.broken | {TripCause.GATE_CUT} if cut else scene.broken


def stopped(scene: Scene) -> bool:
    """Whether an emergency stop is pressed, at the gate or by the fact."""
    return "estop" in scene.facts or scene.gate.cause == GateCause.ESTOP


def mode_after(scene: Scene, event: Event) -> Mode:
    """Mode after one step with `event`."""
    facts: dict[str, Any] = {name: name in scene.facts for name in FACTS} | {"estop": stopped(scene)}
    facts["can_recover"] = facts["can_recover"] and not scene.pressed
    return Mode(next_mode(int(scene.mode), int(event), Facts(broken=int(deciding(broken_now(scene))), **facts)))


def after(scene: Scene, event: Event) -> Scene:
    """One sample: the supervisor judges and issues a permit, the gate judges permit, command and force."""
    mode = mode_after(scene, event)
    arming_id, arming_ids = (scene.arming_id if mode in _PERMITTED else 0), scene.arming_ids
    if mode in (Mode.ARMED, Mode.RECOVER) and mode != scene.mode:
        arming_id = arming_ids = arming_ids + 1
    pressed = event == Event.ESTOP or stopped(scene) or (scene.pressed and event != Event.RESET)
    given = gate_input(mode, arming_id, scene.gate, scene.conditions)
    return scene._replace(
        mode=mode,
        arming_id=arming_id,
        arming_ids=arming_ids,
        cause=_cause_after(scene, event, mode),
        pressed=pressed,
        gate=gate_step(scene.gate, LIMITS, given, True),
    )


def _cause_after(scene: Scene, event: Event, mode: Mode) -> TripCause:
    """A trip latches the cause that decides; only `DISARMED` forgets it."""
    if mode == Mode.DISARMED:
        return TripCause.NONE
    if mode == Mode.TRIPPED and scene.mode not in (Mode.TRIPPED, Mode.RECOVER):
        return TripCause.ESTOP if event == Event.ESTOP or stopped(scene) else deciding(broken_now(scene))
    return scene.cause


_WAYS: dict[Mode, tuple[Event | TripCause, ...]] = {
    Mode.DISARMED: (),
    Mode.ARMED: (Event.ARM,),
    Mode.RUNNING: (Event.ARM, Event.START),
    Mode.TRIPPED: (Event.ARM, Event.START, TripCause.FORCE_TARED),
    Mode.RECOVER: (Event.ARM, Event.START, TripCause.FORCE_TARED, Event.HOLD_RECOVER),
}


def reached(mode: Mode) -> Scene:
    """The scene in `mode` after the events, or the rule that breaks for a sample, that lead there from the start."""
    scene = Scene()
    for step in _WAYS[mode]:
        if isinstance(step, Event):
            scene = after(scene, step)
        else:
            scene = after(scene._replace(broken=frozenset([step])), Event.NOTHING)._replace(broken=frozenset())
    return scene


def describe(scene: Scene) -> dict[str, Any]:
    """The scene as JSON has it: mode, cause, broken rules and which of them decides, gate, the outcome of each event."""
    return {
        "mode": scene.mode.name,
        "cause": scene.cause.name,
        "decides": deciding(broken_now(scene)).name,
        "broken": [cause.name for cause in sorted(broken_now(scene))],
        "facts": {name: name in scene.facts for name in FACTS},
        "arming_id": scene.arming_id,
        "gate": {
            "state": GateState(scene.gate.state).name,
            "cause": GateCause(scene.gate.cause).name,
            "broken": [cause.name for cause in sorted(scene.conditions)],
            "current": scene.gate.codes != ZERO,
        },
        "events": {event.name.lower(): _outcome(scene, event) for event in Event},
    }


def _outcome(scene: Scene, event: Event) -> str:
    then = after(scene, event)
    gate = GateState(then.gate.state).name.lower()
    why = "" if then.gate.codes != ZERO else f" ({GateCause(then.gate.cause).name.lower().replace('_', ' ')})"
    return f"{then.mode.name}, gate {gate}{why}"
