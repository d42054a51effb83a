"""Campaigns read from TOML files, or found by the names of those that ship; what is wrong with one, a line a problem."""

import json
import os
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, TypeAdapter, ValidationError

from hydrohil.campaign.axis import axis_problems, distribution
from hydrohil.campaign.borders import border_problems
from hydrohil.campaign.campaign import FIXED, Campaign, Plan, columns_of, file_of
from hydrohil.experiment.errors import ExperimentError, from_validation
from hydrohil.experiment.experiment import Experiment, from_plain, to_plain
from hydrohil.experiment.overrides import assign
from hydrohil.experiment.toml_files import table_of
from hydrohil.shared.contract.assignments import nearest
from hydrohil.thesis.library import load

SHIPPED = Path(__file__).resolve().parent
_ADAPTER: TypeAdapter[Campaign] = TypeAdapter(Campaign, config=ConfigDict(allow_inf_nan=False))


def shipped() -> dict[str, Path]:
    """Campaigns that ship, by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def find_campaign(name: str) -> Plan:
    """The campaign in the file `name`, or the shipped one of that name. Raises ExperimentError."""
    if name.endswith(".toml") or os.sep in name:
        return read(Path(name))
    known = shipped()
    if name not in known:
        hint = nearest(name, known)
        raise ExperimentError([f"{name} is no campaign: use one of {hint}, or the path of a TOML file"])
    return read(known[name])


def read(path: Path) -> Plan:
    """Read and validate a campaign and its experiment. Raises ExperimentError."""
    return from_table(table_of(path), path)


def from_table(plain: dict[str, Any], path: Path) -> Plan:
    """Validate what the file at `path` says. Raises ExperimentError."""
    where = str(path)
    try:
        data = json.dumps(plain)
    except TypeError as reason:
        raise ExperimentError([f"{where}: {reason}: use text, numbers, true or false, lists and tables"]) from None
    try:
        campaign = _ADAPTER.validate_json(data, strict=True)
    except ValidationError as refused:
        raise from_validation(where, refused.errors(), Campaign) from None
    found = [f"{where}: sweep.{name} {what}" for name, axis in campaign.sweep.items() for what in axis_problems(axis)]
    found += [f"{where}: {what}" for what in (*_column_problems(campaign), *_picture_problems(campaign))]
    if found:
        raise ExperimentError(found)
    file = file_of(campaign, path)
    return Plan(campaign, _base(campaign, load(file or campaign.experiment), path), path)


def _base(campaign: Campaign, experiment: Experiment, path: Path) -> Experiment:
    plain = to_plain(experiment if campaign.claims else experiment._replace(claims=()))
    for target, value in campaign.set.items():
        assign(plain, target, value, f"{path}: set")
    return from_plain(plain, f"{path}: set")


def _column_problems(campaign: Campaign) -> list[str]:
    names = [*FIXED, *campaign.sweep, *campaign.metrics]
    twice = sorted({name for name in names if names.count(name) > 1})
    found = [f"{name} names two columns: rename one" for name in twice]
    if not campaign.metrics and not campaign.claims:
        found.append("nothing is measured: give [metrics.NAME] tables, or claims = true")
    if campaign.repeats == 1 and any(distribution(axis) for axis in campaign.sweep.values()):
        found.append("repeats is 1, and a distribution is drawn from once a repeat: give repeats above 1")
    return found


def _picture_problems(campaign: Campaign) -> list[str]:
    known, found = columns_of(campaign), []
    for name, picture in campaign.pictures.items():
        required = {"map": ("of", "x", "y"), "distribution": ("of",)}[picture.kind]
        used = [field for field in ("of", "x", "y", "by") if field in required or getattr(picture, field)]
        for field in used:
            if getattr(picture, field) not in known:
                hint = nearest(getattr(picture, field), known)
                found.append(f"pictures.{name}.{field} is {getattr(picture, field)!r}: no column; use one of {hint}")
        if picture.kind == "map":
            found += [
                f"pictures.{name}.{field} is {getattr(picture, field)!r}: a map goes over grids and lists of two or more numbers"
                for field in ("x", "y")
                if getattr(picture, field) in known and not _is_scale(campaign, getattr(picture, field))
            ]
        if picture.border:
            found += [f"pictures.{name}: {what}" for what in border_problems(campaign, picture)]
    return found


def _is_scale(campaign: Campaign, name: str) -> bool:
    axis = campaign.sweep.get(name)
    if axis is None or distribution(axis) is not None:
        return False
    return axis.list is None or (len(axis.list) > 1 and all(type(value) in (int, float) for value in axis.list))
