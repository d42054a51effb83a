"""What is on record of a host: read back, of another host, damaged; and what it forbids."""

import json

import pytest

from hydrohil.shared.host import qualified
from hydrohil.shared.host.qualified import (
    NOT_QUALIFIED,
    UNKNOWN,
    Host,
    Qualified,
    Standing,
    beyond,
    of_plain,
    plain,
    record_file,
    standing,
    words,
)

REALLY_HERE = qualified.this_host
HERE = Host("bench", "boot-1", "6.1", "Xeon", 4)
FOUND = Qualified(
    qualified_period_ns=2_000_000,
    grade="B",
    measured_at="2026-11-28 02:00:00+00:00",
    period_ns=2_000_000,
    samples=10_000,
    late_share=0.0004,
    accepted_p999_us=1400.0,
    wake_up_max_us=12_000.0,
    lease_ms=36.0,
)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path))
    monkeypatch.setattr(qualified, "this_host", lambda: HERE)


def record(text=None, host=HERE, summary=FOUND, fifo=True):
    path = record_file(HERE, fifo=fifo)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"host": host._asdict(), "summary": summary._asdict()}) if text is None else text)
    return path


def test_without_a_record_a_host_is_not_qualified():
    assert standing(fifo=True) == UNKNOWN == Standing(None, NOT_QUALIFIED)


def test_a_record_is_read_back():
    record()
    assert standing(fifo=True) == Standing(FOUND, words(FOUND))


@pytest.mark.parametrize("field", Host._fields)
def test_a_record_counts_for_its_own_host_boot_kernel_processor_and_cores_alone(field, monkeypatch):
    record()
    other = HERE._replace(**{field: 8 if field == "cores" else "other"})
    monkeypatch.setattr(qualified, "this_host", lambda: other)
    assert standing(fifo=True) == UNKNOWN


def test_a_record_with_real_time_scheduling_does_not_count_without():
    record()
    assert standing(fifo=False) == UNKNOWN


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "null",
        json.dumps({"host": HERE._asdict() | {"boot_id": "boot-0"}, "summary": FOUND._asdict()}),
        json.dumps({"host": HERE._asdict(), "summary": FOUND._asdict() | {"qualified_period_ns": "2 ms"}}),
        json.dumps({"host": HERE._asdict(), "summary": FOUND._asdict() | {"qualified_period_ns": -1}}),
        json.dumps({"host": HERE._asdict(), "summary": FOUND._asdict() | {"late_share": float("nan")}}),
        json.dumps({"host": HERE._asdict(), "summary": FOUND._asdict() | {"period_ns": 0}}),
        json.dumps({"host": HERE._asdict(), "summary": {"grade": "A"}}),
        json.dumps({"host": HERE._asdict()}),
        "[" * 100_000,
    ],
)
def test_a_damaged_record_qualifies_no_host_and_is_named(text):
    path = record(text)
    known = standing(fifo=True)
    assert known.qualified is None
    assert str(path) in known.words and "hydrohil qualify" in known.words
    assert "\n" not in known.words


def test_a_record_that_is_a_folder_is_damaged():
    path = record_file(HERE, fifo=True)
    path.mkdir(parents=True)
    assert str(path) in standing(fifo=True).words


def test_the_record_in_a_status_is_read_back():
    for known in (UNKNOWN, Standing(FOUND, words(FOUND))):
        assert of_plain(json.loads(json.dumps(plain(known)))) == known


def test_the_words_have_grade_rate_date_and_figures():
    text = words(FOUND)
    assert all(part in text for part in ("500 Hz", "grade B", FOUND.measured_at, "0.04%", "10000", "1.4 ms", "12 ms", "36 ms"))
    assert "no rate is qualified" in words(FOUND._replace(qualified_period_ns=0, late_share=None))


@pytest.mark.parametrize(
    ("period_ns", "refused"), [(10_000_000, False), (2_000_000, False), (1_950_000, True), (1_000_000, True)]
)
def test_what_is_qualified_is_allowed_and_one_sub_step_faster_is_not(period_ns, refused):
    assert bool(beyond(FOUND, period_ns)) == refused


def test_the_refusal_says_what_where_unit_what_was_expected_and_what_to_do():
    text = beyond(FOUND, 1_000_000)
    assert all(
        part in text for part in ("plant.sample_period_substeps", "1000 Hz", "500 Hz", "hydrohil qualify", "--unqualified")
    )


def test_where_no_rate_is_qualified_none_is_allowed_and_without_a_record_every_one_is():
    assert "no rate" in beyond(FOUND._replace(qualified_period_ns=0), 10_000_000)
    assert beyond(None, 1_000_000) == ""


def test_this_host_has_a_name_a_boot_and_processors():
    host = REALLY_HERE()
    assert host.hostname and host.boot_id and host.kernel and host.processor and host.cores > 0
