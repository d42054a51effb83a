"""An experiment as data: composed of the sections that the services define, read from and written to TOML and bytes."""

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from numbers import Integral
from typing import Annotated, Any, NamedTuple

import tomli_w
from annotated_types import Interval
from pydantic import ConfigDict, StringConstraints, TypeAdapter, ValidationError

from hydrohil.claims.claims import Claim, problems
from hydrohil.experiment.errors import ExperimentError, from_validation
from hydrohil.experiment.fault_lines import fault_of
from hydrohil.experiment.plain_data import DEEPEST, too_deep, unprintable
from hydrohil.experiment.unusual import unusual
from hydrohil.services.controller.checks import check
from hydrohil.services.controller.config import Changes, ControllerConfig, Reference
from hydrohil.services.controller.contact_environment import ContactEnvironment, contact_environment
from hydrohil.services.controller.parameter_schedule import scheduled
from hydrohil.services.controller.preflight import preflight
from hydrohil.services.plant.config import GateLimits, PlantConfig, latch_substeps, trial_ticks
from hydrohil.services.plant.params import contact_params
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.shared.contract.assignments import put
from hydrohil.shared.contract.configured_machine import geometry
from hydrohil.shared.contract.faults import Fault, trial_problems
from hydrohil.shared.contract.link_units import as_fields, plain_of
from hydrohil.shared.units import SUBSTEP_NS

