import pytest

from hydrohil.services.plant.cause_values import cause_values
from hydrohil.services.plant.gate import GateMemory
from hydrohil.shared.contract.messages import GateCause
from tests.support.gate_scene import (
    ARMING_ID,
    COMMAND,
    FINE,
    LIMITS,
    PERMIT,
    TTL,
    codes,
    command,
    opened,
    permit,
    recovering,
    step,
)

CROSSED = LIMITS._replace(min_force_counts=6, max_force_counts=5)
LOOSE = LIMITS._replace(tight_samples=0, slew_codes=200)
AT_ONCE = LOOSE._replace(slew_codes=2456)


@pytest.mark.parametrize(
    ("cause", "observed", "limits", "values"),
    [
        (GateCause.PERMIT_STALE, permit(age_ns=TTL + 1), LIMITS, (0.020000001, 0.02)),
        (GateCause.COMMAND_STALE, command(age_ns=2 * TTL), LIMITS, (0.04, 0.02)),
        (GateCause.OUT_OF_RANGE, codes(2048, 3277, 0), LIMITS, (3277.0, 3276.0)),
        (GateCause.OUT_OF_RANGE, codes(819, 2048, 2048), LIMITS, (819.0, 820.0)),
        (GateCause.OUT_OF_RANGE, codes(820, 3276, 3277), AT_ONCE, (3277.0, 3276.0)),
        (GateCause.OUT_OF_RANGE, codes(820, 3276, 819), AT_ONCE, (819.0, 820.0)),
        (GateCause.BEYOND_SLEW, codes(2048, 1947, 2048), LIMITS, (101.0, 100.0)),
        (GateCause.BEYOND_SLEW, codes(2048, 2048, 2249), LOOSE, (201.0, 200.0)),
        (GateCause.FORCE_INVALID, FINE._replace(force_counts=518), LIMITS, (518.0, 518.0)),
        (GateCause.FORCE_INVALID, FINE._replace(force_counts=-1), LIMITS, (-1.0, 0.0)),
        (GateCause.FORCE_INVALID, FINE._replace(force_counts=6), CROSSED, (6.0, 5.0)),
        (GateCause.FORCE_INVALID, FINE._replace(force_counts=5), CROSSED, (5.0, 6.0)),
        (GateCause.FORCE_ABOVE_LIMIT, FINE._replace(force_n=420.5), LIMITS, (420.5, 420.0)),
        (GateCause.NOT_UNLOADING, recovering(2048, 2049, 2048), LIMITS, (2049.0, 2048.0)),
        (GateCause.NOT_UNLOADING, recovering(2049, 2048, 2048), LIMITS, (2049.0, 2048.0)),
        (GateCause.NOT_UNLOADING, recovering(2048, 2000, 1999), LIMITS, (1999.0, 2048.0)),
        (GateCause.NOT_UNLOADING, recovering(2048, 1348, 2047), AT_ONCE, (2047.0, 2048.0)),
        (GateCause.NOT_UNLOADING, recovering(2048, 2047, 2049), AT_ONCE, (2049.0, 2048.0)),
        (GateCause.NOT_UNLOADING, recovering(2048, 1347, 2048), AT_ONCE, (1347.0, 1348.0)),
        (GateCause.LINK_FAULTS, FINE._replace(link_faults=3), LIMITS, (3.0, 1.0)),
        (GateCause.TWO_PUBLISHERS, FINE._replace(epoch_conflicts=2), LIMITS, (2.0, 1.0)),
        (GateCause.ESTOP, FINE._replace(estop=True), LIMITS, (0.0, 0.0)),
    ],
)
def test_a_decision_has_the_numbers_that_it_rests_on(cause, observed, limits, values):
    before = GateMemory()
    assert step(before, observed, limits).cause == cause
    assert cause_values(int(cause), before, observed, limits) == pytest.approx(values)


def test_a_step_counts_from_where_the_codes_stood():
    before = step(opened(), codes(2140, 2048, 2048))
    assert cause_values(int(GateCause.BEYOND_SLEW), before, codes(2000, 2048, 2048), LIMITS) == (140.0, 100.0)


@pytest.mark.parametrize("cause", list(GateCause))
def test_every_cause_has_its_numbers_or_none_whatever_was_observed(cause):
    assert PERMIT.arming_id == COMMAND.arming_id == ARMING_ID
    assert all(type(value) is float for value in cause_values(int(cause), GateMemory(), FINE, LIMITS))


@pytest.mark.parametrize("cause", [GateCause.OUT_OF_RANGE, GateCause.NOT_UNLOADING])
def test_where_no_code_is_beyond_there_is_no_number(cause):
    for observed in (FINE, recovering(2048, 2000, 2048)):
        assert cause_values(int(cause), GateMemory(), observed, LIMITS) == (0.0, 0.0)
