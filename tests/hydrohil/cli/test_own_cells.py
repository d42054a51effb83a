"""Commands with a cell of their own bring it up where the library does, beside each other and beside a cell that is up."""

import inspect
from itertools import combinations

import pytest

from hydrohil.cell.processes import Place
from hydrohil.cli import faults_command, qualify_command
from hydrohil.faulttest import endings, orders, router, run
from hydrohil.qualification.qualify import PLACE
from hydrohil.shared.transport.endpoints import DEFAULT_PORT

PORTS_OF_A_CELL = 4


@pytest.mark.parametrize(("command", "place"), [(qualify_command.qualify, PLACE), (faults_command.faults, run.PLACE)])
def test_a_command_and_the_library_have_the_same_cell(command, place):
    defaults = {name: parameter.default for name, parameter in inspect.signature(command).parameters.items()}
    assert Place(defaults["cell"], defaults["port"]) == place


def test_no_two_of_these_cells_share_a_port():
    beside = (0, orders.PORTS, endings.PORTS, run.LOCKSTEP_PORTS, router.PORTS)
    firsts = [DEFAULT_PORT, PLACE.port, *(run.PLACE.port + ports for ports in beside)]
    assert all(abs(one - other) >= PORTS_OF_A_CELL for one, other in combinations(firsts, 2))
