"""What a load hands to every service: one text, hashed as sent; each service opens its own section."""

import hashlib
import json
from typing import Any, NamedTuple

from pydantic import TypeAdapter, ValidationError

CLOCKS = ("real", "lockstep")


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
    except (ValueError, TypeError) as error:
        raise ValueError(f"the load is no envelope: {error}") from error
    if made.clock not in CLOCKS:
        raise ValueError(f"clock is {made.clock!r}, expected one of {', '.join(CLOCKS)}")
    for name in ("run", "seed", "bias_ticks", "duration_ticks"):
        if type(getattr(made, name)) is not int or getattr(made, name) < 0:
            raise ValueError(f"{name} is {getattr(made, name)!r}, expected a whole number of 0 or more")
    return made


def section(envelope: Envelope, name: str, kind: Any) -> Any:
    """Section `name` as a `kind`; raises ValueError with one line that names the field."""
    try:
        return TypeAdapter(kind).validate_json(json.dumps(envelope.experiment.get(name, {})))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in (name, *first["loc"]))
        raise ValueError(f"{where} is {first['input']!r}: {first['msg']}") from error
