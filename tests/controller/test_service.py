"""The controller's shell without a network: what it answers to a load."""

import json

import pytest

from hydrohil.experiment.experiment import Experiment, to_plain, warnings
from hydrohil.experiment.overrides import with_overrides
from hydrohil.services.controller.actuation import Handover
from hydrohil.services.controller.config import ControllerConfig, ScheduledChange
from hydrohil.services.controller.laws.table import law_number
from hydrohil.services.controller.service import Controller
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.envelope import seal
from hydrohil.shared.contract.messages import NO_TRIAL, GateState, ParameterEvent
from hydrohil.shared.transport.requests import Request
from hydrohil.thesis.library import find
from tests.support.supervisor_scene import DESCRIPTION, sample
from tests.support.wire_scene import FakeBus, header


def loaded(experiment: Experiment, description=DESCRIPTION):
    """(accepted, reason, values) of a controller that has heard of the plant."""
    controller, answers = Controller(FakeBus()), []
    controller.description = description
    text = seal(to_plain(experiment), run=7, seed=1, clock="lockstep", tare_ticks=444, duration_ticks=100)
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
    accepted, reason, _ = loaded(find("fig-7-1"), description=None)
    assert not accepted and "has not described itself" in reason


@pytest.mark.parametrize(
    "wrong",
    [
        {"initial_q": [0.0, 0.0, 0.0]},
        {"initial_q": {"rotate": 0.0}},
        {"environment": {"kind": "plate", "stiffness_n_per_m": 0, "surface_m": 0.0}, "machine": {"sensor_stiffness_n_per_m": 0}},
    ],
)
def test_a_foreign_plant_section_is_refused_and_the_controller_lives_on(wrong):
    controller, answers = Controller(FakeBus()), []
    controller.description = DESCRIPTION
    experiment = to_plain(find("fig-7-1"))
    experiment["plant"] |= wrong
    text = seal(experiment, run=7, seed=1, clock="lockstep", tare_ticks=444, duration_ticks=100)
    controller._serve(Request("load", {"envelope": text}, lambda *answer: answers.append(answer)))
    ((accepted, reason, _),) = answers
    assert not accepted and reason


def test_link_stats_are_published_once_a_second_and_when_the_gate_is_revoked():
    controller = Controller(FakeBus())
    controller._learn(DESCRIPTION)
    for number in range(300):
        gate = GateState.REVOKED if 250 <= number < 260 else GateState.SHUT
        head = header("plant/sample", number)
        controller._answer(Received(0, "plant/sample", head, sample(number, gate=int(gate))))
    assert [message.number for message in controller.bus.of("controller/link_stats")] == [0, 222, 250]


def test_a_lockstep_commit_after_an_injection_is_refused_and_nothing_has_changed():
    bus, answers = FakeBus("controller"), []
    controller = Controller(bus)
    controller.description = DESCRIPTION

    def ask(verb, **arguments):
        controller._serve(Request(verb, arguments, lambda *answer: answers.append(answer)))
        return answers[-1]

    text = seal(to_plain(find("fig-7-1")), run=7, seed=1, clock="lockstep", tare_ticks=444, duration_ticks=100)
    digest = ask("load", envelope=text)[2]["digest"]
    before = controller.config
    assert ask("inject", fault={"kind": "loss", "target": "plant>controller", "value": 0.5})[0]
    accepted, reason, _ = ask("commit", digest=digest)
    assert not accepted and "--clear" in reason
    assert controller.config == before and bus.run.run == 0


PERIOD_NS = DESCRIPTION.sample_period_ns


class Cell:
    """A controller in a trial of 30 negative ticks, and whoever asks it."""

    def __init__(self, experiment, clock="real"):
        self.bus, self.number, self.dac = FakeBus("controller"), 0, (2048, 2048, 2048)
        self.controller = Controller(self.bus)
        self.controller._learn(DESCRIPTION)
        text = seal(to_plain(experiment), run=7, seed=1, clock=clock, tare_ticks=30, duration_ticks=10_000)
        accepted, reason, values = self.ask("load", envelope=text)
        assert accepted, reason
        assert self.ask("commit", digest=values["digest"])[0]

    def ask(self, verb, **arguments):
        """(accepted, reason, values); None while nothing is answered."""
        answers = []
        self.controller._serve(Request(verb, arguments, lambda *answer: answers.append(answer)))
        self.controller.parameters.examine()
        self.answers = answers
        return answers[-1] if answers else None

    def sample(self, tick=NO_TRIAL):
        gate = GateState.OPEN if tick > 0 else GateState.SHUT
        body = sample(
            self.number,
            tick,
            gate=int(gate),
            gate_open_samples=max(0, tick),
            trial_time_ns=max(0, tick) * PERIOD_NS,
            dac_counts=self.dac,
        )
        self.controller._answer(Received(0, "plant/sample", header("plant/sample", self.number), body))
        self.number += 1
        codes = self.bus.of("controller/command")[-1].dac_counts
        self.dac = codes if tick >= 0 else self.dac
        return codes

    def to_tick(self, tick):
        for one in range(-30, tick + 1):
            self.sample(one)
        return self


