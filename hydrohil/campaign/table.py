"""The rows of a campaign as one table: a column a parameter, a metric, a claim; the schema says what each is."""

import json
from typing import Any

import pyarrow as pa

from hydrohil.campaign.axis import Axis
from hydrohil.campaign.campaign import Plan
from hydrohil.campaign.trials import count
from hydrohil.campaign.work import Row, claim_column, holds_column
from hydrohil.claims.claims import band
from hydrohil.experiment.experiment import to_bytes

KEY = b"hydrohil"  # of the table's metadata, JSON


def identity(plan: Plan, sources: str) -> dict[str, Any]:
    """Two tables with the same identity are of the same campaign."""
    return {"campaign": plan.digest, "sources": sources, "seed": plan.campaign.seed, "trials": count(plan.campaign)}


def schema(plan: Plan, sources: str) -> pa.Schema:
    """Columns with their meaning, and the campaign itself, as metadata."""
    campaign = plan.campaign
    fields = [pa.field(name, pa.int64()) for name in ("trial", "point", "repeat", "seed")]
    fields += [_field(name, _kind(axis), paths=[*(axis.sets or {name: ""})]) for name, axis in campaign.sweep.items()]
    fields += [
        _field(name, pa.float64(), unit=m.unit, metric=m.metric, channel=m.channel, start_s=m.start_s, end_s=m.end_s)
        for name, m in campaign.metrics.items()
    ]
    for number, claim in enumerate(plan.base.claims):
        stated = {"statement": claim.statement, "stated": band(claim), "unit": claim.unit, "source": claim.source}
        fields.append(_field(claim_column(number), pa.float64(), **stated))
        fields.append(_field(holds_column(number), pa.bool_(), **stated))
    fields += [pa.field(name, pa.string()) for name in ("ended", "cause", "message")] + [pa.field("end_s", pa.float64())]
    known = identity(plan, sources) | {"name": campaign.name, "title": campaign.title, "experiment": to_bytes(plan.base).decode()}
    return pa.schema(fields, metadata={KEY: json.dumps(known).encode()})


def _field(name: str, kind: pa.DataType, **meaning: Any) -> pa.Field:
    return pa.field(name, kind, metadata={KEY: json.dumps(meaning).encode()})


def _kind(axis: Axis) -> pa.DataType:
    if axis.list is None:
        return pa.float64()
    kinds = {type(value) for value in axis.list}
    return {bool: pa.bool_(), str: pa.string(), int: pa.int64()}[kinds.pop()] if kinds in ({bool}, {str}, {int}) else pa.float64()


def table(rows: list[Row], columns: pa.Schema) -> pa.Table:
    """The rows with every column; what a row lacks is null."""
    return pa.Table.from_pylist(rows, schema=columns)


def known_identity(columns: pa.Schema) -> dict[str, Any]:
    """What the schema of a stored table says of its campaign; empty if it is none of ours."""
    return dict(json.loads((columns.metadata or {}).get(KEY, b"{}")))
