"""A campaign on a Dask cluster in this process: every trial once, whatever was kept before."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

from hydrohil.campaign import run as runs
from hydrohil.campaign.cluster import ClusterError, cluster
from hydrohil.campaign.run import chunk_size, pending, run
from hydrohil.campaign.store import opened
from hydrohil.campaign.work import COMPLETED
from tests.support.campaign_scene import plan


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as made,
        Client(made, set_as_default=False) as client,
    ):
        yield client


def test_what_is_missing_is_run_and_nothing_twice(client: Client, tmp_path: Path):
    told: list[int] = []
    with opened(plan(), tmp_path, fresh=False) as store:
        run(client, store, [3, 4, 11], 0.01, lambda rows: told.extend(row["trial"] for row in rows))
        assert sorted(told) == [3, 4, 11] and pending(store) == [0, 1, 2, 5, 6, 7, 8, 9, 10]
        run(client, store, pending(store), 0.01, lambda rows: told.extend(row["trial"] for row in rows))
        assert sorted(told) == list(range(12)) and pending(store) == []
        table = store.finish()
    assert table.column("ended").to_pylist() == [COMPLETED] * 12
    assert table.column("peak_n").null_count == 0


def test_workers_of_other_sources_are_told_of(client: Client, tmp_path: Path):
    with opened(plan(), tmp_path, fresh=False) as store, pytest.raises(ClusterError, match="another version"):
        run(client, store._replace(sources="feed"), [0], 0.01, lambda _: None)


def test_an_address_without_a_scheduler_says_how_to_start_one(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("hydrohil.campaign.cluster._CONNECT_S", 0.3)
    with pytest.raises(ClusterError, match="dask scheduler"), cluster(1, "tcp://127.0.0.1:1"):
        pass


def test_a_chunk_is_two_seconds_of_work_and_every_worker_gets_several():
    assert chunk_size(0.05, 10_000, 2) == 40
    assert chunk_size(0.01, 40, 2) == 5
    assert chunk_size(0.05, 10**7, 100) == 1000  # and there are 10,000 parts at most
    assert chunk_size(10.0, 100, 2) == chunk_size(0.01, 3, 2) == 1
    assert runs.CHUNK_S == 2.0
