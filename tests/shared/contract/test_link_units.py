import pytest

from hydrohil.services.controller.params import UNIMATE_GAINS, Gains, LinkGains
from hydrohil.services.plant.params import UNIMATE_PARAMS, LinkParams, MachineParams
from hydrohil.shared.contract.link_units import as_fields, plain_of, written_location, written_name
from hydrohil.shared.contract.schema import child, field_names


@pytest.mark.parametrize(
    ("field", "turns", "slides"),
    [
        ("kp_a_per_q", "kp_a_per_rad", "kp_a_per_m"),
        ("alpha_max_q2_per_s2", "alpha_max_rad2_per_s2", "alpha_max_m2_per_s2"),
        ("viscous_tau_s_per_q", "viscous_nm_s_per_rad", "viscous_n_s_per_m"),
        ("load_feedforward_a_per_tau", "load_feedforward_a_per_nm", "load_feedforward_a_per_n"),
        ("dead_volume_m3", "dead_volume_m3", "dead_volume_m3"),
    ],
)
def test_a_field_is_written_in_the_unit_of_its_link(field, turns, slides):
    assert [written_name(field, link) for link in ("rotate", "down_up", "out_in")] == [turns, turns, slides]


@pytest.mark.parametrize("kind", [LinkGains, LinkParams])
def test_no_two_fields_of_a_link_are_written_alike(kind):
    for link in ("rotate", "out_in"):
        names = {written_name(field, link) for field in kind._fields}
        assert len(names) == len(kind._fields)
        assert not {word for name in names for word in name.split("_")} & {"q", "q2", "tau"}


@pytest.mark.parametrize(("value", "kind"), [(UNIMATE_PARAMS, MachineParams), (UNIMATE_GAINS, Gains)])
def test_what_is_written_is_read_as_the_same_fields(value, kind):
    assert as_fields(plain_of(value), kind) == {
        name: part._asdict() if hasattr(part, "_asdict") else part for name, part in value._asdict().items()
    }


def test_only_what_follows_a_links_name_is_in_that_links_unit():
    assert written_location(("controller", "gains", "out_in", "kp_a_per_q")) == ("controller", "gains", "out_in", "kp_a_per_m")
    assert written_location(("plant", "initial_q", "out_in")) == ("plant", "initial_q", "out_in")
    assert written_location(("reference", 2, "amount")) == ("reference", 2, "amount")


def test_a_table_of_a_link_keeps_that_links_defaults():
    found = as_fields({"rotate": {"kp_a_per_rad": 1.0}}, Gains)
    assert found == {"rotate": UNIMATE_GAINS.rotate._replace(kp_a_per_q=1.0)._asdict()}


@pytest.mark.parametrize(
    ("plain", "words"),
    [
        ({"out_in": {"kp_a_per_q": 1.0}}, "gains.out_in.kp_a_per_q is no field: use kp_a_per_m"),
        ([{}, {}, {}], "gains is a list: links go by name, write gains.rotate, gains.down_up, gains.out_in"),
    ],
)
def test_an_old_spelling_is_refused_with_the_new_one(plain, words):
    with pytest.raises(ValueError) as refused:
        as_fields(plain, Gains, "gains")
    assert str(refused.value) == words


def test_what_is_unknown_stays_for_the_validator():
    found = as_fields({"out_in": {"kp_a_per_rad": 1.0}, "other": [1]}, Gains)
    assert found["out_in"]["kp_a_per_rad"] == 1.0 and found["other"] == [1]
    assert as_fields("text", Gains) == "text"


def test_the_parts_of_a_type_are_found():
    assert field_names(Gains) == ("rotate", "down_up", "out_in") and field_names(float) == ()
    assert child(Gains, "rotate") is LinkGains and child(Gains, "q") is None
    assert child(tuple[int, ...], 7) is int and child(tuple[int, str], 1) is str and child(dict[str, float], "x") is float
