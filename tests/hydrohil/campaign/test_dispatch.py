"""A campaign on a Dask cluster in this process: every trial once, with and without rows from before."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

from hydrohil.campaign import dispatch
from hydrohil.campaign.cluster import ClusterError, cluster
from hydrohil.campaign.dispatch import chunk_size, pending, run_trials
from hydrohil.campaign.store import opened
from hydrohil.campaign.work import COMPLETED
from tests.support.campaign_scene import plan


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as local,
        Client(local, set_as_default=False) as client,
    ):
        yield client


def test_what_is_missing_is_run_and_nothing_twice(client: Client, tmp_path: Path):
    reported: list[int] = []
    with opened(plan(), tmp_path, fresh=False) as store:
        run_trials(client, store, [3, 4, 11], 0.01, lambda rows: reported.extend(row["trial"] for row in rows))
        assert sorted(reported) == [3, 4, 11] and pending(store) == [0, 1, 2, 5, 6, 7, 8, 9, 10]
        run_trials(client, store, pending(store), 0.01, lambda rows: reported.extend(row["trial"] for row in rows))
        assert sorted(reported) == list(range(12)) and pending(store) == []
        table = store.finish()
    assert table.column("ended").to_pylist() == [COMPLETED] * 12
    assert table.column("peak_n").null_count == 0


def test_workers_of_other_sources_are_an_error(client: Client, tmp_path: Path):
    with opened(plan(), tmp_path, fresh=False) as store, pytest.raises(ClusterError, match="another version"):
        run_trials(client, store._replace(sources="feed"), [0], 0.01, lambda _: None)


def test_an_address_without_a_scheduler_says_how_to_start_one(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("hydrohil.campaign.cluster._CONNECT_S", 0.3)
    with pytest.raises(ClusterError, match="dask scheduler"), cluster(1, "tcp://127.0.0.1:1"):
        pass


def test_a_chunk_is_two_seconds_of_work_and_every_worker_gets_several():
    assert chunk_size(0.05, 10_000, 2) == 40
    assert chunk_size(0.01, 40, 2) == 5
    assert chunk_size(0.05, 10**7, 100) == 1000  # and there are 10,000 parts at most
    assert chunk_size(10.0, 100, 2) == chunk_size(0.01, 3, 2) == 1
    assert dispatch.CHUNK_S == 2.0
