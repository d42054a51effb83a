"""`hydrohil trip` shows a report again; the local clock and a cell without a recorder leave one too."""

import csv
import json
import os
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from hydrohil.cli.main import app
from hydrohil.cli.run import kept_file
from hydrohil.pages.trip_page import page
from hydrohil.recording.trips import TRIPS
from hydrohil.shared.trips.files import read, reports, write
from tests.support.trip_scene import TRIP_NUMBER, report


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def trip(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["trip", *arguments])


def test_the_newest_report_is_shown():
    first, second = (write(TRIPS, report(by) | {"signals": {}}) for by in ("gate", "supervisor"))
    os.utime(first, (1, 1))
    shown = trip()
    assert shown.exit_code == 0
    assert report()["sentence"] in shown.stdout and str(second) in shown.stdout
    assert report("gate")["sentence"] in trip(str(first)).stdout


def test_json_is_the_report_without_the_signals():
    path = write(TRIPS, report())
    assert json.loads(trip(str(path), "--json").stdout) == {k: v for k, v in report().items() if k != "signals"}


def test_tables_hold_every_signal_exactly(tmp_path: Path):
    write(TRIPS, report())
    assert trip("--csv", "signals").exit_code == 0
    document = report()
    for topic, table in document["signals"].items():
        with (tmp_path / "signals" / f"{topic.replace('/', '-')}.csv").open() as file:
            head, *rows = csv.reader(file)
        assert head == list(table)
        assert [[float(cell) for cell in row] for row in rows] == [
            [float(v) for v in row] for row in zip(*table.values(), strict=True)
        ]


def test_the_page_has_words_and_plots_and_needs_nothing_else(tmp_path: Path):
    write(TRIPS, report())
    assert trip("--html", "trip.html").exit_code == 0
    text = (tmp_path / "trip.html").read_text()
    assert report()["sentence"] in text and "<svg" in text
    assert "http" not in text.replace("http://www.w3.org", "") and "<script" not in text


def test_each_plot_of_the_page_names_its_own_curves():
    _, *plots = page(report()).split("<svg")
    for plot, unit, curves in zip(
        plots,
        ("force in N", "tip moved, mm", "joints moved, deg, cm", "valves in mA"),
        (("tared", "true contact"), (">x<", ">y<", ">z<"), ("rotate", "down/up", "out/in"), ("rotate", "down/up", "out/in")),
        strict=True,
    ):
        assert unit in plot and all(curve in plot for curve in curves)


def test_a_page_of_few_signals_shows_those_that_there_are():
    document = report()
    few = {topic: document["signals"][topic] for topic in ("plant/sample",)}
    assert "<svg" in page(document | {"signals": few})


@pytest.mark.parametrize("arguments", [(), ("none.json",)])
def test_no_report_is_one_line_and_2(arguments: tuple[str, ...]):
    run = trip(*arguments)
    assert run.exit_code == 2 and len(run.stderr.splitlines()) == 1


def test_what_is_no_report_is_one_line_and_2(tmp_path: Path):
    (tmp_path / "x.json").write_text("{}")
    run = trip("x.json")
    assert run.exit_code == 2 and "is no trip report" in run.stderr


def test_without_a_recorder_the_command_writes_the_report_itself():
    path = kept_file(report())
    assert read(Path(path))["sample"] == TRIP_NUMBER


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path: Path, capsys):
    (tmp_path / "runs").write_text("")
    assert kept_file(report()) == ""
    assert capsys.readouterr().err.count("\n") == 1


def test_a_trip_on_the_local_clock_leaves_the_same_report(tmp_path: Path):
    line = ["run", "fig-5-5", "--clock", "local", "--set", "supervisor.force_limit_n=50.0", "--json", "r.json"]
    run = CliRunner().invoke(app, line)
    assert run.exit_code == 3, run.output
    (file,) = reports(TRIPS)
    document = read(file)
    assert document["sentence"] in run.stdout.replace("\n", "") and file.name in run.stdout
    run_report = json.loads((tmp_path / "r.json").read_text())
    assert run_report["trip"]["tick"] == document["tick"] and run_report["trip_report"] == str(file)
    assert document["cause"] == "FORCE_TARED" and document["measured"] > 50.0
    assert (document["cell"], document["experiment"]) == ("local", "fig-5-5")
    assert "experiment fig-5-5" in trip().stdout
    assert document["stop"]["samples_later"] == 1
    assert document["signals"]["supervisor/permit"]["trip_number"][-1] == document["sample"]
    assert document["signals"]["controller/state"]["tick"][-1] == document["tick"]
