"""The search for the largest value that passes."""

import pytest

from hydrohil.tuning.search import Found, Tried, largest


def below(limit, values=None):
    def judge(value):
        if values is not None:
            values.append(value)
        return Tried(value, value <= limit, (value,))

    return judge


@pytest.mark.parametrize("start", [1.0, 10.0, 300.0, 5e3])
@pytest.mark.parametrize("factor", [1.4, 2.0])
def test_the_limit_is_found_from_below_and_from_above(start, factor):
    found = largest(below(275.0), start, factor, 1e6, 1e-3, 0.03)
    assert found.bounded
    assert 275.0 / 1.03 <= found.largest.value <= 275.0
    assert [one.value for one in found.tried] == sorted(one.value for one in found.tried)


def test_a_limit_that_is_hit_exactly_passes():
    assert largest(below(8.0), 1.0, 2.0, 1e6, 1e-3, 1.0).largest.value == 8.0


def test_without_a_limit_the_search_ends_at_the_ceiling_and_says_so():
    found = largest(below(1e9), 1.0, 2.0, 100.0, 1e-3, 0.03)
    assert not found.bounded
    assert found.largest.value == 64.0
    assert max(one.value for one in found.tried) <= 100.0


def test_if_nothing_passes_there_is_no_largest_and_nothing_below_the_floor_is_tried():
    found = largest(below(-1.0), 1.0, 2.0, 1e6, 0.1, 0.03)
    assert found.largest is None and found.bounded
    assert min(one.value for one in found.tried) >= 0.1


def test_a_value_that_passes_above_one_that_failed_is_not_taken():
    found = Found((Tried(1.0, True, ()), Tried(2.0, False, ()), Tried(3.0, True, ())), True)
    assert found.largest == Tried(1.0, True, ())


def test_no_value_is_tried_twice():
    values: list[float] = []
    largest(below(275.0, values), 1.0, 2.0, 1e6, 1e-3, 0.03)
    assert len(values) == len(set(values))
