"""Wake-ups: what cyclictest prints, and what is done where it is not there."""

import os

import pytest

from hydrohil.qualification import wakeups
from hydrohil.qualification.spread import Spread

PRINTED = """\
# /dev/cpu_dma_latency set to 0us
# Histogram
000000 000000
000019 000500
000020 000400
000021 000090
000040 000009
# Min Latencies: 00019
# Avg Latencies: 00019
# Max Latencies: 01371
# Histogram Overflows: 00001
# Histogram Overflow at cycle number:
# Thread 0: 00042
"""


def test_percentiles_of_cyclictests_histogram_count_what_is_beyond_it():
    assert wakeups.histogram(PRINTED) == Spread(20.0, 40.0, 1371.0, 1371.0)


@pytest.mark.parametrize("text", ["", "cyclictest: unrecognized option", "# Max Latencies: 00010\n"])
def test_what_is_no_histogram_is_not_taken_for_one(text):
    assert wakeups.histogram(text) is None


def test_without_cyclictest_nothing_is_measured_by_it(monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    assert wakeups.cyclictest(1_000_000, 10, fifo=False) is None


@pytest.mark.parametrize(("body", "measured"), [(f"cat <<'END'\n{PRINTED}END", True), ("exit 1", False), ("echo no", False)])
def test_a_cyclictest_that_does_not_run_is_as_good_as_none(monkeypatch, tmp_path, body, measured):
    program = tmp_path / "cyclictest"
    program.write_text(f"#!/bin/sh\n{body}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    assert (wakeups.cyclictest(1_000_000, 10, fifo=True) is not None) == measured


@pytest.mark.parametrize("measure", [wakeups.lateness_us, wakeups.nanosleep_lateness_us])
def test_every_wake_up_is_measured_and_none_is_early(measure):
    late = measure(1_000_000, 20)
    assert len(late) == 20
    assert min(late) >= 0.0