SWING = find("fig-4-25")._replace(controller=ControllerConfig(target="joint"))
PRESS = find("fig-5-5")


def test_a_change_acts_at_the_next_sample_which_the_answer_names_and_is_published_value_by_value():
    cell = Cell(SWING).to_tick(40)
    assert cell.ask("parameters", set=["controller.law=pi", "controller.gains.down_up.kp_a_per_rad=3"]) is None
    number, before = cell.number, cell.controller.params
    cell.sample(41)
    ((accepted, _, values),) = cell.answers
    assert accepted and values["number"] == number and values["ramp_samples"] == 1
    assert [one["path"] for one in values["changed"]] == ["controller.law", "controller.gains.down_up.kp_a_per_rad"]
    law, gain = cell.bus.of("controller/parameter_change")
    assert law == ParameterEvent(
        number=number, tick=41, by_hand=1, path="controller.law", old='"final"', new='"pi"', ramp_samples=1
    )
    assert (gain.old, gain.new) == (repr(before.gains[1].kp_a_per_q), "3.0")
    assert cell.controller.params == before._replace(
        law=law_number("pi"), gains=(before.gains[0], before.gains[1]._replace(kp_a_per_q=3.0), before.gains[2])
    )
    assert cell.controller.memory.handover == Handover((0, 0, 0), number + cell.controller.config.tight_samples)
    assert cell.controller.status()["changed"][0] == 'controller.law "final" -> "pi"'


def warmed_up(cell, number):
    """Rehearsals so far, after a warm-up frame of sample `number`, which changes no memory and publishes nothing."""
    before = cell.controller.memory, len(cell.bus.published)
    cell.bus.send(
        "plant/warmup", header("plant/warmup", number, echo_number=number), sample(number, 40, gate=int(GateState.OPEN))
    )
    cell.controller.step()
    assert (cell.controller.memory, len(cell.bus.published)) == before
    return cell.controller.status()["warmed_up"]


def test_a_warmup_of_the_last_sample_is_computed_and_leaves_no_trace():
    cell, other = Cell(SWING), Cell(SWING)
    for one in (cell, other):
        head = header("plant/sample", 0, echo_number=0)
        one.bus.send("plant/sample", head, sample(0, -30))
        one.controller.step()
    assert warmed_up(cell, 0) == 1
    assert cell.to_tick(40).bus.of("controller/command") == other.to_tick(40).bus.of("controller/command")


@pytest.mark.parametrize("number", [1, -1])
def test_a_warmup_of_another_sample_is_left_alone(number):
    cell = Cell(SWING)
    cell.bus.send("plant/sample", header("plant/sample", 0, echo_number=0), sample(0, -30))
    cell.controller.step()
    assert warmed_up(cell, number) == 0


def test_a_warmup_before_the_plant_has_described_itself_is_left_alone():
    bus = FakeBus("controller")
    controller = Controller(bus)
    bus.send("plant/warmup", header("plant/warmup"), sample(0))
    controller.step()
    assert controller.status()["warmed_up"] == 0


def test_after_the_trial_and_after_a_load_the_loaded_values_are_back():
    cell = Cell(SWING).to_tick(40)
    loaded = cell.controller.params
    cell.ask("parameters", set=["controller.law=pi"])
    cell.sample(41)
    assert cell.controller.params != loaded
    cell.sample()
    assert cell.controller.params == loaded and cell.controller.status()["changed"] == [] and not cell.controller.parameters.busy
    assert [event["path"] for event in cell.controller.status()["by_hand"]] == ["controller.law"]
    cell.controller.parameters.load(cell.controller.parameters.loaded)
    assert cell.controller.status()["by_hand"] == []


def test_a_target_moves_sample_by_sample_and_ends_at_what_was_asked():
    cell = Cell(PRESS).to_tick(40)
    asked = ["controller.impedance.stiffness_n_per_m=100e3"]
    assert cell.ask("parameters", set=asked) is None
    while cell.controller.parameters._requested is not None:
        cell.controller.parameters.examine()
    for tick in range(41, 41 + 112):
        cell.sample(tick)
        stiffness_n_per_m = cell.controller.params.impedance.stiffness_n_per_m
        assert stiffness_n_per_m == pytest.approx(50e3 * 2.0 ** (min(1.0, (tick - 40) / 111)))
    assert stiffness_n_per_m == 100e3
    assert cell.answers[0][2]["warnings"] == []
    (event,) = cell.bus.of("controller/parameter_change")
    assert (event.tick, event.ramp_samples, event.old, event.new) == (41, 111, "50000.0", "100000.0")


