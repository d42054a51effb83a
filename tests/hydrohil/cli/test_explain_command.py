"""`hydrohil explain` from options and from a pipe."""

import json

import pytest
from typer.testing import CliRunner, Result

from hydrohil.cli.main import app
from hydrohil.shared.contract.messages import GateCause, TripCause


def explain(*arguments: str, typed: str | None = None) -> Result:
    return CliRunner().invoke(app, ["explain", *arguments], input=typed)


def test_a_reset_is_refused_while_the_cause_stands_and_the_most_severe_decides():
    run = explain("--mode", "RUNNING", "--broken", "FORCE_RAW,JOINT_LIMIT", "--event", "reset", "--json")
    scene = json.loads(run.stdout)
    assert (scene["mode"], scene["cause"], scene["decides"]) == ("TRIPPED", "FORCE_RAW", "FORCE_RAW")
    assert scene["gate"]["current"] is False
    assert scene["events"]["reset"].startswith("TRIPPED")


def test_lines_come_from_a_pipe():
    run = explain(typed="arm\nstart # moves now\nbreak gate.command-stale\n\n\nwhy\nmend all\nreset\n")
    assert run.exit_code == 0, run.output
    modes = [line.split()[0].strip(";") for line in run.stdout.splitlines() if "; gate " in line or "by" in line.split()[1:2]]
    assert modes == ["ARMED", "RUNNING", "RUNNING", "RUNNING", "TRIPPED", "TRIPPED", "DISARMED"]


def test_quit_and_the_end_of_the_input_end_it():
    assert explain(typed="").exit_code == 0
    assert "RUNNING;" not in explain(typed="quit\nmode RUNNING\n").stdout


@pytest.mark.parametrize(
    ("arguments", "typed", "nearest"),
    [
        (("FORCE_RAV",), None, "FORCE_RAW"),
        (("--mode", "RUNING"), None, "RUNNING"),
        (("--broken", "gate.COMAND_STALE"), None, "gate.COMMAND_STALE"),
        (("--event", "rest"), None, "reset"),
        (("--facts", "may-arn"), None, "may_arm"),
        ((), "armm\n", "arm"),
        ((), "break joint\n", "JOINT_LIMIT"),
    ],
)
def test_an_unknown_word_names_the_nearest_and_ends_with_2(arguments: tuple[str, ...], typed: str | None, nearest: str):
    run = explain(*arguments, typed=typed)
    assert run.exit_code == 2
    assert nearest in run.stderr and len(run.stderr.splitlines()) == 1


@pytest.mark.parametrize("cause", [*(c.name for c in TripCause if c), *(f"gate.{c.name}" for c in GateCause if c)])
def test_every_cause_has_an_explanation(cause: str):
    run = explain(cause)
    assert run.exit_code == 0, run.output
    assert cause.removeprefix("gate.") in run.stdout


def test_a_cause_in_words_says_what_must_hold_its_limit_and_what_to_do():
    words = explain("force-raw").stdout
    assert "must hold" in words and "394.1" in words and "hydrohil reset" in words


def test_facts_can_be_taken_away():
    run = explain("--facts", "", "--event", "arm", "--json")
    assert json.loads(run.stdout)["mode"] == "DISARMED"
    assert json.loads(explain("--event", "arm,start", "--json").stdout)["gate"]["state"] == "OPEN"


def test_a_cause_is_printed_as_json_by_rule_and_condition():
    (rule,) = json.loads(explain("FORCE_RAW", "--json").stdout)
    assert (rule["cause"], rule["by"]) == ("FORCE_RAW", "supervisor")
    assert "394" in rule["limit"] and rule["must_hold"] and "hydrohil recover" in rule["to_do"]
    both = json.loads(explain("estop", "--json").stdout)
    assert [one["by"] for one in both] == ["supervisor", "gate"]
    assert [one["by"] for one in json.loads(explain("gate.estop", "--json").stdout)] == ["gate"]
    unknown = explain("FORCE_RAV", "--json")
    assert (unknown.exit_code, unknown.stdout) == (2, "")
