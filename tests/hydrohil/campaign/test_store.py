"""Parts, and the file that is put together from them: whole or not there, of one campaign, one at a time."""

import os
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from hydrohil.campaign import store as stores
from hydrohil.campaign.store import StoreError, opened
from hydrohil.campaign.table import known_identity
from hydrohil.campaign.trials import count, trial_of
from tests.support.campaign_scene import plan


def result_of(number: int) -> dict[str, Any]:
    trial = trial_of(plan().campaign, number)
    known = {"trial": number, "point": trial.point, "repeat": trial.repeat, "seed": trial.seed, **trial.parameters}
    return known | {"peak_n": 1.0 + number, "ended": "completed"}


def kept(folder: Path, **changes: Any) -> list[int]:
    with opened(plan(**changes), folder, fresh=False) as store:
        return sorted(store.kept().column("trial").to_pylist())


@pytest.fixture
def begun(tmp_path: Path) -> Path:
    with opened(plan(), tmp_path, fresh=False) as store:
        store.keep([result_of(3), result_of(2)])
        store.keep([result_of(0)])
    return tmp_path


def test_what_is_kept_is_there_the_next_time(begun: Path):
    assert kept(begun) == [0, 2, 3]


def test_a_part_that_was_not_renamed_or_is_torn_is_not_there(begun: Path):
    parts = begun / ".tiny.parts"
    (parts / ".000000000005.arrow.new").write_bytes(b"half")
    (parts / "000000000006.arrow").write_bytes((parts / "000000000000.arrow").read_bytes()[:100])
    assert kept(begun) == [0, 2, 3]


def test_the_file_has_every_trial_in_order_and_the_parts_are_gone(begun: Path):
    with opened(plan(), begun, fresh=False) as store:
        store.keep([result_of(number) for number in range(1, count(plan().campaign)) if number not in (2, 3)])
        table = store.finish()
    assert table.column("trial").to_pylist() == list(range(12))
    assert pq.read_table(begun / "tiny.parquet").equals(table)
    assert not (begun / ".tiny.parts").exists()
    known = known_identity(pq.read_schema(begun / "tiny.parquet"))
    assert (known["seed"], known["trials"], known["name"]) == (5, 12, "tiny")
    assert table.column("error_n").null_count == 12  # a row that lacks a column


@pytest.mark.parametrize("change", [{"seed": 6}, {"repeats": 3}, {"set": {"duration_s": 0.2}}])
def test_another_campaign_is_refused_with_what_to_do_and_fresh_starts_anew(begun: Path, change: dict[str, Any]):
    with pytest.raises(StoreError, match=r"--out.*--fresh"):
        kept(begun, **change)
    with opened(plan(**change), begun, fresh=True) as store:
        assert store.kept().num_rows == 0


def test_other_sources_are_refused_also_beside_a_file_that_is_whole(begun: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stores, "source_version", lambda: "feed")
    with pytest.raises(StoreError, match=r"other sources.*feed.*--fresh"):
        kept(begun)
    monkeypatch.undo()
    with opened(plan(), begun, fresh=False) as store:
        store.finish()
    monkeypatch.setattr(stores, "source_version", lambda: "feed")
    with pytest.raises(StoreError, match=r"tiny\.parquet.*other sources"):
        kept(begun)


def test_an_empty_folder_of_other_sources_is_nobody_s(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stores, "source_version", lambda: "feed")
    assert kept(tmp_path) == []
    monkeypatch.undo()
    assert kept(tmp_path) == []


def test_a_picture_or_a_title_changes_nothing(begun: Path):
    assert kept(begun, title="Another", pictures={"p": {"kind": "distribution", "of": "peak_n"}}) == [0, 2, 3]


def test_two_at_a_time_are_refused(begun: Path):
    with opened(plan(), begun, fresh=False), pytest.raises(StoreError, match="another process"):
        kept(begun)


def test_a_foreign_file_of_that_name_is_left_alone(tmp_path: Path):
    (tmp_path / "tiny.parquet").write_text("mine")
    with pytest.raises(StoreError, match="no Parquet file"):
        kept(tmp_path)
    assert (tmp_path / "tiny.parquet").read_text() == "mine"


def test_a_full_disk_is_reported_and_leaves_the_parts(begun: Path, monkeypatch: pytest.MonkeyPatch):
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    with opened(plan(), begun, fresh=False) as store:
        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(StoreError, match=r"No space left.*goes on"):
            store.keep([result_of(1)])
    monkeypatch.undo()
    assert kept(begun) == [0, 2, 3]
