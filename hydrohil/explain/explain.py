"""Supervisor and gate without a machine: flags in, verdict out, by the functions that decide in a cell.

One step is one sample: the first broken rule by the rules' own fold, the mode by `next_mode`, the gate by `gate_step`.
What is set here are the flags that a cell computes from samples; nothing that decides is written a second time.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from hydrohil.services.plant.config import GateLimits, PlantConfig
from hydrohil.services.plant.gate import CommandObservation, GateInput, GateMemory, PermitObservation, gate_step
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.modes import Event, Facts, next_mode
from hydrohil.services.supervisor.observe import Heard, Links, observe_step, watch_start
from hydrohil.services.supervisor.params import supervisor_params
from hydrohil.services.supervisor.rule import Limits, Observed, Rule
from hydrohil.services.supervisor.rules import RULES, fold
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import NO_TRIAL, GateCause, GateState, Mode, Sample, TripCause

LIMITS = GateLimits(slew_codes=GateLimits().tight_slew_codes)
ZERO = (ZERO_CODE, ZERO_CODE, ZERO_CODE)
FLAGS = tuple(name for name in Facts._fields if name != "broken")
_RUNS, _UNLOADS, _LOADS = (ZERO_CODE, ZERO_CODE + 12, ZERO_CODE), (ZERO_CODE, ZERO_CODE - 12, ZERO_CODE), (0, -1, 0)
_SUPERVISOR, _CONTROLLER, _AGE_NS = 1, 2, 4_000_000
_PERMITTED = (Mode.ARMED, Mode.RUNNING, Mode.RECOVER)


def _permit(**changes: Any) -> Callable[[GateInput, GateMemory], GateInput]:
    return lambda seen, _: seen._replace(permit=seen.permit._replace(**changes))


def _command(**changes: Any) -> Callable[[GateInput, GateMemory], GateInput]:
    return lambda seen, _: seen._replace(command=seen.command._replace(**changes))


def _too_far(seen: GateInput, gate: GateMemory) -> GateInput:
    step = LIMITS.slew_codes + 1
    codes = gate.codes[0], gate.codes[1] - step if seen.permit.mode == Mode.RECOVER else gate.codes[1] + step, gate.codes[2]
    return seen._replace(command=seen.command._replace(codes=codes))


CONDITIONS: dict[GateCause, Callable[[GateInput, GateMemory], GateInput]] = {  # what the gate sees when one of them is broken
    GateCause.NO_PERMIT: _permit(present=False),
    GateCause.NOT_RUNNING: lambda seen, _: seen._replace(tick=-1),
    GateCause.PERMIT_STALE: _permit(age_ns=LIMITS.permit_ttl_ns + 1),
    GateCause.NO_COMMAND: _command(present=False),
    GateCause.COMMAND_STALE: _command(age_ns=LIMITS.command_ttl_ns + 1),
    GateCause.OTHER_ARMING: lambda seen, _: seen._replace(command=seen.command._replace(arming_id=seen.command.arming_id + 1)),
    GateCause.EPOCH_CHANGED: _command(epoch=_CONTROLLER + 1),
    GateCause.IMPOSSIBLE_ECHO: _command(age_ns=-1),
    GateCause.OUT_OF_RANGE: _command(codes=(ZERO_CODE, LIMITS.max_code + 1, ZERO_CODE)),
    GateCause.BEYOND_SLEW: _too_far,
    GateCause.FORCE_INVALID: lambda seen, _: seen._replace(force_counts=LIMITS.max_force_counts),
    GateCause.FORCE_ABOVE_LIMIT: lambda seen, _: seen._replace(force_n=LIMITS.force_limit_n + 1.0),
    GateCause.NOT_UNLOADING: _command(codes=(ZERO_CODE, ZERO_CODE + 12, ZERO_CODE)),
    GateCause.ESTOP: lambda seen, _: seen._replace(estop=True),
    GateCause.OVERRUN: lambda seen, _: seen._replace(overrun=True),
    GateCause.LINK_FAULTS: lambda seen, _: seen._replace(link_faults=LIMITS.faults_per_s + 1),
    GateCause.TWO_PUBLISHERS: lambda seen, _: seen._replace(epoch_conflicts=LIMITS.faults_per_s + 1),
}


class Scene(NamedTuple):
    """Everything that the next step depends on."""

    mode: Mode = Mode.DISARMED
    broken: frozenset[TripCause] = frozenset()  # rules that do not hold
    flags: frozenset[str] = frozenset(("may_arm", "can_recover", "held"))  # facts that are true
    conditions: frozenset[GateCause] = frozenset()  # of the gate, that do not hold
    cause: TripCause = TripCause.NONE  # latched by the trip
    arming_id: int = 0
    arming_ids: int = 0  # drawn so far
    gate: GateMemory = GateMemory()
    pressed: bool = False  # an emergency stop that no reset has released


def _flagged(rule: Rule) -> Rule:
    """The row with a flag in place of its predicate."""
    cause = rule.cause
    return rule._replace(
        holds=lambda seen, _: cause not in seen,
        measured=lambda _, __: 0.0,
        limit=lambda _, __: 0.0,
    )


_first_broken: Any = fold(tuple(_flagged(rule) for rule in RULES))


def deciding(broken: frozenset[TripCause]) -> TripCause:
    """The cause that wins: of several broken rules the most severe."""
    return TripCause(_first_broken(broken, None)[0])


def broken_now(scene: Scene) -> frozenset[TripCause]:
    """The rules that do not hold, with the one that the supervisor reads from the gate's last state."""
    cut = scene.mode == Mode.RUNNING and scene.gate.state == GateState.REVOKED
    return scene.broken | {TripCause.GATE_CUT} if cut else scene.broken


