"""A cell that was closed says so, whatever it is asked for."""

from contextlib import nullcontext
from typing import cast

import pytest

import hydrohil as hh
from hydrohil.shared.transport.bus import Bus


def test_a_closed_cell_is_one_clear_line_and_closes_twice():
    cell = hh.Cell._of(nullcontext(cast("Bus", object())))
    cell.close()
    cell.close()
    experiment = hh.load("fig-4-25")
    for use in (cell.status, cell.estop, cell.stop, cell.reset, cell.clear, lambda: cell.run(experiment)):
        with pytest.raises(hh.CellError, match="the cell is closed: bring up or attach to another"):
            use()
