"""Parameters that change while a trial runs: which ones may, and how the command stays continuous. Pure.

Law and gains act at one sample; the links that have others take their integral from the current that the valve has
(`take_over` in `laws/table.py`). The numbers of the target impedance are ramped, mass and stiffness geometrically: the model's
position goes on from where it is, so that the set-point never steps. Meanwhile, and for `tight_samples` more, the tight slew
limit holds.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from hydrohil.services.controller.actuation import Handover
from hydrohil.services.controller.config import ControllerConfig
from hydrohil.services.controller.step import ControlMemory
from hydrohil.shared.contract.assignments import parsed, put
from hydrohil.shared.contract.envelope import checked
from hydrohil.shared.contract.link_units import plain_of, written_location
from hydrohil.shared.machine.description import LINKS
from hydrohil.shared.units import NS_PER_S

RAMP_S = 0.5  # longer than the loop takes to settle (0.2 s), shorter than an operator waits
_SECTION = "controller"
_LAW, _GAINS = "controller.law", "controller.gains."
GEOMETRIC = ("mass_kg", "stiffness_n_per_m")  # of the impedance: positive, and they span decades
LINEAR = ("damping_ratio",)  # may be 0
ADAPTED = ("onset_n", "ceiling_n", "softening_per_s", "retreat_m_per_s", "stop_n", "stop_ns_per_m", "release_s")  # linear, too
RAMPED = tuple(f"controller.impedance.{name}" for name in (*GEOMETRIC, *LINEAR)) + tuple(
    f"controller.adaptation.{name}" for name in ADAPTED
)
_LIMIT = "it is a limit, and limits stay what they were when the trial was armed"
_FORCE = "the force that the target feels would step"
_ESTIMATE = "the checks before the trial rest on this estimate"
FIXED = {  # every other parameter, and why it stays
    "controller.target": "it reads other channels of the reference",
    **{f"controller.acting.{link}": "the link would be seized or let go in the middle of its motion" for link in LINKS},
    "controller.impedance.damping": "it gives another meaning to damping_ratio: change that",
    "controller.impedance.environment_n_per_m": _ESTIMATE,
    "controller.impedance.setpoint_compensation": "the force set-point would step",
    "controller.impedance.formulation": "the two formulations do not share their state",
    "controller.impedance.force_filter": _FORCE,
    "controller.impedance.force_cutoff_hz": _FORCE,
    "controller.impedance.force_noise_n": _FORCE,
    "controller.impedance.apparent_stiffness_n_per_m": "the offset from the reference belongs to the old one",
    "controller.impedance.contact_n": "the offset from the reference belongs to the old one",
    "controller.adaptation.kind": "what one kind has given way means nothing to another",
    "controller.slew_codes": _LIMIT,
    "controller.tight_slew_codes": _LIMIT,
    "controller.tight_samples": _LIMIT,
    **{f"controller.recover_current_a.{link}": _LIMIT for link in LINKS},
}


class Difference(NamedTuple):
    """One value that is another."""

    path: str
    old: Any
    new: Any


class Change(NamedTuple):
    """From one configuration to another; both ends by number of sample."""

    first: int  # at which it begins to act
    last: int  # at which it acts in full: the first one, or the ramp's last
    before: ControllerConfig
    after: ControllerConfig


def leaves(value: Any, path: str = _SECTION) -> Iterator[tuple[str, Any]]:
    """Every value with its dotted path, as a user writes it."""
    if hasattr(value, "_fields"):
        for name, field in zip(value._fields, value, strict=True):
            yield from leaves(field, f"{path}.{name}")
    else:
        yield ".".join(map(str, written_location(path.split(".")))), value


def differences(before: ControllerConfig, after: ControllerConfig) -> tuple[Difference, ...]:
    """What differs, in the order of the fields."""
    both = zip(leaves(before), leaves(after), strict=True)
    return tuple(Difference(path, old, new) for (path, old), (_, new) in both if old != new)


def may_change(path: str) -> bool:
    """Whether a value may ever change while a trial runs: a closed choice, what is not named stays."""
    return path == _LAW or path.startswith(_GAINS) or path in RAMPED


def refusal(difference: Difference, config: ControllerConfig) -> str:
    """Why this may not change in a trial that has `config`, "" if it may."""
    path = difference.path
    if not may_change(path):
        return f"{path} stays while a trial runs: {FIXED[path]}; load it (`hydrohil run NAME --set`)"
    if path.startswith("controller.impedance.") and config.target not in ("impedance", "explicit"):
        return f"{path}: target {config.target!r} has no target impedance; nothing would change"
    if path.startswith("controller.adaptation.") and config.adaptation.kind == "none":
        return f"{path}: the target of this trial does not adapt; nothing would change"
    return ""


def assigned(config: ControllerConfig, assignments: Sequence[str]) -> ControllerConfig:
    """`config` with `path=value` assignments applied in order, all of which may change. Raises ValueError with one line."""
    plain = {_SECTION: plain_of(config)}
    for assignment in assignments:
        path, value = parsed(assignment)
        if path.split(".")[0] != _SECTION:
            raise ValueError(f"{path}: only [controller] may change while a trial runs; load it (`hydrohil run NAME --set`)")
        if path == _SECTION:
            raise ValueError(f"{path} is a section: name one of its values, such as controller.law=pi")
        put(plain, path, value)
    after: ControllerConfig = checked(plain[_SECTION], _SECTION, ControllerConfig)
    found = differences(config, after)
    if not found:
        raise ValueError(f"{', '.join(assignments) or 'no assignment'}: nothing would change")
    for difference in found:
        if why := refusal(difference, config):
            raise ValueError(why)
    return after


def begun(number: int, before: ControllerConfig, after: ControllerConfig, period_ns: int) -> Change:
    """The change that acts from sample `number` on."""
    ramped = (before.impedance, before.adaptation) != (after.impedance, after.adaptation)
    samples = max(1, round(RAMP_S * NS_PER_S / period_ns)) if ramped else 1
    return Change(number, number + samples - 1, before, after)


def handed_over(memory: ControlMemory, change: Change) -> ControlMemory:
    """The memory before the change's first sample: who takes over, and until when the command steps by the tight limit only."""
    before, after = change.before, change.after
    one, two, three = (int(before.law != after.law or old != new) for old, new in zip(before.gains, after.gains, strict=True))
    until = change.last + after.tight_samples if after.tight_samples else 0
    old = memory.handover
    links = (one | old.links[0], two | old.links[1], three | old.links[2])
    return memory._replace(handover=Handover(links, max(old.tight_until, until)))


def acting(change: Change, number: int) -> ControllerConfig:
    """What acts at this sample."""
    if number >= change.last:
        return change.after
    if number < change.first:
        return change.before
    return blended(change.before, change.after, (number - change.first + 1) / (change.last - change.first + 1))


def blended(before: ControllerConfig, after: ControllerConfig, share: float) -> ControllerConfig:
    """`after`, but of the way from one target impedance to the other only a share is gone."""

    def linear(old: Any, new: Any, names: Sequence[str]) -> dict[str, Any]:
        pairs = ((name, getattr(old, name), getattr(new, name)) for name in names)
        return {name: a + share * (b - a) if a != b else b for name, a, b in pairs}

    def geometric(a: float, b: float) -> float:
        return math.exp(math.log(a) + share * (math.log(b) - math.log(a))) if a != b else b

    old, new = before.impedance, after.impedance
    scaled: dict[str, Any] = {name: geometric(getattr(old, name), getattr(new, name)) for name in GEOMETRIC}
    impedance = new._replace(**scaled, **linear(old, new, LINEAR))
    adaptation = after.adaptation._replace(**linear(before.adaptation, after.adaptation, ADAPTED))
    return after._replace(impedance=impedance, adaptation=adaptation)