def stopped(scene: Scene) -> bool:
    """Whether an emergency stop is pressed, at the gate or by the flag."""
    return "estop" in scene.flags or scene.gate.cause == GateCause.ESTOP


def mode_after(scene: Scene, event: Event) -> Mode:
    """Mode after one step with `event`."""
    facts: dict[str, Any] = {name: name in scene.flags for name in FLAGS} | {"estop": stopped(scene)}
    facts["can_recover"] = facts["can_recover"] and not scene.pressed
    return Mode(next_mode(int(scene.mode), int(event), Facts(broken=int(deciding(broken_now(scene))), **facts)))


def after(scene: Scene, event: Event) -> Scene:
    """One sample: the supervisor judges and issues a permit, the gate judges permit, command and force."""
    mode = mode_after(scene, event)
    arming_id, arming_ids = (scene.arming_id if mode in _PERMITTED else 0), scene.arming_ids
    if mode in (Mode.ARMED, Mode.RECOVER) and mode != scene.mode:
        arming_id = arming_ids = arming_ids + 1
    cause = scene.cause
    if mode == Mode.DISARMED:
        cause = TripCause.NONE
    elif mode == Mode.TRIPPED and scene.mode not in (Mode.TRIPPED, Mode.RECOVER):
        cause = TripCause.ESTOP if event == Event.ESTOP or stopped(scene) else deciding(broken_now(scene))
    pressed = event == Event.ESTOP or stopped(scene) or (scene.pressed and event != Event.RESET)
    changed = scene._replace(mode=mode, arming_id=arming_id, arming_ids=arming_ids, cause=cause, pressed=pressed)
    return changed._replace(gate=gate_step(scene.gate, LIMITS, gate_input(changed), True))


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


def gate_input(scene: Scene) -> GateInput:
    """Permit, command and force as the gate sees them, with the broken conditions in them."""
    recovers = scene.mode == Mode.RECOVER
    permit = PermitObservation(True, scene.arming_id, _SUPERVISOR, int(scene.mode), _AGE_NS, _LOADS if recovers else (0, 0, 0))
    command = CommandObservation(True, scene.arming_id, _CONTROLLER, _AGE_NS, 0, _UNLOADS if recovers else _RUNS)
    seen = GateInput(permit, command, 10, 13.5, 0, False, False, 0, 0)
    for cause in sorted(scene.conditions):
        seen = CONDITIONS[cause](seen, scene.gate)
    return seen


def told(scene: Scene) -> dict[str, Any]:
    """The scene for a reader: verdict, what each event would do now, gate."""
    return {
        "mode": scene.mode.name,
        "cause": scene.cause.name,
        "decides": deciding(broken_now(scene)).name,
        "broken": [cause.name for cause in sorted(broken_now(scene))],
        "facts": {name: name in scene.flags for name in FLAGS},
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


def limit_of(cause: TripCause) -> str:
    """What the row of `cause` says broken, with the limit that it has in a cell by default; "" for what is no row."""
    seen, limits = _at_rest()
    found = next((rule for rule in RULES if rule.cause == cause), None)
    if found is None:
        return ""
    has_unit = found.words.endswith(")")
    return f": {found.words}" + (f"; limit by default {found.limit(seen, limits):.4g}" if has_unit else "")


def _at_rest() -> tuple[Observed, Limits]:
    """A machine that stands level, and the default limits."""
    described = describe(PlantConfig(), LIMITS)
    params = supervisor_params(SupervisorConfig(), described, 0, 0)
    counts = tuple(round((0.0 - c.offset) / c.scale) for c in described.encoders)
    sample = Sample(1, 0, NO_TRIAL, 0, counts, 10, ZERO, 0, 0, 0, (0, 0, 0), 0, 0, 0)
    return observe_step(watch_start(), params.observing, sample, Heard(False, 0, True, Links(0, 0, 0, 1)))[1], params.limits
