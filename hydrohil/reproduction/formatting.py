"""Numbers and verdicts as people read them."""

import math

from hydrohil.reproduction.tally import Tally


def number(value: float) -> str:
    """Three digits; what is not determined is a dash."""
    return f"{value:.3g}" if math.isfinite(value) else "-"


def measured(one: Tally) -> str:
    """The value, or over several seeds mean, spread and range."""
    unit = _unit(one)
    if not one.determined:
        return "not determined"
    if one.seeds == 1:
        return f"{number(one.mean)}{unit}"
    missing = one.seeds - len(one.determined)
    text = f"{number(one.mean)} ± {number(one.spread)}{unit} ({number(min(one.determined))}..{number(max(one.determined))})"
    return text + (f", not determined in {missing}" if missing else "")


def _unit(one: Tally) -> str:
    return "" if one.claim.unit == "1" else f" {one.claim.unit}"


def briefly(one: Tally) -> str:
    """The value, or mean and spread."""
    spread = f" ± {number(one.spread)}" if one.seeds > 1 and one.determined else ""
    return f"{number(one.mean)}{spread}{_unit(one)}"


def verdict(one: Tally) -> str:
    """Whether it holds, and of several seeds in how many."""
    word = "holds" if one.holds else "does NOT hold"
    return word if one.seeds == 1 else f"{word}: {one.held} of {one.seeds}"


def duration(seconds: float) -> str:
    """Seconds, minutes or hours."""
    if seconds < 100.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 6000.0 else f"{seconds / 3600.0:.1f} h"
