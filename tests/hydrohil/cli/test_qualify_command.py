"""`hydrohil qualify` without a measurement: what it tries, says, writes, records, and its exit status."""

import json
import re

import pytest
from typer.testing import CliRunner

from hydrohil.cell.processes import CellError
from hydrohil.cli.main import app
from hydrohil.qualification import qualify as qualification
from hydrohil.qualification.grading import Figures
from hydrohil.qualification.measure import Measured
from hydrohil.shared.host.qualified import standing
from tests.support.qualification_scene import GOOD

GRANTED = {"fifo": True, "memory_locked": False, "idle_latency": False}
ALL_NS = [1_000_000, 2_000_000, 4_500_000, 10_000_000]


class Host:
    """A host that keeps up down to a sampling period, and remembers what was measured."""

    def __init__(self, keeps_up_ns):
        self.keeps_up_ns, self.asked = keeps_up_ns, []

    def measure(self, settings, period_substeps, progress):
        period_ns = period_substeps * 50_000
        self.asked.append((period_ns, settings))
        progress("the loop", 1.0)
        late = 0.0 if period_ns >= self.keeps_up_ns else 400.0
        return Measured(GOOD._replace(period_ns=period_ns, unanswered=late), GRANTED)


@pytest.fixture
def qualify(monkeypatch, tmp_path):
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path / "cache"))

    def run(host, *arguments):
        monkeypatch.setattr(qualification, "measure", host.measure if isinstance(host, Host) else host)
        return CliRunner().invoke(app, ["qualify", *arguments])

    return run


@pytest.mark.parametrize(
    ("keeps_up_ns", "tried", "status"),
    [(1_000_000, ALL_NS[:1], 0), (4_500_000, ALL_NS[:3], 0), (10_000_000, ALL_NS, 0), (10_000_001, ALL_NS, 1)],
)
def test_rates_are_tried_from_the_highest_down_until_one_is_qualified(qualify, keeps_up_ns, tried, status):
    host = Host(keeps_up_ns)
    result = qualify(host)
    assert [period_ns for period_ns, _ in host.asked] == tried
    assert result.exit_code == status, result.output
    found = standing(fifo=True).qualified
    assert found.qualified_period_ns == (tried[-1] if status == 0 else 0)
    assert standing(fifo=False).qualified is None
    assert "on record until the next boot" in result.stdout


@pytest.mark.parametrize(
    ("rate", "period_ns"), [("1000", 1_000_000), ("222.2", 4_500_000), ("333", 3_000_000), ("100", 10_000_000)]
)
def test_one_rate_is_tried_alone(qualify, rate, period_ns):
    host = Host(0)
    assert qualify(host, "--rate-hz", rate).exit_code == 0
    assert [asked for asked, _ in host.asked] == [period_ns]
    assert qualify(Host(20_000_000), "--rate-hz", rate).exit_code == 1
    assert standing(fifo=True).qualified.qualified_period_ns == 0


@pytest.mark.parametrize("fifo", [False, True])
def test_it_is_recorded_under_what_the_host_has_granted_and_not_under_what_was_asked_for(qualify, fifo):
    def measure(settings, period, progress):
        return Measured(GOOD, GRANTED | {"fifo": fifo})

    assert qualify(measure, "--rate-hz", "222.2", "--realtime").exit_code == 0
    assert [standing(fifo=granted).qualified is not None for granted in (fifo, not fifo)] == [True, False]


@pytest.mark.parametrize("rate", ["0", "-5", "nan", "inf", "97.5", "1026"])
def test_a_rate_that_no_plant_accepts_ends_with_2_and_says_which_are(qualify, rate):
    host = Host(0)
    result = qualify(host, "--rate-hz", rate)
    assert result.exit_code == 2
    assert "Hz" in result.stderr and "100 to 1000" in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1 and not host.asked


@pytest.mark.parametrize(
    ("options", "loop_s", "baseline_s"),
    [((), 20.0, 5.0), (("--quick",), 4.5, 1.0), (("--quick", "--seconds", "1"), 1.0, 1.0), (("--seconds", "60"), 60.0, 5.0)],
)
def test_it_takes_as_long_as_was_asked_for(qualify, options, loop_s, baseline_s):
    host = Host(0)
    qualify(host, "--rate-hz", "222.2", "--no-realtime", *options)
    ((_, settings),) = host.asked
    assert (settings.seconds, settings.baseline_s, settings.realtime) == (loop_s, baseline_s, False)


def test_the_file_holds_host_trials_and_status_with_null_for_what_is_missing(qualify, tmp_path):
    file = tmp_path / "host.json"
    result = qualify(Host(4_500_000), "--json", str(file))
    written = json.loads(file.read_text(), parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    assert [(trial["period_ns"], trial["grade"]) for trial in written["trials"]] == [
        (1_000_000, "C"),
        (2_000_000, "C"),
        (4_500_000, "A"),
    ]
    assert (written["qualified_period_ns"], written["exit_status"]) == (4_500_000, result.exit_code)
    assert written["host"]["cores"] > 0 and {fact["what"] for fact in written["found"]} >= {"SCHED_FIFO", "SMT", "kernel"}


def test_table_grade_and_reasons_are_printed(qualify):
    text = qualify(Host(10_000_000)).stdout
    assert all(
        word in text for word in ("SCHED_FIFO", "bare round trip", "222.2 Hz: grade C", "100 Hz: grade A", "late, 0.1% may be")
    )


def test_what_was_not_measured_is_a_dash(qualify):
    result = qualify(lambda settings, period, report: Measured(Figures(4_500_000), GRANTED), "--rate-hz", "222.2")
    assert result.exit_code == 1
    assert (
        not re.search(r"\bnan\b", result.stdout) and "- of 0 unanswered" in result.stdout and "no trial was run" in result.stdout
    )


def test_a_trial_too_short_for_a_qualification_ends_with_1_and_is_not_recorded(qualify):
    short = lambda settings, period, report: Measured(GOOD._replace(samples=300), GRANTED)  # noqa: E731
    result = qualify(short, "--rate-hz", "222.2")
    assert result.exit_code == 1
    assert "too short to be put on record" in result.stdout and "1000 are needed" in result.stdout
    assert standing(fifo=True).qualified is None


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [(KeyboardInterrupt(), 130, "nothing is recorded"), (CellError("port 7750 is in use"), 5, "port 7750")],
)
def test_what_does_not_come_to_its_end_is_one_line_and_not_recorded(qualify, error, status, words):
    def broken(*_):
        raise error

    result = qualify(broken)
    assert result.exit_code == status
    assert words in result.stderr and len(result.stderr.strip().splitlines()) == 1
    assert standing(fifo=True).qualified is None


def test_a_cache_that_cannot_be_written_ends_with_2_after_the_verdict(qualify, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("HYDROHIL_CACHE", str(tmp_path / "file"))
    result = qualify(Host(0))
    assert result.exit_code == 2
    assert "grade A" in result.stdout and str(tmp_path / "file") in result.stderr


def test_help_says_what_it_does_and_every_exit_status():
    text = CliRunner().invoke(app, ["qualify", "--help"]).output
    assert all(word in text for word in ("--rate-hz", "--seconds", "--quick", "--json", "--unqualified", "130"))
