"""What must be agreed on before the supervisor arms, one condition at a time."""

import pytest

from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.prearm_checks import Declared, prearm_problem
from hydrohil.shared.contract.envelope import seal, unseal
from hydrohil.shared.machine.description import machine_id
from hydrohil.shared.transport.bus import Run
from tests.support.supervisor_scene import DESCRIPTION
from tests.support.wire_scene import header

ENVELOPE = unseal(seal({}, run=7, seed=1, clock="real", tare_ticks=8, duration_ticks=100))
OURS = Run(7, ENVELOPE.digest, 0)
PLANT, CONTROLLER = (header(key, run=7, experiment=ENVELOPE.digest) for key in ("plant/sample", "controller/state"))
DESCRIBED = header("plant/description", run=7, experiment=ENVELOPE.digest)
MACHINE = machine_id(DESCRIPTION.machine_hash)
AGREED = Declared(
    envelope=ENVELOPE,
    config=SupervisorConfig(),
    description=DESCRIPTION,
    run=OURS,
    plant=PLANT,
    controller=CONTROLLER,
    described=DESCRIBED,
    machine_id=MACHINE,
    driven_id=MACHINE,
    beyond_qualified="",
)
LIMIT_N = SupervisorConfig().force_limit_n


def test_where_everything_is_known_and_equal_nothing_keeps_it_from_arming():
    assert prearm_problem(AGREED) == ""


def test_any_lease_that_the_plant_has_chosen_is_one():
    assert prearm_problem(AGREED._replace(description=DESCRIPTION._replace(permit_ttl_ns=1))) == ""


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"envelope": None}, "no experiment is loaded"),
        ({"controller": None}, "no controller has answered"),
        ({"description": None}, "still measures this host"),
        ({"description": DESCRIPTION._replace(permit_ttl_ns=0)}, "still measures this host"),
        ({"description": DESCRIPTION._replace(gate_force_limit_n=LIMIT_N)}, "do not stay below the gate's 334.091 N"),
        ({"description": DESCRIPTION._replace(gate_force_limit_n=float("nan"))}, "do not stay below the gate's"),
        ({"plant": PLANT._replace(run=8)}, "the plant has another experiment or run"),
        ({"plant": PLANT._replace(experiment=b"another")}, "the plant has another experiment or run"),
        ({"controller": CONTROLLER._replace(run=8)}, "the controller has another experiment or run"),
        ({"described": None}, "the plant has not described its machine since the load"),
        ({"described": DESCRIBED._replace(run=8)}, "the plant has not described its machine since the load"),
        ({"described": DESCRIBED._replace(epoch=PLANT.epoch + 1)}, "the machine was described by another process than the plant"),
        ({"driven_id": 0}, "drives another machine (000000000000) than the plant describes (unimate, "),
        ({"driven_id": MACHINE + 1}, "drives another machine"),
        ({"beyond_qualified": "too fast for this host"}, "too fast for this host"),
    ],
)
def test_each_condition_alone_is_named(changes, words):
    assert words in prearm_problem(AGREED._replace(**changes))
