from types import SimpleNamespace

import pytest

from hydrohil.faulttest.observer import STEADY, ZERO, Observation, safe, stalled_s, unsafe_after, zero_at
from hydrohil.shared.contract.messages import GateState

PERIOD_NS, FAULT_NS = 4_500_000, 1_000_000_000


def sample(index: int, codes=ZERO, gate=GateState.SHUT, late_ns: int = 0):
    time_ns = FAULT_NS + index * PERIOD_NS
    values = {"number": index, "tick": index, "time_ns": time_ns, "command_age_ns": 0, "dac_counts": codes, "gate": int(gate)}
    return SimpleNamespace(arrival_ns=time_ns + 300_000 + late_ns, body=SimpleNamespace(**values))


def observed(reaction: int, shift_ns: int = 0, late_ns: int = 0) -> Observation:
    """Zero current with sample `reaction`; from there on the grid is shifted, and that sample alone comes late."""
    moving = [sample(i, (2048, 2300, 2048), GateState.OPEN) for i in range(-30, reaction)]
    still = [sample(i, late_ns=shift_ns + (late_ns if i == reaction else 0)) for i in range(reaction, reaction + 40)]
    return Observation(moving + still, [], [], [], [])


def test_zero_current_behind_an_open_gate_is_not_safe():
    assert not safe(sample(0, gate=GateState.OPEN))
    assert not safe(sample(0, gate=GateState.RECOVERING))
    assert not safe(sample(0, codes=(2048, 2049, 2048)))
    assert safe(sample(0, gate=GateState.REVOKED))


def test_the_first_message_of_zero_current_is_a_sample_or_the_gates_own():
    received = observed(5)
    assert zero_at(received, FAULT_NS) == received.samples[35].arrival_ns
    gate = SimpleNamespace(arrival_ns=FAULT_NS + 1, body=SimpleNamespace(state=int(GateState.REVOKED)))
    assert zero_at(received._replace(gates=[gate]), FAULT_NS) == FAULT_NS + 1


@pytest.mark.parametrize("shift_ns", [0, 7_000_000])
def test_a_grid_that_has_shifted_is_a_stall_and_a_message_that_comes_late_is_none(shift_ns):
    assert stalled_s(observed(5, shift_ns, late_ns=3_000_000), FAULT_NS) == pytest.approx(shift_ns / 1e9)
    assert STEADY > 1


def test_what_moves_again_after_zero_is_counted():
    received = observed(5)
    assert unsafe_after(received, FAULT_NS) == 0
    received.samples.append(sample(60, (2048, 2100, 2048), GateState.OPEN))
    assert unsafe_after(received, FAULT_NS) == 1
