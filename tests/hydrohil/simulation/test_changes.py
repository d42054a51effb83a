"""Parameters that change in a trial on the local clock: the rows before are the same, those after are another controller's."""

import numpy as np
import pytest

from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import from_plain, to_plain
from hydrohil.experiment.overrides import with_overrides
from hydrohil.services.controller.config import ScheduledChange
from hydrohil.services.controller.step import control_start
from hydrohil.simulation.columns import columns
from hydrohil.simulation.loop import Underway, begin
from hydrohil.simulation.rollout import _compiled, fault_table, play_local
from hydrohil.thesis.library import find
from tests.hydrohil.simulation.test_local import plain_parts, press

SEED = 3
TICK = 100
AT_S = 0.45
LAW = ScheduledChange(AT_S, ("controller.law=pi",))
SOFT = ScheduledChange(AT_S, ("controller.impedance.stiffness_n_per_m=20e3",))


def trial(*changes):
    return press()._replace(changes=changes)


@pytest.fixture(scope="module")
def unchanged():
    return play_local(press(), SEED)


def differing(one, other):
    """Ticks at which any column differs."""
    rows = min(len(one.rows.tick), len(other.rows.tick))
    differs = np.zeros(rows, dtype=bool)
    for first, second in zip(one.rows, other.rows, strict=True):
        differs |= (first[:rows] != second[:rows]).reshape(rows, -1).any(axis=1)
    return one.rows.tick[:rows][differs]


@pytest.mark.parametrize("change", [LAW, SOFT])
def test_a_trial_is_the_same_to_the_bit_until_its_change_and_another_from_that_very_tick_on(unchanged, change):
    changed = play_local(trial(change), SEED)
    assert differing(changed, unchanged)[0] == TICK
    assert len(changed.rows.tick) == len(unchanged.rows.tick)


def test_at_its_tick_a_law_holds_the_code_of_the_tick_before():
    rows = play_local(trial(LAW), SEED).rows
    first = int(np.flatnonzero(rows.tick == TICK)[0])
    assert (np.abs(rows.dac_counts[first] - rows.dac_counts[first - 1]) <= 1).all()


def test_a_trial_in_pieces_is_the_trial_in_one(unchanged):
    prepared, count, table, noise_n, intervals = plain_parts(press(), SEED)
    intervals, out = np.array(intervals), columns(count)
    underway = begin(prepared, control_start(prepared.control), intervals)
    for end in (1, 2, 66, 67, 200, count):
        rest = (table, fault_table(press(), SEED), np.array(noise_n), intervals, out, end)
        underway = _compiled["play"](prepared, Underway(*underway), *rest)
        assert underway.row == end
    for piecewise, whole in zip(out, unchanged.rows, strict=True):
        assert piecewise.tobytes() == whole.tobytes()


def test_no_piece_compiles_anything_again():
    play_local(press(), SEED)
    before = len(_compiled["play"].signatures)
    play_local(trial(LAW, SOFT._replace(at_s=0.9)), SEED)
    assert len(_compiled["play"].signatures) == before == 1


def test_an_experiment_says_what_is_wrong_with_its_changes():
    plain = to_plain(trial(LAW))
    assert from_plain(plain, "again") == trial(LAW)
    for at_s, said in ((1.9999, ""), (2.0, "changes.0.at_s is 2 s: the trial ends at 2 s")):
        plain["changes"][0]["at_s"] = at_s
        if not said:
            assert from_plain(plain, "file").changes[0].at_s == at_s
            continue
        with pytest.raises(ExperimentError, match=said):
            from_plain(plain, "file")
    with pytest.raises(ExperimentError, match=r"changes\.0: controller\.slew_codes stays"):
        with_overrides(press(), ['changes=[{at_s=1.0, set=["controller.slew_codes=200"]}]'])
    with pytest.raises(ExperimentError, match="beyond the travel"):
        with_overrides(find("fig-5-2"), ['changes=[{at_s=1.0, set=["controller.impedance.stiffness_n_per_m=50"]}]'])