def test_a_target_that_must_limit_cycle_is_taken_with_the_warning_of_a_load():
    cell = Cell(PRESS).to_tick(40)
    cell.ask("parameters", set=["controller.impedance.stiffness_n_per_m=1000"])
    while cell.controller.parameters._requested is not None:
        cell.controller.parameters.examine()
    cell.sample(41)
    loaded = with_overrides(PRESS, ["controller.impedance.stiffness_n_per_m=1000"])
    assert tuple(cell.answers[0][2]["warnings"]) == warnings(loaded) != ()
    scheduled = PRESS._replace(changes=(ScheduledChange(1.0, ("controller.impedance.stiffness_n_per_m=1000",)),))
    assert warnings(scheduled) == warnings(loaded)


def test_a_soft_target_whose_push_leaves_the_travel_is_refused_as_at_a_load():
    cell = Cell(find("fig-5-2")).to_tick(40)
    before = cell.controller.params
    cell.ask("parameters", set=["controller.impedance.stiffness_n_per_m=50"])
    while cell.controller.parameters._requested is not None:
        cell.controller.parameters.examine()
    ((accepted, reason, _),) = cell.answers
    assert not accepted and "beyond the travel" in reason
    cell.sample(41)
    assert cell.controller.params == before and not cell.bus.of("controller/parameter_change")


@pytest.mark.parametrize(
    ("requested", "words"),
    [
        (["controller.law=bang"], "controller.law is 'bang'"),
        (["controller.gains.down_up.kp_a_per_rad=-1"], "greater than or equal to 0"),
        (["controller.law=pi", "controller.slew_codes=100"], "slew_codes stays"),
        (["supervisor.force_limit_n=1"], "only [controller]"),
        ([], "nothing would change"),
        ("controller.law=pi", "no list"),
        ([3], "no list"),
        (["controller.law=1979-05-27"], "use text, numbers"),
        (["controller.law=" + "[" * 100_000], "controller.law is"),
        (["controller.gains.down_up.kp_a_per_rad=1e400"], "kp_a_per_rad"),
        (["controller.gains.down_up.kp_a_per_rad=" + "9" * 5000], "digits"),
    ],
)
def test_what_may_not_be_is_refused_at_once_and_nothing_changes(requested, words):
    cell = Cell(SWING).to_tick(40)
    before = cell.controller.params
    accepted, reason, _ = cell.ask("parameters", set=requested)
    assert not accepted and words in reason
    cell.sample(41)
    assert cell.controller.params == before and not cell.bus.of("controller/parameter_change")


def test_without_an_experiment_outside_a_trial_and_in_lockstep_it_is_refused():
    requested = ["controller.law=pi"]
    alone = Controller(FakeBus())
    answers = []
    alone._serve(Request("parameters", {"set": requested}, lambda *answer: answers.append(answer)))
    assert "no experiment is loaded" in answers[0][1]
    cell = Cell(SWING)
    cell.sample()
    assert "no trial runs" in cell.ask("parameters", set=requested)[1]
    assert "lockstep" in Cell(SWING, "lockstep").to_tick(3).ask("parameters", set=requested)[1]


def test_a_second_change_waits_for_the_first_and_one_that_the_trials_end_overtakes_is_refused():
    cell = Cell(SWING).to_tick(40)
    assert cell.ask("parameters", set=["controller.law=pi"]) is None
    first = cell.answers
    assert "another change" in cell.ask("parameters", set=["controller.law=morse"])[1]
    cell.sample()
    assert not first[0][0] and "ended before" in first[0][1]
    assert not cell.bus.of("controller/parameter_change")


def test_what_the_experiment_schedules_acts_at_its_tick_in_every_trial_and_is_published_as_such():
    changes = (ScheduledChange(0.09, ("controller.law=pi",)),)
    cell = Cell(SWING._replace(changes=changes), "lockstep")
    for _ in range(2):
        cell.to_tick(19)
        assert cell.controller.params.law == law_number("final")
        cell.sample(20)
        assert cell.controller.params.law == law_number("pi")
        assert "lockstep" in cell.ask("parameters", set=["controller.law=morse"])[1]
        cell.sample()
        assert cell.controller.params.law == law_number("final")
    assert [(event.tick, event.by_hand) for event in cell.bus.of("controller/parameter_change")] == [(20, 0), (20, 0)]
    real = Cell(SWING._replace(changes=changes)).to_tick(3)
    assert "[[changes]]" in real.ask("parameters", set=["controller.law=morse"])[1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"at_s": 1.0, "set": ["controller.tight_samples=0"]}, "changes.0: controller.tight_samples stays"),
        ({"at_s": -0.1, "set": ["controller.law=pi"]}, "changes.0.at_s"),
        ({"at_s": 1.0, "set": []}, "changes.0.set"),
    ],
)
def test_a_schedule_that_may_not_be_is_refused_with_the_load(change, words):
    controller, answers = Controller(FakeBus()), []
    controller.description = DESCRIPTION
    text = seal(to_plain(SWING) | {"changes": [change]}, run=7, seed=1, clock="real", tare_ticks=444, duration_ticks=100)
    controller._serve(Request("load", {"envelope": text}, lambda *answer: answers.append(answer)))
    ((accepted, reason, _),) = answers
    assert not accepted and words in reason
