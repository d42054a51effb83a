import pytest
from pydantic import TypeAdapter, ValidationError

from hydrohil.services.plant.config import GateLimits, PlantConfig, StartPosition, latch_substeps, tare_ticks

PLANT = TypeAdapter(PlantConfig)


@pytest.mark.parametrize(("period", "jitter", "latch"), [(90, 0, 72), (200, 0, 80), (100, 0, 80), (20, 0, 16), (90, 20, 70)])
def test_the_latch_is_four_milliseconds_four_fifths_of_the_period_or_the_shortest_interval(period, jitter, latch):
    assert latch_substeps(PlantConfig(sample_period_substeps=period, jitter_substeps=jitter)) == latch


def test_a_latch_may_stand_at_the_shortest_interval_and_not_beyond():
    config = PlantConfig(sample_period_substeps=90, jitter_substeps=10, latch_substeps=80)
    assert latch_substeps(config) == 80
    with pytest.raises(ValueError, match=r"latch_substeps is 81 .* shortest interval of 80"):
        latch_substeps(config._replace(latch_substeps=81))


def test_the_bias_is_taken_over_whole_samples():
    assert tare_ticks(PlantConfig()) == 444  # 2 s at 4.5 ms
    assert tare_ticks(PlantConfig(sample_period_substeps=20)) == 2000


@pytest.mark.parametrize(
    ("field", "good", "bad"),
    [
        ("sample_period_substeps", 20, 19),
        ("sample_period_substeps", 200, 201),
        ("jitter_substeps", 20, 21),
        ("latch_substeps", 0, -1),
        ("bias_s", 10.0, 10.1),
        ("initial_q", StartPosition(out_in=1.04), StartPosition(out_in=1.05)._asdict()),
        ("initial_q", StartPosition(down_up=0.47), StartPosition(down_up=0.48)._asdict()),
    ],
)
def test_what_an_experiment_says_to_the_plant_is_bounded(field, good, bad):
    assert getattr(PLANT.validate_python({field: good}), field) == good
    with pytest.raises(ValidationError):
        PLANT.validate_python({field: bad})


def test_no_experiment_can_name_a_limit_of_the_gate():
    with pytest.raises(ValidationError):
        PLANT.validate_python({"limits": GateLimits()._asdict()})
    assert not set(GateLimits._fields) & set(PlantConfig._fields)
