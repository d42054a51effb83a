"""What an experiment sets, as the assignments that `--set` takes: only where it differs from the defaults."""

import json
from typing import Any

from hydrohil.experiment.experiment import Experiment, to_plain
from hydrohil.experiment.sections import Segment

SECTIONS = ("plant", "controller", "supervisor")
_DEFAULT = Experiment(name="default", alias="default", title="", source="", duration_s=1.0)


def differences(experiment: Experiment) -> tuple[str, ...]:
    """One line a field that differs from its default, then one a segment of the reference."""
    plain, default = to_plain(experiment), to_plain(_DEFAULT)
    lines = [f"duration_s = {experiment.duration_s:g}"]
    for section in SECTIONS:
        lines += _differing(section, plain[section], default[section])
    return (*lines, *(f"reference.{number} = {_inline(segment)}" for number, segment in enumerate(experiment.reference)))


def _differing(path: str, value: Any, default: Any) -> list[str]:
    if value == default:
        return []
    if isinstance(value, dict) and isinstance(default, dict):
        return [line for name in value for line in _differing(f"{path}.{name}", value[name], default.get(name))]
    return [f"{path} = {json.dumps(value)}"]


def _inline(segment: Segment) -> str:
    given = {name: value for name, value in segment._asdict().items() if value != Segment._field_defaults.get(name)}
    return "{ " + ", ".join(f"{name} = {json.dumps(value)}" for name, value in given.items()) + " }"
