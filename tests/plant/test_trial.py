import pytest

from hydrohil.services.plant.config import PlantConfig, tare_ticks
from hydrohil.services.plant.trial import Schedule
from hydrohil.shared.contract.envelope import seal, unseal
from hydrohil.shared.contract.messages import NO_TRIAL
from hydrohil.shared.units import SUBSTEP_NS

CONFIG = PlantConfig(bias_s=0.45, jitter_substeps=5)
BIAS = 100


def schedule(clock="real", config=CONFIG, seed=1):
    return Schedule(config, unseal(seal({}, run=1, seed=seed, clock=clock, tare_ticks=BIAS, duration_ticks=50)))


def test_without_an_envelope_there_is_no_trial():
    idle = Schedule(PlantConfig())
    idle.announce(10)
    assert [idle.tick(number) for number in (9, 10, 11)] == [NO_TRIAL] * 3
    assert (idle.lockstep, idle.interval(NO_TRIAL)) == (False, 90)


def test_ticks_begin_with_the_bias_at_the_announced_sample_and_end_with_the_duration():
    trial = schedule()
    assert tare_ticks(CONFIG) == BIAS
    assert trial.tick(10) == NO_TRIAL
    trial.announce(10)
    assert [trial.tick(number) for number in (9, 10, 109, 110, 159, 160)] == [NO_TRIAL, -100, -1, 0, 49, NO_TRIAL]
    trial.forget()
    assert trial.tick(110) == NO_TRIAL


def test_every_interval_of_a_trial_is_drawn_beforehand_within_the_jitter():
    trial, again, other = schedule(), schedule(), schedule(seed=2)
    drawn = [trial.interval(tick) for tick in range(-BIAS, 50)]
    assert drawn == [again.interval(tick) for tick in range(-BIAS, 50)]
    assert drawn != [other.interval(tick) for tick in range(-BIAS, 50)]
    assert (min(drawn), max(drawn)) == (85, 95)
    assert trial.interval(NO_TRIAL) == 90
    assert trial.bias_ns == sum(drawn[:BIAS]) * SUBSTEP_NS


@pytest.mark.parametrize(("clock", "waits"), [("real", False), ("lockstep", True)])
def test_only_lockstep_waits_for_answers(clock, waits):
    assert schedule(clock).lockstep is waits
