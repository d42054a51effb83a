"""Loading: a rate above the one qualified is refused before anything is committed."""

import pytest
from typer.testing import CliRunner

from hydrohil.cell import session
from hydrohil.cell.processes import LOOP, UnqualifiedError
from hydrohil.cli import run
from hydrohil.cli.main import app
from hydrohil.shared.host.qualified import Qualified
from hydrohil.shared.units import SUBSTEP_NS
from hydrohil.thesis.library import find

EXPERIMENT = find("fig-4-25")
PERIOD_NS = EXPERIMENT.plant.sample_period_substeps * SUBSTEP_NS


class Cell:
    """Services that take everything; the supervisor reports what its host is qualified for."""

    def __init__(self, qualified_period_ns):
        found = Qualified(
            qualified_period_ns=qualified_period_ns,
            grade="B",
            measured_at="yesterday",
            period_ns=PERIOD_NS,
            samples=4000,
            late_share=0.0,
            accepted_p999_us=1.0,
            wake_up_max_us=1.0,
            lease_ms=20.0,
        )
        self.qualification = None if qualified_period_ns is None else found._asdict()
        self.asked = []

    def ask(self, _bus, service, verb, _timeout_s=3.0, **arguments):
        self.asked.append((service, verb, arguments))
        if verb == "status":
            return {"mode": "DISARMED", "words": "", "qualification": self.qualification}
        return {"digest": "00"} | ({"qualification": self.qualification} if service == "supervisor" else {})

    @property
    def committed(self):
        return [service for service, verb, _ in self.asked if verb == "commit"]


def load(cell, monkeypatch, clock="real", **options):
    monkeypatch.setattr(session, "ask", cell.ask)
    return session.load(None, EXPERIMENT, 0, clock, **options)


@pytest.mark.parametrize("qualified_period_ns", [PERIOD_NS, PERIOD_NS - SUBSTEP_NS, None])
def test_a_qualified_rate_and_a_host_without_a_record_are_loaded(qualified_period_ns, monkeypatch):
    cell = Cell(qualified_period_ns)
    load(cell, monkeypatch)
    assert cell.committed == list(LOOP)


@pytest.mark.parametrize("qualified_period_ns", [PERIOD_NS + SUBSTEP_NS, 0])
def test_a_rate_just_above_the_qualified_one_is_refused_and_nothing_is_committed(qualified_period_ns, monkeypatch):
    cell = Cell(qualified_period_ns)
    with pytest.raises(UnqualifiedError, match=r"222\.2 Hz.*hydrohil qualify.*--unqualified"):
        load(cell, monkeypatch)
    assert cell.committed == []


def test_on_purpose_or_in_lockstep_it_is_loaded_and_the_supervisor_knows_which(monkeypatch):
    for options in ({"unqualified": True}, {"clock": "lockstep"}):
        cell = Cell(0)
        load(cell, monkeypatch, **options)
        assert cell.committed == list(LOOP)
        unqualified = [
            arguments["unqualified"] for service, verb, arguments in cell.asked if (service, verb) == ("supervisor", "load")
        ]
        assert unqualified == [options.get("unqualified", False)]


def test_the_command_line_ends_with_2_and_one_line(monkeypatch):
    def refuse(*_, **__):
        raise UnqualifiedError("too fast")

    monkeypatch.setattr(run, "run_live", refuse)
    result = CliRunner().invoke(app, ["run", "fig-4-25"])
    assert (result.exit_code, result.stderr.strip()) == (2, "too fast")
