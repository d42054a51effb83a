"""The controller's shell without a network: what it answers to a load."""

import json

import pytest
from supervisor_scene import ABOUT, sample
from wire_scene import FakeBus, header

from experiments.experiment import Experiment, to_plain, warnings
from experiments.library import find
from services.controller.service import Controller
from shared.codec import Received
from shared.envelope import seal
from shared.messages import GateState
from shared.requests import Request


def loaded(experiment: Experiment, about=ABOUT):
    """(accepted, reason, values) of a controller that has heard of the plant."""
    controller, answers = Controller(FakeBus()), []
    controller.about = about
    text = seal(to_plain(experiment), run=7, seed=1, clock="lockstep", bias_ticks=444, duration_ticks=100)
    controller._serve(Request("load", {"envelope": text}, lambda *answer: answers.append(answer)))
    ((accepted, reason, values),) = answers
    return accepted, reason, values if isinstance(values, dict) else json.loads(values or "{}")


@pytest.mark.parametrize("name", ["fig-7-1", "fig-7-3", "fig-7-4", "fig-5-2"])
def test_a_load_is_taken_with_the_warnings_that_show_prints(name):
    accepted, _, values = loaded(find(name))
    assert accepted
    assert len(values["digest"]) == 64
    assert tuple(values["warnings"]) == warnings(find(name))


def test_a_force_set_point_beyond_the_travel_is_refused_with_the_bound():
    experiment = find("fig-5-2")
    accepted, reason, _ = loaded(experiment._replace(reference=(experiment.reference[0]._replace(amount=2000.0),)))
    assert not accepted
    assert "2000 N on 500 N/m" in reason and "down/up (high, 0.471 rad)" in reason


def test_a_load_without_a_plant_is_refused():
    accepted, reason, _ = loaded(find("fig-7-1"), about=None)
    assert not accepted and "has not described itself" in reason


@pytest.mark.parametrize(
    "wrong",
    [
        {"initial_q_rad": [0.0, 0.0]},
        {"environment": {"kind": "plate", "stiffness_n_per_m": 0, "surface_m": 0.0}, "machine": {"sensor_stiffness_n_per_m": 0}},
    ],
)
def test_a_foreign_plant_section_is_refused_and_the_controller_lives_on(wrong):
    controller, answers = Controller(FakeBus()), []
    controller.about = ABOUT
    experiment = to_plain(find("fig-7-1"))
    experiment["plant"] |= wrong
    text = seal(experiment, run=7, seed=1, clock="lockstep", bias_ticks=444, duration_ticks=100)
    controller._serve(Request("load", {"envelope": text}, lambda *answer: answers.append(answer)))
    ((accepted, reason, _),) = answers
    assert not accepted and reason


def test_what_came_is_told_once_a_second_and_when_the_gate_is_burned():
    controller = Controller(FakeBus())
    controller._learn(ABOUT)
    for number in range(300):
        gate = GateState.BURNED if 250 <= number < 260 else GateState.SHUT
        head = header("plant/sample", number)
        controller._answer(Received(0, "plant/sample", head, sample(number, gate=int(gate))))
    assert [told.number for told in controller.bus.of("controller/reception")] == [0, 222, 250]


def test_a_lockstep_commit_after_an_injection_is_refused_and_nothing_has_changed():
    bus, answers = FakeBus("controller"), []
    controller = Controller(bus)
    controller.about = ABOUT

    def ask(verb, **arguments):
        controller._serve(Request(verb, arguments, lambda *answer: answers.append(answer)))
        return answers[-1]

    text = seal(to_plain(find("fig-7-1")), run=7, seed=1, clock="lockstep", bias_ticks=444, duration_ticks=100)
    digest = ask("load", envelope=text)[2]["digest"]
    before = controller.config
    assert ask("inject", fault={"kind": "loss", "target": "plant>controller", "value": 0.5})[0]
    accepted, reason, _ = ask("commit", digest=digest)
    assert not accepted and "--clear" in reason
    assert controller.config == before and bus.run.run == 0
