"""A finished campaign in numbers: how trials ended, and each metric by the values of the lists of words."""

from typing import Any

import numpy as np
import pyarrow as pa

from hydrohil.campaign.campaign import Plan
from hydrohil.campaign.pictures import numbers
from hydrohil.campaign.work import COMPLETED, REFUSED, TRIPPED, claim_column, holds_column
from hydrohil.claims.claims import band


def ended(table: pa.Table) -> dict[str, int]:
    """Trials that completed, tripped, were refused."""
    found = table.column("ended").to_pylist()
    return {words: found.count(words) for words in (COMPLETED, TRIPPED, REFUSED)}


def causes(table: pa.Table) -> dict[str, int]:
    """Trips by their cause; what was refused by its words."""
    columns = (table.column(name).to_pylist() for name in ("ended", "cause", "message"))
    found = [cause if how == TRIPPED else words for how, cause, words in zip(*columns, strict=True) if how != COMPLETED]
    return {words: found.count(words) for words in dict.fromkeys(found)}


def groups(plan: Plan, table: pa.Table) -> dict[str, Any]:
    """(n,) rows of each combination of the lists of words and truth values; one group if there is none."""
    names = [n for n, axis in plan.campaign.sweep.items() if axis.list is not None and isinstance(axis.list[0], str | bool)]
    columns = [table.column(name).to_pylist() for name in names]
    keys = [", ".join(f"{name} = {value}" for name, value in zip(names, row, strict=True)) for row in zip(*columns, strict=True)]
    keys = keys or ["all"] * table.num_rows
    return {key: np.array([one == key for one in keys]) for key in dict.fromkeys(keys)}


def metrics(plan: Plan, table: pa.Table) -> list[dict[str, Any]]:
    """Spread of every metric in every group."""
    return [
        {"metric": name, "unit": measure.unit, "of": key, **_spread(numbers(table, name)[chosen])}
        for name, measure in plan.campaign.metrics.items()
        for key, chosen in groups(plan, table).items()
    ]


def _spread(measured: Any) -> dict[str, Any]:
    known = measured[np.isfinite(measured)]
    counts: dict[str, Any] = {"trials": len(measured), "not_determined": len(measured) - len(known)}
    at = np.percentile(known, (0, 5, 50, 95, 100)).tolist() if len(known) else [None] * 5
    return counts | dict(zip(("least", "p5", "median", "p95", "most"), at, strict=True))


def claims(plan: Plan, table: pa.Table) -> list[dict[str, Any]]:
    """How often each claim of the experiment holds; a trial without a verdict counts as one in which it does not."""
    found = []
    for number, claim in enumerate(plan.base.claims):
        holds = table.column(holds_column(number)).to_pylist()
        for key, chosen in groups(plan, table).items():
            held = sum(bool(one) for one, in_group in zip(holds, chosen, strict=True) if in_group)
            claimed = {"statement": claim.statement, "stated": band(claim), "column": claim_column(number)}
            found.append({**claimed, "of": key, "trials": int(chosen.sum()), "hold": held})
    return found


def summary(plan: Plan, table: pa.Table) -> dict[str, Any]:
    """How trials ended, why some did not complete, and the spread of metrics and claims; ready for JSON."""
    return {
        "ended": ended(table),
        "causes": causes(table),
        "metrics": metrics(plan, table),
        "claims": claims(plan, table),
    }
