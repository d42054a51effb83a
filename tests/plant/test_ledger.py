import pytest

from hydrohil.services.plant.gate import NO_COMMAND_OBSERVATION, NO_PERMIT_OBSERVATION
from hydrohil.services.plant.ledger import IMPOSSIBLE, Ledger


def test_an_age_is_what_passed_on_the_plants_own_clock():
    ledger = Ledger()
    ledger.issue(7, 31_500_000, 1000)
    assert ledger.age(7, 31_500_000, 1000) == 0
    assert ledger.age(7, 31_500_000, 5000) == 4000


@pytest.mark.parametrize(
    ("number", "time_ns", "now"),
    [(8, 31_500_000, 5000), (6, 31_500_000, 5000), (7, 31_500_001, 5000), (7, 31_500_000, 999), (7, 31_500_000, 0)],
)
def test_an_echo_that_equals_no_issued_sample_exactly_is_impossible(number, time_ns, now):
    ledger = Ledger()
    ledger.issue(7, 31_500_000, 1000)
    assert ledger.age(number, time_ns, now) == IMPOSSIBLE == NO_PERMIT_OBSERVATION.age_ns == NO_COMMAND_OBSERVATION.age_ns == -1


def test_nothing_is_possible_before_the_first_sample():
    assert Ledger().age(-1, 0, 0) == IMPOSSIBLE
    assert Ledger().age(0, 0, 0) == IMPOSSIBLE


def test_the_ledger_is_bounded_and_remembers_longer_than_any_lease():
    ledger = Ledger()
    for number in range(1000):
        ledger.issue(number, number, number)
    possible = [number for number in range(1000) if ledger.age(number, number, 1000) != IMPOSSIBLE]
    assert possible == list(range(1000 - 512, 1000))
