import pytest

from hydrohil.services.controller.config import ControllerConfig
from hydrohil.shared.contract.assignments import nearest, parsed, put, written
from hydrohil.shared.contract.link_units import plain_of

CONFIG = ControllerConfig()


@pytest.mark.parametrize(
    ("text", "path", "value"),
    [
        ("law=pi", "law", "pi"),
        (' a.b = "x = y" ', "a.b", "x = y"),
        ("a=3", "a", 3),
        ("a=3.0", "a", 3.0),
        ("a=[true, false]", "a", [True, False]),
        ("a=b = c", "a", "b = c"),
        ("a=", "a", ""),
    ],
)
def test_an_assignment_is_a_path_and_a_toml_value_or_bare_text(text, path, value):
    found = parsed(text)
    assert found == (path, value)
    assert type(found[1]) is type(value)


@pytest.mark.parametrize("text", ["", "law", "=pi", "  = 3"])
def test_without_a_path_or_a_sign_it_is_refused(text):
    with pytest.raises(ValueError, match=r"such as controller\.law=pi"):
        parsed(text)


@pytest.mark.parametrize("value", ["pi", 3, 3.0, True, [1.0, 2.5], {"a": "ü", "b": [True]}])
def test_what_is_written_is_read_as_the_same_value(value):
    assert parsed(written("a.b", value)) == ("a.b", value)


def test_a_value_is_put_where_the_path_leads_and_nowhere_else():
    plain = {"controller": plain_of(CONFIG)}
    put(plain, "controller.gains.down_up.kp_a_per_rad", 3.0)
    put(plain, "controller.gains.out_in.kp_a_per_m", 4.0)
    kept = plain_of(CONFIG)
    kept["gains"]["down_up"]["kp_a_per_rad"], kept["gains"]["out_in"]["kp_a_per_m"] = 3.0, 4.0
    assert plain == {"controller": kept}


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("controller.lav", "lav is no field of controller; use one of law"),
        ("controller.law.x", "controller.law is a value without fields"),
        ("controller.gains.2", "controller.gains.2 is no field: links go by name; use one of rotate, down_up, out_in"),
        ("plant", "plant is no field of an experiment; use one of controller"),
    ],
)
def test_a_path_that_leads_nowhere_is_refused_with_the_names_that_there_are(path, words):
    with pytest.raises(ValueError) as refused:
        put({"controller": plain_of(CONFIG)}, path, 0)
    assert words in str(refused.value)


def test_the_nearest_names_come_first_and_all_names_if_none_is_near():
    assert nearest("stifness", ["stiffness", "mass"]) == "stiffness"
    assert nearest("qqq", ["b", "a"]) == "a, b"
    assert nearest("qqq", ["b", "a"], "those of the list") == "those of the list"
