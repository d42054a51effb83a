import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.plant.friction import friction_limit, slide
from hydrohil.services.plant.params import UNIMATE_PARAMS, LinkParams
from hydrohil.shared.compiled.kernel import compiled, kernel

LINK = UNIMATE_PARAMS.down_up
INERTIA = 111.0
LINKS = [UNIMATE_PARAMS.rotate, UNIMATE_PARAMS.down_up, UNIMATE_PARAMS.out_in]


@kernel
def swayed(link: LinkParams, mean_tau: float, swing_tau: float, step_s: float, steps: int) -> float:
    q, speed = 0.0, 0.0
    for step in range(steps):
        load = mean_tau + swing_tau * math.sin(4.0 * math.pi * step * step_s)
        speed = slide(speed, 100.0, load, friction_limit(link, speed), step_s)
        q += step_s * speed
    return q


swayed_compiled = compiled(swayed)


@pytest.mark.parametrize("step_s", [50e-6, 100e-6, 200e-6])
@pytest.mark.parametrize("link", LINKS)
def test_a_minute_of_swaying_load_below_break_away_moves_nothing_at_all(link, step_s):
    limit = link.breakaway_tau
    assert swayed_compiled(link, 0.5 * limit, 0.3 * limit, step_s, round(60.0 / step_s)) == 0.0
    assert swayed_compiled(link, 0.5 * limit, 0.51 * limit, step_s, round(60.0 / step_s)) > 0.0


def test_break_away_holds_its_own_load_and_not_more():
    limit = friction_limit(LINK, 0.0)
    assert slide(0.0, INERTIA, limit, limit, 50e-6) == 0.0
    assert slide(0.0, INERTIA, limit * (1 + 1e-9), limit, 50e-6) > 0.0
    assert slide(0.0, INERTIA, -limit * (1 + 1e-9), limit, 50e-6) < 0.0


def test_friction_falls_from_break_away_to_coulomb():
    assert friction_limit(LINK, 0.0) == LINK.breakaway_tau
    at_stribeck = LINK.coulomb_tau + (LINK.breakaway_tau - LINK.coulomb_tau) / math.e
    assert friction_limit(LINK, LINK.stribeck_q_per_s) == pytest.approx(at_stribeck)
    assert friction_limit(LINK, -LINK.stribeck_q_per_s) == pytest.approx(at_stribeck)
    assert friction_limit(LINK, 100 * LINK.stribeck_q_per_s) == LINK.coulomb_tau


def test_a_coasting_mass_stops_where_its_energy_is_spent_and_stays():
    q, speed, step_s = 0.0, 0.5, 50e-6
    for _ in range(10_000):
        speed = slide(speed, INERTIA, 0.0, LINK.coulomb_tau, step_s)
        q += step_s * speed
    assert speed == 0.0
    assert q == pytest.approx(0.5 * INERTIA * 0.5 * 0.5 / LINK.coulomb_tau, rel=1e-3)


@given(st.floats(-10, 10), st.floats(0, 1e4))
def test_friction_alone_only_takes_speed_and_never_turns_it(speed, limit):
    after = slide(speed, INERTIA, 0.0, limit, 50e-6)
    assert abs(after) <= abs(speed) * (1 + 1e-12)
    assert after * speed >= 0.0


def test_a_speed_that_is_no_number_stays_none():
    assert math.isnan(slide(math.nan, INERTIA, 0.0, 100.0, 50e-6))
    assert math.isnan(slide(0.0, INERTIA, math.nan, 100.0, 50e-6))
    assert math.isnan(slide(0.0, INERTIA, 0.0, math.nan, 50e-6))
