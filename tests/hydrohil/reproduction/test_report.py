import json
import math

from hydrohil.claims.claims import verdict
from hydrohil.pages.drawing import Drawing
from hydrohil.reproduction.jobs import Done, Job
from hydrohil.reproduction.plan import Group, choose
from hydrohil.reproduction.play import Found
from hydrohil.reproduction.report import gathered, machine, to_json
from tests.support.reproduction_scene import CLAIM, SVG, computed, report, trial


def test_a_machine_reads_the_counts_the_failures_and_every_number():
    document = json.loads(to_json(report(trial(18), computed())))
    assert (document["claims"], document["hold"], document["exit_status"], document["seeds"]) == (2, 1, 1, 20)
    assert document["fail"] == [{"figure": "fig-5-9", "statement": CLAIM.statement, "why": None}]
    claim = document["figures"][0]["claims"][0]
    assert (claim["held"], claim["seeds"], claim["holds"], len(claim["measured"])) == (18, 20, False, 20)


def test_a_number_that_is_none_is_null():
    result = report(trial(1, 1)._replace(tallies=(trial(1, 1).tallies[0]._replace(measured=(math.nan,)),)))
    claim = json.loads(to_json(result))["figures"][0]["claims"][0]
    assert claim["measured"] == [None] and claim["mean"] is None


def test_seeds_come_in_their_order_however_they_end():
    (figure,) = choose(["fig-5-9"])
    group = Group(("fig-5-9",), ("fig-5-9",))
    done = [
        Done(
            Job(group, seed, seed == 0),
            (Found("fig-5-9", (verdict(CLAIM, float(seed)),)),),
            {"fig-5-9": (Drawing("", SVG),)} if not seed else {},
            0.0,
        )
        for seed in (2, 0, 1)
    ]
    (result,) = gathered((figure,), done)
    assert result.tallies[0].measured == (0.0, 1.0, 2.0)
    assert result.drawings == (Drawing("", SVG),)


def test_the_machine_names_its_python():
    assert "Python 3" in machine()
