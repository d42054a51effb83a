"""A campaign of short trials: a force step on the soft plate, a quarter of a second each, bias included."""

from pathlib import Path
from typing import Any

import tomli_w

from hydrohil.campaign.campaign import Plan
from hydrohil.campaign.reading import from_table, read

BIAS_S, LASTS_S = 0.15, 0.1


def table(**changes: Any) -> dict[str, Any]:
    """What the file says, with `changes` of its first level."""
    window = {"start_s": 0.0, "end_s": LASTS_S}
    plain = {
        "name": "tiny",
        "title": "Tiny",
        "experiment": "fig-5-5",
        "seed": 5,
        "repeats": 2,
        "set": {
            "duration_s": LASTS_S,
            "plant.bias_s": BIAS_S,
            "reference": [{"channel": "force", "kind": "step", "start_s": 0.01, "amount": 100.0}],
        },
        "sweep": {
            "controller.law": {"list": ["pi", "final"]},
            "mass_kg": {
                "grid": {"from": 100.0, "to": 1000.0, "count": 3, "scale": "log"},
                "sets": {"controller.impedance.mass_kg": "value"},
            },
            "controller.impedance.damping_ratio": {"uniform": {"low": 1.0, "high": 2.0}},
        },
        "metrics": {
            "peak_n": {"metric": "maximum", "channel": "force", "unit": "N", **window},
            "error_n": {"metric": "rms_error", "channel": "force", "unit": "N", **window},
        },
    }
    return plain | changes


def plan(**changes: Any) -> Plan:
    """The campaign with `changes`, as if it were in mine.toml."""
    return from_table(table(**changes), Path("mine.toml"))


def write(folder: Path, **changes: Any) -> Path:
    """The campaign as a file that reads."""
    path = folder / "mine.toml"
    path.write_text(tomli_w.dumps(table(**changes)))
    read(path)
    return path
