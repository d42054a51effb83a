"""A campaign from its file to its table and pictures, in one call."""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from hydrohil.campaign.campaign import Plan
from hydrohil.campaign.cluster import cluster
from hydrohil.campaign.dispatch import pending, run_trials, trial_s
from hydrohil.campaign.pictures import draw_all
from hydrohil.campaign.reading import find_campaign
from hydrohil.campaign.store import Store, StoreError, opened
from hydrohil.campaign.summary import summary
from hydrohil.campaign.table import known_identity
from hydrohil.campaign.trials import count, validate
from hydrohil.campaign.work import COMPLETED, Row
from hydrohil.experiment.experiment import Experiment

if TYPE_CHECKING:
    import pyarrow as pa


class CampaignProgress(NamedTuple):
    """How far a campaign has come; reported at the start and after every chunk."""

    trials: int  # of the whole campaign
    finished: int  # of them, on the disk
    resumed: int  # of them, from an earlier run of the same campaign
    incomplete: int  # tripped or refused in this run
    trials_per_s: float  # of this run; 0 before its first chunk


class CampaignResult(NamedTuple):
    """A campaign whose every trial has its row."""

    plan: Plan
    table: "pa.Table"  # a row a trial; the metadata of a column hold its unit, metric or claim
    table_file: Path
    pictures: tuple[Path, ...]
    ran: int  # trials that this call has run; the others were there
    wall_s: float  # of running them

    def to_pandas(self) -> Any:
        """The table as a pandas.DataFrame; needs pandas."""
        return self.table.to_pandas()

    def summary(self) -> dict[str, Any]:
        """Identity, files, speed, how trials ended, spread of each metric, how often each claim holds; ready for JSON."""
        return {
            "name": self.plan.campaign.name,
            **known_identity(self.table.schema),
            "table": str(self.table_file),
            "pictures": [str(path) for path in self.pictures],
            "ran_now": self.ran,
            "wall_s": self.wall_s,
            "trials_per_s": self.ran / self.wall_s,
            **summary(self.plan, self.table),
        }


def run_campaign(
    campaign: str | Path | Plan,
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    fresh: bool = False,
    progress: Callable[[CampaignProgress], object] = lambda _: None,
) -> CampaignResult:
    """Run every trial of a campaign that `folder` does not hold yet; write NAME.parquet and the pictures there.

    `campaign` is the name of one that ships, the path of a TOML file, or a plan. The trials are computed by `workers` processes
    (default: one a core), or by the Dask cluster whose `scheduler` has this address. Local workers import the main module again:
    a script calls this under `if __name__ == "__main__":`. `fresh` forgets what is finished. `progress`
    is called at the start and after every few trials.

    Trips and failed claims are results and raise nothing. Raises ExperimentError where the campaign or one of its corners is not
    valid, StoreError where the folder cannot take it, ClusterError where there are no workers or they are lost. KeyboardInterrupt
    passes through. Whatever ends it, finished trials are kept, and the same call goes on.
    """
    plan = campaign if isinstance(campaign, Plan) else find_campaign(str(campaign))
    longest, folder = validate(plan), Path(folder)
    began = time.perf_counter()
    with opened(plan, folder, fresh=fresh) as store:
        table, ran = store.finished(), 0
        if table is None:
            ran = _run_missing(store, longest, workers, scheduler, progress)
            table = store.finish()
        wall_s = time.perf_counter() - began
        try:
            pictures = draw_all(plan, table, folder)
        except OSError as reason:
            why = reason.strerror or reason
            raise StoreError(f"{folder}: a picture cannot be written ({why}): the table is whole; make room") from None
        return CampaignResult(plan, table, store.final, tuple(pictures), ran, wall_s)


def _run_missing(
    store: Store,
    longest: Experiment,
    workers: int | None,
    scheduler: str | None,
    progress: Callable[[CampaignProgress], object],
) -> int:
    """Run the trials that no part has; returns how many there were."""
    numbers, trials = pending(store), count(store.plan.campaign)
    resumed = trials - len(numbers)
    now = CampaignProgress(trials, finished=resumed, resumed=resumed, incomplete=0, trials_per_s=0.0)
    progress(now)
    if not numbers:
        return 0
    processes = min(workers or len(os.sched_getaffinity(0)), len(numbers))
    with cluster(processes, scheduler) as client:
        began = time.perf_counter()

        def kept(rows: list[Row]) -> None:
            nonlocal now
            finished = now.finished + len(rows)
            now = now._replace(
                finished=finished,
                incomplete=now.incomplete + sum(row["ended"] != COMPLETED for row in rows),
                trials_per_s=(finished - resumed) / (time.perf_counter() - began),
            )
            progress(now)

        run_trials(client, store, numbers, trial_s(longest), kept)
    return len(numbers)
