"""A whole campaign in one call: table, pictures, progress, and what stops it."""

from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from distributed import LocalCluster

from hydrohil.campaign.cluster import ClusterError
from hydrohil.campaign.run import CampaignProgress, CampaignResult, run_campaign
from hydrohil.campaign.store import StoreError
from hydrohil.experiment.errors import ExperimentError
from hydrohil.shared.errors import HydrohilError
from tests.support.campaign_scene import plan, write

PICTURES = {"peak": {"kind": "distribution", "of": "peak_n"}}


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, protocol="tcp://", dashboard_address=None) as local:
        yield local.scheduler_address


@pytest.fixture(scope="module")
def finished(scheduler: str, tmp_path_factory: pytest.TempPathFactory) -> tuple[CampaignResult, list[CampaignProgress]]:
    folder, reports = tmp_path_factory.mktemp("campaign"), list[CampaignProgress]()
    file = write(folder, pictures=PICTURES)
    return run_campaign(file, folder / "out", scheduler=scheduler, progress=reports.append), reports


def test_every_trial_has_its_row_in_the_table_and_in_its_file(finished):
    result, _ = finished
    assert result.table.column("trial").to_pylist() == list(range(12)) and result.ran == 12
    assert pq.read_table(result.table_file).equals(result.table)
    assert [path.name for path in result.pictures] == ["tiny-peak.png"] and all(path.exists() for path in result.pictures)


def test_progress_begins_with_nothing_and_ends_with_everything(finished):
    _, reports = finished
    assert reports[0] == CampaignProgress(trials=12, finished=0, resumed=0, incomplete=0, trials_per_s=0.0)
    assert reports[-1].finished == 12 and reports[-1].trials_per_s > 0.0
    assert [report.finished for report in reports] == sorted(report.finished for report in reports)


def test_the_summary_counts_how_trials_ended_and_spreads_each_metric(finished):
    result, _ = finished
    summary = result.summary()
    assert summary["ended"] == {"completed": 12, "tripped": 0, "refused": 0} and summary["ran_now"] == 12
    assert {one["metric"] for one in summary["metrics"]} == {"peak_n", "error_n"}


def test_a_finished_campaign_runs_nothing_again(finished):
    result, _ = finished
    again = run_campaign(result.plan, result.table_file.parent, progress=lambda _: pytest.fail("something is run"))
    assert again.ran == 0 and again.table.equals(result.table)


def test_what_cannot_be_run_is_an_error_of_the_library(finished, scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    result, _ = finished
    with pytest.raises(ExperimentError, match="stability-map"):
        run_campaign("stabilty-map", tmp_path)
    with pytest.raises(StoreError, match="--fresh"):
        run_campaign(plan(seed=6), result.table_file.parent, scheduler=scheduler)
    with pytest.raises(StoreError, match="/dev/null"):
        run_campaign(plan(), "/dev/null/x")
    monkeypatch.setattr("hydrohil.campaign.cluster._CONNECT_S", 0.3)
    with pytest.raises(ClusterError, match="dask scheduler"):
        run_campaign(plan(), tmp_path, scheduler="tcp://127.0.0.1:1")
    assert all(issubclass(error, HydrohilError) for error in (ExperimentError, StoreError, ClusterError))
