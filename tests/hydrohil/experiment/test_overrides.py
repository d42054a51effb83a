import pytest

from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.overrides import with_overrides
from tests.hydrohil.experiment.test_experiment import EXPERIMENT


def test_a_field_is_replaced_and_the_rest_stays():
    changed = with_overrides(EXPERIMENT, ["controller.law=pi"])
    assert changed.controller.law == "pi"
    assert changed == EXPERIMENT._replace(controller=EXPERIMENT.controller._replace(law="pi"))


@pytest.mark.parametrize(
    ("link", "field", "changes"),
    [("down_up", "kp_a_per_rad", [False, True, False]), ("out_in", "kp_a_per_m", [False, False, True])],
)
def test_a_gain_goes_by_its_link_in_the_unit_of_that_link(link, field, changes):
    changed = with_overrides(EXPERIMENT, [f"controller.gains.{link}.{field}=9"])
    assert [gains.kp_a_per_q == 9.0 for gains in changed.controller.gains] == changes


def test_the_last_assignment_wins():
    assert with_overrides(EXPERIMENT, ["duration_s=6", "duration_s=7.5"]).duration_s == 7.5


def test_values_may_be_lists_and_quoted_text():
    changed = with_overrides(EXPERIMENT, ["supervisor.workspace_low_m=[0.0, 0.1, 0.3]", 'title="A = B"', "source=see = there"])
    assert changed.supervisor.workspace_low_m == (0.0, 0.1, 0.3)
    assert (changed.title, changed.source) == ("A = B", "see = there")


def test_an_element_of_any_list_can_be_reached():
    changed = with_overrides(EXPERIMENT, ["reference.0.amount=0.05", "claims.1.high=0.2", "plant.initial_q.out_in=0.3"])
    assert changed.reference[0].amount == 0.05
    assert changed.claims[1].high == 0.2
    assert changed.plant.initial_q[2] == 0.3


@pytest.mark.parametrize(
    ("assignment", "line"),
    [
        ("controller.lav=pi", "--set controller.lav: lav is no field of controller; use one of law"),
        ("duration=5", "--set duration: duration is no field of an experiment; use one of duration_s"),
        (
            "controller.gains.3.kp_a_per_rad=1",
            "controller.gains.3 is no field: links go by name; use one of rotate, down_up, out_in",
        ),
        ("reference.rotate.amount=1", "rotate is no field of reference; use one of 0, 1"),
        ("duration_s.x=1", "duration_s is a value without fields; end the path there"),
        ("controller.gains.out_in.kp_a_per_rad=1", "kp_a_per_rad is no field of controller.gains.out_in; use one of kp_a_per_m"),
        (
            "controller.acting=[true, true, false]",
            "controller.acting is a list: links go by name, write controller.acting.rotate",
        ),
        ("controller.law", "expected path=value"),
        ("=pi", "expected path=value"),
        ("controller.law=p", "controller.law is \"p\": expected 'pi', 'morse'"),
        ("duration_s=0", "duration_s is 0 s: expected greater than 0"),
        ("duration_s=long", 'duration_s is "long": expected a valid number'),
        ("plant.bias_s=true", "plant.bias_s is true: expected a valid number"),
        ("plant.machine=3", "plant.machine is 3"),
        ("supervisor.force_limit_n=335", "supervisor.force_limit_n is 335 N: expected less than or equal to 334"),
    ],
)
def test_a_bad_assignment_is_refused_in_one_line(assignment, line):
    with pytest.raises(ExperimentError) as refusal:
        with_overrides(EXPERIMENT, [assignment])
    (said,) = refusal.value.problems
    assert line in said


def test_every_bad_path_is_named():
    with pytest.raises(ExperimentError) as refusal:
        with_overrides(EXPERIMENT, ["lav=pi", "controller.law=pi", "nome=x"])
    assert [line.split(":")[0] for line in refusal.value.problems] == ["--set lav", "--set nome"]
