import pytest

from hydrohil.experiment.errors import ExperimentError, dotted, names_at, unit_of
from hydrohil.experiment.experiment import Experiment


@pytest.mark.parametrize(
    ("field", "unit"),
    [
        ("kp_a_per_rad", "A/rad"),
        ("ki_a_per_m_s", "A/(m s)"),
        ("stiffness_n_per_m", "N/m"),
        ("viscous_nm_s_per_rad", "N m s/rad"),
        ("viscous_n_s_per_m", "N s/m"),
        ("inertia_rotate_kg_m2", "kg m2"),
        ("travel_low_m", "m"),
        ("jitter_substeps", "sub-steps"),
        ("damping_ratio", ""),
        ("law", ""),
        ("per_s", "s"),
    ],
)
def test_the_unit_is_read_from_the_suffix(field, unit):
    assert unit_of(field) == unit


def test_names_are_found_through_lists_and_tables():
    assert "kp_a_per_rad" in names_at(Experiment, ("controller", "gains", "down_up"))
    assert "kp_a_per_m" in names_at(Experiment, ("controller", "gains", "out_in"))
    assert "stiffness_n_per_m" in names_at(Experiment, ("plant", "environment"))
    assert "amount" in names_at(Experiment, ("reference", 4))
    assert names_at(Experiment, ("duration_s",)) == ()


def test_a_location_is_dotted():
    assert dotted(("claims", 0, "unit")) == "claims.0.unit"


def test_the_message_has_a_line_a_problem():
    assert str(ExperimentError(["a", "b"])) == "a\nb"
    assert isinstance(ExperimentError([]), ValueError)
