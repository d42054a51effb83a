"""A campaign as data: one experiment, what is swept, what is measured, what is drawn."""

import hashlib
import json
import os
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from annotated_types import Ge, Le, MinLen

from hydrohil.campaign.axis import Axis
from hydrohil.claims.claims import Claim, Unit
from hydrohil.claims.metrics import MetricName
from hydrohil.claims.signals import ChannelName
from hydrohil.experiment.experiment import Experiment, Name, to_bytes, to_plain

MAX_SEED = 2**53
MAX_REPEATS = 10**7
FIXED = ("trial", "point", "repeat", "seed", "ended", "cause", "message", "end_s")  # columns that every table has


class Measure(NamedTuple):
    """A number of every trial: a metric of a channel in a window, in `unit`, as a claim has it but without a band."""

    metric: MetricName
    channel: ChannelName
    start_s: Annotated[float, Ge(0)]
    end_s: Annotated[float, Ge(0)]
    unit: Unit


class Picture(NamedTuple):
    """A map of a column over two swept parameters, or the distribution of a column, one curve a value of `by`."""

    kind: Literal["map", "distribution"]
    of: str
    x: str = ""
    y: str = ""
    by: str = ""
    border: Literal["", "limit-cycle"] = ""  # drawn over a map
    title: str = ""


class Campaign(NamedTuple):
    """The content of a campaign file."""

    name: Name
    title: str
    experiment: Annotated[str, MinLen(1)]  # name, alias, or the path of a TOML file beside this one
    sweep: dict[str, Axis]
    set: dict[str, Any] = {}  # noqa: RUF012  path = value, of every trial, as `--set` has it
    seed: Annotated[int, Ge(0), Le(MAX_SEED)] = 0
    repeats: Annotated[int, Ge(1), Le(MAX_REPEATS)] = 1  # of every point; number r has seed + r and draw r
    claims: bool = False  # judge the experiment's own
    metrics: dict[str, Measure] = {}  # noqa: RUF012
    pictures: dict[str, Picture] = {}  # noqa: RUF012


class Plan(NamedTuple):
    """A campaign with the experiment that it varies, and where the file is."""

    campaign: Campaign
    base: Experiment  # with `set`; without its claims if they are not judged
    path: Path

    @property
    def digest(self) -> str:
        """SHA-256 (16 hex digits) of everything that decides a row; a picture or a title does not."""
        decides = to_plain(self.campaign._replace(title="", pictures={}))
        text = json.dumps(decides, sort_keys=True, default=to_plain).encode() + to_bytes(self.base)
        return hashlib.sha256(text).hexdigest()[:16]


def file_of(campaign: Campaign, path: Path) -> Path | None:
    """The experiment's own file, given relative to the campaign's; None of an experiment that ships."""
    named = campaign.experiment
    return path.parent / named if named.endswith(".toml") or os.sep in named else None


def columns_of(campaign: Campaign) -> tuple[str, ...]:
    """Columns of numbers that a picture can show: swept parameters and metrics."""
    return (*campaign.sweep, *campaign.metrics)


def measure_claims(campaign: Campaign) -> tuple[Claim, ...]:
    """The metrics as claims without a band, which the judge of claims can measure."""
    return tuple(
        Claim(name, metric=m.metric, channel=m.channel, comparison="above", start_s=m.start_s, end_s=m.end_s, unit=m.unit)
        for name, m in campaign.metrics.items()
    )
