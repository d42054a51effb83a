from pathlib import Path

from hydrohil.experiment.merging import merged, named


def test_a_table_keeps_what_is_not_named():
    assert merged({"a": 1, "b": {"c": 2, "d": 3}}, {"b": {"d": 4}}) == {"a": 1, "b": {"c": 2, "d": 4}}


def test_a_list_is_replaced_as_a_whole():
    assert merged({"reference": [1, 2, 3]}, {"reference": [4]}) == {"reference": [4]}


def test_a_value_takes_the_place_of_a_table_and_the_reverse():
    assert merged({"a": {"b": 1}}, {"a": 2}) == {"a": 2}
    assert merged({"a": 2}, {"a": {"b": 1}}) == {"a": {"b": 1}}


def test_neither_side_is_changed():
    under, over = {"a": {"b": 1}}, {"a": {"c": 2}}
    merged(under, over)
    assert (under, over) == ({"a": {"b": 1}}, {"a": {"c": 2}})


def test_a_file_names_what_it_does_not_say():
    assert named({}, Path("My_push.toml"), "fig-5-5") == {
        "name": "my-push",
        "alias": "my-push",
        "title": "my-push",
        "source": "My_push.toml, on fig-5-5",
    }


def test_what_the_file_says_stays():
    assert named({"name": "push", "title": "A push"}, Path("x.toml")) == {
        "name": "push",
        "alias": "push",
        "title": "A push",
        "source": "x.toml",
    }


def test_a_file_name_that_can_be_no_name_gives_none():
    assert named({}, Path("Versuch 1 (neu).toml"))["name"] == "experiment"
