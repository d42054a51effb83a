import pytest

from hydrohil.experiment.unusual import unusual


@pytest.mark.parametrize(("value", "found"), [(9.999, []), (10.0, [("a.b", 10.0, 1.0)]), (-10.0, [("a.b", -10.0, 1.0)])])
def test_ten_times_the_default_is_unusual_and_just_below_is_not(value, found):
    assert list(unusual({"a": {"b": value}}, {"a": {"b": 1.0}})) == found


def test_a_default_of_zero_and_what_is_no_number_say_nothing():
    assert not list(unusual({"a": 5.0, "b": True, "c": "pi"}, {"a": 0.0, "b": False, "c": "final"}))


def test_lists_are_compared_element_by_element():
    assert list(unusual({"a": [1, 50]}, {"a": [1, 2]})) == [("a.1", 50.0, 2.0)]


def test_what_has_no_default_says_nothing():
    assert not list(unusual({"a": {"b": 100.0}}, {}))
