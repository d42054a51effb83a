"""What `hydrohil estop` may say: only the codes of gate and converter confirm a stop."""

import json

import pytest

from hydrohil.cell.emergency import outcome
from hydrohil.cli.status_table import plant_state
from hydrohil.shared.contract.messages import Answer

ZERO, STUCK = [2048, 2048, 2048], [2048, 2700, 2048]


def answer(accepted=1, **values):
    return Answer(accepted, "", json.dumps(values).encode())


@pytest.mark.parametrize(
    "reply",
    [None, answer(0, dac_counts=ZERO, dac_readback=ZERO), answer(), answer(dac_counts=STUCK, dac_readback=ZERO)],
)
def test_without_the_gates_zero_nothing_is_confirmed(reply):
    confirmed, words = outcome(reply)
    assert not confirmed and words.startswith("NOT CONFIRMED") and "cut the hydraulic supply" in words


def test_a_converter_that_reads_back_another_code_is_not_confirmed_and_the_code_is_named():
    confirmed, words = outcome(answer(dac_counts=ZERO, dac_readback=STUCK))
    assert not confirmed and words.startswith("NOT CONFIRMED") and "2048, 2700, 2048" in words


def test_zero_at_gate_and_converter_is_confirmed():
    assert outcome(answer(dac_counts=ZERO, dac_readback=ZERO)) == (
        True,
        "stopped: zero current at the D/A, read back; `hydrohil reset` when the cause is gone",
    )


@pytest.mark.parametrize("values", [{"dac_readback": None}, {}])
def test_where_nothing_can_be_read_back_the_report_says_so(values):
    confirmed, words = outcome(answer(dac_counts=ZERO, **values))
    assert confirmed and "cannot be read back" in words


@pytest.mark.parametrize(("driven", "named"), [(None, False), (ZERO, False), (STUCK, True)])
def test_a_status_names_what_a_stuck_converter_drives(driven, named):
    found = {"number": 7, "gate": 0, "gate_cause": "ESTOP", "lease_ms": 92.951703, "dac_counts": ZERO, "dac_readback": driven}
    words = plant_state(found)
    assert "shut: ESTOP, lease 93.0 ms" in words
    assert ("2048, 2700, 2048" in words) == named
