"""Geometry and gauge of a machine as the section [plant.machine] of an experiment states them."""

import math
from collections.abc import Mapping
from typing import Any

from hydrohil.shared.contract.link_units import written_name
from hydrohil.shared.machine.description import LINKS, Gauge, Geometry


def geometry(values: Mapping[str, Any]) -> Geometry:
    """Lengths and travel of the section `values`; raises KeyError, TypeError or ValueError where it does not state them."""
    low, high = ([_number(values[link], written_name(end, link)) for link in LINKS] for end in ("travel_low_q", "travel_high_q"))
    return Geometry(
        offset_m=_number(values, "a2_m"),
        hand_m=_number(values, "a4_m"),
        retracted_m=_number(values, "d3_offset_m"),
        low_q=(low[0], low[1], low[2]),
        high_q=(high[0], high[1], high[2]),
    )


def gauge(values: Mapping[str, Any], known: Gauge) -> Gauge:
    """The gauge of the section `values`; its noise is at least what the machine's is known for, so that a quiet one is found."""
    return known._replace(
        noise_n=max(known.noise_n, _number(values, "force_noise_clip_n")),
        range_n=_number(values, "force_high_n"),
        stiffness_n_per_m=_number(values, "sensor_stiffness_n_per_m"),
        damping_ns_per_m=_number(values, "sensor_damping_ns_per_m"),
    )


def _number(values: Mapping[str, Any], name: str) -> float:
    number = float(values[name])
    if not math.isfinite(number):
        raise ValueError(f"plant.machine: {name} is {number:g}; expected a finite number")
    return number
