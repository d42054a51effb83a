import pytest

from hydrohil.experiment.errors import ExperimentError, dotted, names_at, unit_of
from hydrohil.experiment.experiment import Experiment


@pytest.mark.parametrize(
    ("field", "unit"),
    [
        ("kp_a_per_q", "A/q"),
        ("ki_a_per_q_s", "A/(q s)"),
        ("stiffness_n_per_m", "N/m"),
        ("viscous_tau_s_per_q", "tau s/q"),
        ("inertia_rotate_kg_m2", "kg m2"),
        ("initial_q", "q"),
        ("jitter_substeps", "sub-steps"),
        ("damping_ratio", ""),
        ("law", ""),
        ("per_s", "s"),
    ],
)
def test_the_unit_is_read_from_the_suffix(field, unit):
    assert unit_of(field) == unit


def test_names_are_found_through_lists_and_tables():
    assert "kp_a_per_q" in names_at(Experiment, ("controller", "gains", 1))
    assert "stiffness_n_per_m" in names_at(Experiment, ("plant", "environment"))
    assert "amount" in names_at(Experiment, ("reference", 4))
    assert names_at(Experiment, ("duration_s",)) == ()


def test_a_location_is_dotted():
    assert dotted(("claims", 0, "unit")) == "claims.0.unit"


def test_the_message_has_a_line_a_problem():
    assert str(ExperimentError(["a", "b"])) == "a\nb"
    assert isinstance(ExperimentError([]), ValueError)