Name = Annotated[str, StringConstraints(pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$")]
MAX_DURATION_S = 3600.0
SEEDS = 1 << 64
_FREELY_CHOSEN = ("plant.environment.", "controller.impedance.mass_kg")


class Experiment(NamedTuple):
    """What a trial is: each section is validated by the types of the service that reads it.

    An experiment is never changed: `with_values`, `with_faults` and `_replace` give another one. One that is written in
    Python is validated by `simulate`, by a cell, or by `validate`.
    """

    name: Name
    alias: Name
    title: str
    source: str  # where the experiment comes from
    duration_s: Annotated[float, Interval(gt=0.0, le=MAX_DURATION_S)]  # of the reference, after the bias is taken
    plant: PlantConfig = PlantConfig()
    controller: ControllerConfig = ControllerConfig()
    supervisor: SupervisorConfig = SupervisorConfig()
    reference: Reference = ()
    faults: tuple[Fault, ...] = ()  # what breaks on purpose, and when
    changes: Changes = ()  # of the controller's parameters while the trial runs
    claims: tuple[Claim, ...] = ()

    def with_values(self, values: Mapping[str, Any], *, where: str = "with_values") -> "Experiment":
        """Another experiment with these values, by dotted path: `{"controller.law": "pi", "plant.machine.supply_pa": 9e6}`.

        Paths, units and bounds are those of `hydrohil run --set`; an element of a list is named by its index or, in a list of
        three, by its link. Raises ExperimentError, a line for each path or value that cannot be; `where` names the origin in it.
        """
        if not isinstance(values, Mapping) or not all(isinstance(path, str) for path in values):
            raise ExperimentError([f'{where}: expected a dict of values by their paths, such as {{"controller.law": "pi"}}'])
        return assigned(self, values.items(), where)

    def with_faults(self, *faults: Fault | str, where: str = "with_faults") -> "Experiment":
        """Another experiment with these faults after its own: each a `Fault`, or a line as `hydrohil run --inject` takes it.

        A line is `KIND TARGET [value=V] [at=SECONDS] [for=SECONDS]`, such as `stuck force at=1.0 for=0.5`; times are those of
        the trial. Raises ExperimentError; `where` names the origin in it.
        """
        added = tuple(fault_of(fault, where) if isinstance(fault, str) else fault for fault in faults)
        return from_plain(to_plain(self._replace(faults=self.faults + added)), where) if added else self

    def to_toml(self) -> str:
        """The experiment as TOML with every default spelled out; `load` reads it back."""
        return to_toml(self)


to_plain = plain_of
_ADAPTER: TypeAdapter[Experiment] = TypeAdapter(Experiment, config=ConfigDict(allow_inf_nan=False, defer_build=True))


def from_plain(plain: Any, where: str) -> Experiment:
    """Validate plain data strictly: no text becomes a number. Raises ExperimentError; `where` names the origin."""
    if too_deep(plain):
        raise ExperimentError([f"{where}: tables and lists are nested more than {DEEPEST} deep: write them flat"])
    try:
        data = json.dumps(as_fields(plain, Experiment))
    except TypeError as reason:
        raise ExperimentError([f"{where}: {reason}: use text, numbers, true or false, lists and tables"]) from None
    except ValueError as reason:
        raise ExperimentError([f"{where}: {reason}"]) from None
    try:
        experiment = _ADAPTER.validate_json(data, strict=True)
    except ValidationError as refused:
        raise from_validation(where, refused.errors(), Experiment) from None
    return checked(experiment, where, plain.get("faults", ()) if isinstance(plain, dict) else None)


def assigned(experiment: Experiment, values: Iterable[tuple[str, Any]], where: str) -> Experiment:
    """`experiment` with each value put at its dotted path, in order, validated as if it had been written so.

    Raises ExperimentError; `where` names the origin.
    """
    plain, found = to_plain(experiment), []
    for path, value in values:
        try:
            put(plain, path, _unboxed(value))
        except ValueError as refused:
            found.append(f"{where} {path}: {refused}")
    if found:
        raise ExperimentError(found)
    return from_plain(plain, where)


def _unboxed(value: Any) -> Any:
    """Plain data of a value; a numpy number or array as Python's own."""
    return to_plain(value.tolist() if hasattr(value, "tolist") else value)


def validate(experiment: Experiment) -> Experiment:
    """The same experiment, if it can run: bounds of each value, and sections that fit together.

    Raises ExperimentError with one line a problem: where, value, unit, what was expected, what to do.
    """
    if not isinstance(experiment, Experiment):
        raise ExperimentError([f'expected an experiment, such as load("fig-5-5"), not {type(experiment).__name__}'])
    return from_plain(to_plain(experiment), experiment.name if isinstance(experiment.name, str) else "experiment")


def checked_seed(seed: Any) -> int:
    """The seed as an int, if it can be one. Raises ExperimentError."""
    if isinstance(seed, Integral) and not isinstance(seed, bool) and 0 <= int(seed) < SEEDS:
        return int(seed)
    raise ExperimentError([f"seed is {seed!r:.40}: expected a whole number from 0 to {SEEDS - 1}"])


def checked(experiment: Experiment, where: str, written_faults: Sequence[Any] | None = None) -> Experiment:
    """`experiment`, if its sections agree with each other. Raises ExperimentError.

    `written_faults` are its faults before their defaults: only these show that a value was left out.
    """
    found = [
        f"{where}: claims.{number}.{field} {what}; correct the claim"
        for number, claim in enumerate(experiment.claims)
        for field, what in problems(claim, experiment.duration_s)
    ]
    plant, faults = experiment.plant, experiment.faults
    period_ns, ticks = plant.sample_period_substeps * SUBSTEP_NS, trial_ticks(plant, experiment.duration_s)
    broken = trial_problems(faults if written_faults is None else written_faults, faults, period_ns, ticks)
    found += [f"{where}: {what}; correct the fault" for what in broken]
    found += [
        f"{where}: changes.{number}.at_s is {change.at_s:g} s: the trial ends at {experiment.duration_s:g} s; correct the time"
        for number, change in enumerate(experiment.changes)
        if not change.at_s < experiment.duration_s
    ]
    found += [f"{where}: {reason}" for reason in unprintable(to_plain(experiment))]
    found += [f"{where}: {reason}" for reason in _section_problems(experiment)]
    if found:
        raise ExperimentError(found)
    return experiment


def _section_problems(experiment: Experiment) -> list[str]:
    """What each service says of fields that are valid one by one but do not fit together."""
    plant, found = experiment.plant, []
    met = contact_environment(to_plain(plant))
    checks: tuple[Callable[[], object], ...] = (
        lambda: latch_substeps(plant),
        lambda: contact_params(plant.environment),
        lambda: describe(plant, GateLimits()),
        lambda: _check_controllers(experiment, (experiment.controller,), met),
        lambda: _check_controllers(experiment, _acting(experiment)[1:], met),
    )
    for agrees in checks:
        try:
            agrees()
        except ValueError as reason:
            found.append(str(reason))
    return found


def _check_controllers(experiment: Experiment, configs: Sequence[ControllerConfig], met: ContactEnvironment) -> None:
    """Raise ValueError where one of these configurations could not be loaded with the rest of the experiment."""
    plant = experiment.plant
    lengths = geometry(to_plain(plant.machine))
    for config in configs:
        check(config, experiment.reference, plant.initial_q, plant.machine.q4_rad, met, geometry=lengths)


def _acting(experiment: Experiment) -> tuple[ControllerConfig, ...]:
    """The controller's configurations in the order in which they act."""
    period_ns = experiment.plant.sample_period_substeps * SUBSTEP_NS
    changed = scheduled(experiment.controller, experiment.changes, period_ns)
    return (experiment.controller, *(config for _, config in changed))


def warnings(experiment: Experiment) -> tuple[str, ...]:
    """What an operator should know before it runs, one line a warning; none of them keeps it from running."""
    met = contact_environment(to_plain(experiment.plant))
    found = [line for config in _acting(experiment) for line in preflight(config, met)]
    return tuple(dict.fromkeys((*found, *_unusual_values(experiment))))


def _unusual_values(experiment: Experiment) -> Iterator[str]:
    """Values ten or more times their default, except those that are chosen freely over orders of magnitude."""
    usual = Experiment(name="", alias="", title="", source="", duration_s=0.0)
    for path, value, default in unusual(to_plain(experiment), to_plain(usual)):
        if not path.startswith(_FREELY_CHOSEN):
            yield f"{path} is {value:g}, its default {default:g}: check its unit"


def to_toml(experiment: Experiment) -> str:
    """The experiment as TOML with every default spelled out; reading it gives the same experiment.

    TOML has no null: a field that is None is left out.
    """
    return tomli_w.dumps(_without_none(to_plain(experiment)))


def _without_none(plain: Any) -> Any:
    if isinstance(plain, dict):
        return {name: _without_none(value) for name, value in plain.items() if value is not None}
    return [_without_none(item) for item in plain] if isinstance(plain, list) else plain


def to_bytes(experiment: Experiment) -> bytes:
    """The experiment as canonical JSON: sorted keys, no spaces, shortest digits that give the same float back."""
    return json.dumps(to_plain(experiment), sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()


def from_bytes(data: bytes) -> Experiment:
    """The experiment that `data` carries. Raises ExperimentError."""
    try:
        plain = json.loads(data)
    except (ValueError, RecursionError) as reason:
        raise ExperimentError([f"message: is no JSON: {reason}; send the bytes of to_bytes"]) from None
    return from_plain(plain, "message")


def experiment_hash(data: bytes) -> bytes:
    """SHA-256 over the bytes as sent; a receiver echoes it and never encodes again."""
    return hashlib.sha256(data).digest()
