"""What a load hands to every service: one text, hashed as sent; each service opens its own section."""

import hashlib
import json
from typing import Any, NamedTuple

from pydantic import ConfigDict, TypeAdapter, ValidationError

from shared.faults import Fault, Group, of_group, problem

CLOCKS = ("real", "lockstep")
_LARGEST = {"run": 2**63 - 1, "seed": 2**64 - 1, "bias_ticks": 10_000, "duration_ticks": 3_600_000}  # 10 s and 1 h at 1 kHz


class Envelope(NamedTuple):
    """One run of one experiment."""

    digest: bytes  # SHA-256 over the text as sent; others echo it and never recompute it from parts
    run: int
    seed: int
    clock: str
    bias_ticks: int
    duration_ticks: int
    experiment: dict[str, Any]


def seal(experiment: dict[str, Any], *, run: int, seed: int, clock: str, bias_ticks: int, duration_ticks: int) -> str:
    """The text that is sent and hashed."""
    return json.dumps(
        {
            "run": run,
            "seed": seed,
            "clock": clock,
            "bias_ticks": bias_ticks,
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
        made = Envelope(digest=hashlib.sha256(text.encode()).digest(), **values)
    except (ValueError, TypeError, RecursionError) as error:
        raise ValueError(f"the load is no envelope: {error}") from error
    if made.clock not in CLOCKS:
        raise ValueError(f"clock is {made.clock!r}, expected one of {', '.join(CLOCKS)}")
    for name, largest in _LARGEST.items():
        if type(getattr(made, name)) is not int or not 0 <= getattr(made, name) <= largest:
            raise ValueError(f"{name} is {getattr(made, name)!r}, expected a whole number from 0 to {largest}")
    if type(made.experiment) is not dict:
        raise ValueError(f"experiment is {type(made.experiment).__name__}, expected an object with a section for each service")
    return made


def section(envelope: Envelope, name: str, kind: Any) -> Any:
    """Section `name` as a `kind`; raises ValueError with one line that names the field."""
    return checked(envelope.experiment.get(name, {}), name, kind)


def faults(envelope: Envelope, *groups: Group) -> tuple[Fault, ...]:
    """The experiment's faults of these groups; raises ValueError with one line if any fault cannot be played on its clock."""
    every: tuple[Fault, ...] = checked(envelope.experiment.get("faults", []), "faults", tuple[Fault, ...])
    for number, fault in enumerate(every):
        if what := problem(fault, envelope.clock):
            raise ValueError(f"faults.{number}: {what}")
    return of_group(every, *groups)


def checked(plain: Any, name: str, kind: Any) -> Any:
    """`plain` data as a `kind`; raises ValueError with one line that names the field."""
    try:
        adapter = TypeAdapter(kind, config=ConfigDict(allow_inf_nan=False))
        return adapter.validate_json(json.dumps(plain), strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in (name, *first["loc"]))
        raise ValueError(f"{where} is {first['input']!r}: {first['msg']}") from error
