"""The load that every service gets: one text, hashed as sent, of which each service opens its own section."""

import hashlib
import json
from functools import cache
from typing import Any, NamedTuple

from pydantic import ConfigDict, TypeAdapter, ValidationError

from hydrohil.shared.contract.faults import Fault, Group, has_value, of_group, trial_problems, value_missing
from hydrohil.shared.contract.link_units import as_fields, written_location
from hydrohil.shared.units import SUBSTEP_NS

CLOCKS = ("real", "lockstep")
PERIOD_SUBSTEPS = 90  # the plant's default, for a load that does not say
_LARGEST = {"run": 2**63 - 1, "seed": 2**64 - 1, "tare_ticks": 10_000, "duration_ticks": 3_600_000}  # 10 s and 1 h at 1 kHz


class Envelope(NamedTuple):
    """One run of one experiment."""

    digest: bytes  # SHA-256 over the text as sent; others echo it and never recompute it from parts
    run: int
    seed: int
    clock: str
    tare_ticks: int
    duration_ticks: int
    experiment: dict[str, Any]


def seal(experiment: dict[str, Any], *, run: int, seed: int, clock: str, tare_ticks: int, duration_ticks: int) -> str:
    """The text that is sent and hashed."""
    return json.dumps(
        {
            "run": run,
            "seed": seed,
            "clock": clock,
            "tare_ticks": tare_ticks,
            "duration_ticks": duration_ticks,
            "experiment": experiment,
        },
        sort_keys=True,
        separators=(",", ":"),
    )


def unseal(text: str) -> Envelope:
    """The envelope in `text`; raises ValueError with one line if it is none."""
    try:
        values = json.loads(text)
        envelope = Envelope(digest=hashlib.sha256(text.encode()).digest(), **values)
    except (ValueError, TypeError, RecursionError) as error:
        raise ValueError(f"the load is no envelope: {error}") from error
    if envelope.clock not in CLOCKS:
        raise ValueError(f"clock is {envelope.clock!r}, expected one of {', '.join(CLOCKS)}")
    for name, largest in _LARGEST.items():
        if type(getattr(envelope, name)) is not int or not 0 <= getattr(envelope, name) <= largest:
            raise ValueError(f"{name} is {getattr(envelope, name)!r}, expected a whole number from 0 to {largest}")
    if type(envelope.experiment) is not dict:
        raise ValueError(
            f"experiment is {type(envelope.experiment).__name__}, expected an object with a section for each service"
        )
    return envelope


def section(envelope: Envelope, name: str, kind: Any) -> Any:
    """Section `name` as a `kind`; raises ValueError with one line that names the field."""
    return checked(envelope.experiment.get(name, {}), name, kind)


def period_substeps(envelope: Envelope) -> int:
    """Nominal period; its section is the plant's to judge, this alone is everybody's. Raises ValueError."""
    plant = envelope.experiment.get("plant", {})
    period = plant.get("sample_period_substeps", PERIOD_SUBSTEPS) if isinstance(plant, dict) else PERIOD_SUBSTEPS
    if type(period) is not int or period < 1:
        raise ValueError(f"plant.sample_period_substeps is {period!r}, expected a whole number of sub-steps")
    return period


def faults(envelope: Envelope, *groups: Group) -> tuple[Fault, ...]:
    """The experiment's faults of these groups; raises ValueError with one line if any fault cannot be played on its clock."""
    written = envelope.experiment.get("faults", [])
    every: tuple[Fault, ...] = checked(written, "faults", tuple[Fault, ...])
    ticks = (-envelope.tare_ticks, envelope.duration_ticks)
    if found := trial_problems(written, every, period_substeps(envelope) * SUBSTEP_NS, ticks, envelope.clock):
        raise ValueError(found[0])
    return of_group(every, *groups)


def one_fault(plain: Any) -> Fault:
    """The fault that a request asks for; raises ValueError with one line, also where its value is not given."""
    fault: Fault = checked(plain, "fault", Fault)
    if not has_value(plain) and (what := value_missing(fault)):
        raise ValueError(what)
    return fault


def checked(plain: Any, name: str, kind: Any) -> Any:
    """`plain` data as a `kind`; raises ValueError with one line that names the field."""
    try:
        text = json.dumps(as_fields(plain, kind, name))
    except (TypeError, RecursionError) as error:
        raise ValueError(f"{name}: {error}: use text, numbers, true or false, lists and tables") from None
    try:
        return _adapter(kind).validate_json(text, strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in (name, *written_location(first["loc"])))
        raise ValueError(f"{where} is {first['input']!r}: {first['msg']}") from error


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    """The validator of a kind, built once: building takes longer than a sample lasts."""
    return TypeAdapter(kind, config=ConfigDict(allow_inf_nan=False))
