import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hydrohil.services.plant.hydraulics import LinkState, chamber_step, port_area, port_flows, signed_root, spool_step
from hydrohil.services.plant.params import UNIMATE_PARAMS

LINKS = [UNIMATE_PARAMS.rotate, UNIMATE_PARAMS.down_up, UNIMATE_PARAMS.out_in]
LINK = UNIMATE_PARAMS.down_up
SUPPLY, STEP = 7e6, 50e-6
ENDS = (SUPPLY, 0.0)
NO_FLOW = (0.0, 0.0)
SMOOTHING = UNIMATE_PARAMS.root_smoothing_pa


@pytest.mark.parametrize("link", LINKS)
def test_a_port_opens_just_past_the_overlap_and_is_whole_at_full_scale(link):
    assert port_area(link, link.overlap_a) == 0.0 == port_area(link, -link.overlap_a)
    assert port_area(link, link.overlap_a * 1.001) > 0.0 > port_area(link, -link.overlap_a * 1.001)
    assert port_area(link, link.full_scale_a) == pytest.approx(1.0)
    half_open = (link.full_scale_a + link.overlap_a) / 2
    assert port_area(link, -half_open) == pytest.approx(-0.25)  # parabolic


@pytest.mark.parametrize("link", LINKS)
def test_the_spool_rests_at_its_null_inside_the_overlap(link):
    assert spool_step(link, link.null_bias_a, 0.0, STEP) == link.null_bias_a
    assert port_area(link, link.null_bias_a) == 0.0


def test_the_spool_has_gone_63_percent_of_its_way_after_one_lag():
    spool = LINK.null_bias_a
    for _ in range(round(LINK.valve_lag_s / STEP)):
        spool = spool_step(LINK, spool, 0.3, STEP)
    assert (spool - LINK.null_bias_a) / 0.3 == pytest.approx(1 - math.exp(-1), rel=0.01)


@given(st.floats(-1e7, 1e7))
def test_the_root_of_a_drop_is_odd_and_a_root_where_the_drop_is_large(drop):
    root = signed_root(drop, SMOOTHING)
    assert root == -signed_root(-drop, SMOOTHING)
    if abs(drop) > 20 * SMOOTHING:
        assert root == pytest.approx(math.copysign(math.sqrt(abs(drop)), drop), rel=1e-3)


def test_flow_stops_where_the_chamber_has_reached_the_supply():
    assert port_flows(1e-7, (SUPPLY, 0.0), ENDS, SMOOTHING) == NO_FLOW
    into_a, into_b = port_flows(1e-7, (SUPPLY + 1.0, 1.0), ENDS, SMOOTHING)
    assert into_a < 0.0 and into_b < 0.0  # past the supply it flows back


@given(st.floats(0, SUPPLY), st.floats(0, SUPPLY), st.floats(0, 1e-6))
def test_a_valve_turned_over_swaps_the_chambers(a_pa, b_pa, gain):
    into_a, into_b = port_flows(gain, (a_pa, b_pa), ENDS, SMOOTHING)
    mirrored_a, mirrored_b = port_flows(-gain, (b_pa, a_pa), ENDS, SMOOTHING)
    assert (mirrored_a, mirrored_b) == (into_b, into_a)


@pytest.mark.parametrize(("link", "speed"), [(LINKS[0], math.radians(24)), (LINKS[1], math.radians(21)), (LINKS[2], 0.38)])
def test_the_valve_gain_gives_the_no_load_speed_at_360_ma(link, speed):
    gain = link.flow_gain_m3_per_s_sqrt_pa * port_area(link, 0.360)
    into_a, into_b = port_flows(gain, (SUPPLY / 2, SUPPLY / 2), ENDS, SMOOTHING)
    assert into_a == pytest.approx(-into_b)
    assert into_a / link.displacement_m3_per_q == pytest.approx(speed, rel=1e-4)


def test_a_shut_chamber_is_a_spring_of_its_bulk_modulus():
    tight = LINK._replace(cross_leak_m3_per_s_pa=0.0, null_leak_m3_per_s_pa=0.0)
    a_pa, b_pa = chamber_step(tight, LinkState(0.1, 0.2, 0.0, 3e6, 4e6), NO_FLOW, ENDS, STEP)
    swept = tight.displacement_m3_per_q * 0.2 * STEP
    volume_a = tight.dead_volume_m3 + tight.displacement_m3_per_q * (0.1 - tight.travel_low_q)
    volume_b = tight.dead_volume_m3 + tight.displacement_m3_per_q * (tight.travel_high_q - 0.1)
    assert a_pa - 3e6 == pytest.approx(-tight.bulk_modulus_pa * swept / volume_a)
    assert b_pa - 4e6 == pytest.approx(tight.bulk_modulus_pa * swept / volume_b)


def settle(link, a_pa, b_pa, seconds):
    state = LinkState((link.travel_low_q + link.travel_high_q) / 2, 0.0, 0.0, a_pa, b_pa)
    for _ in range(round(seconds / STEP)):
        a_pa, b_pa = chamber_step(link, state, NO_FLOW, ENDS, STEP)
        state = state._replace(pressure_a_pa=a_pa, pressure_b_pa=b_pa)
    return a_pa, b_pa


def test_a_leaking_piston_loses_its_load_pressure_exponentially():
    link = LINK._replace(null_leak_m3_per_s_pa=0.0)
    a_pa, b_pa = settle(link, 5e6, 2e6, 0.1)
    middle = link.displacement_m3_per_q * (link.travel_high_q - link.travel_low_q) / 2
    rate = 2 * link.bulk_modulus_pa * link.cross_leak_m3_per_s_pa / (link.dead_volume_m3 + middle)
    assert a_pa + b_pa == pytest.approx(7e6)
    assert a_pa - b_pa == pytest.approx(3e6 * math.exp(-rate * 0.1), rel=1e-3)


def test_leaking_lands_centre_both_chambers_between_supply_and_return():
    leaky = LINK._replace(null_leak_m3_per_s_pa=1e-10)
    assert settle(leaky, 1e6, 1e6, 1.0) == pytest.approx((SUPPLY / 2, SUPPLY / 2), rel=1e-3)


def test_oil_does_not_pull():
    a_pa, b_pa = chamber_step(LINK, LinkState(0.0, 10.0, 0.0, 1e3, 1e3), NO_FLOW, ENDS, STEP)
    assert a_pa == 0.0
    assert b_pa > 1e3


UNEQUAL = LINK._replace(area_ratio=0.5, cross_leak_m3_per_s_pa=0.0, null_leak_m3_per_s_pa=0.0)


def test_shut_chambers_of_unequal_areas_lose_and_gain_the_volume_that_each_piston_side_sweeps():
    state = LinkState(0.1, 0.2, 0.0, 3e6, 4e6)
    a_pa, b_pa = chamber_step(UNEQUAL, state, NO_FLOW, ENDS, STEP)
    area_a, area_b = UNEQUAL.displacement_m3_per_q, 0.5 * UNEQUAL.displacement_m3_per_q
    volume_a = UNEQUAL.dead_volume_m3 + area_a * (0.1 - UNEQUAL.travel_low_q)
    volume_b = UNEQUAL.dead_volume_m3 + area_b * (UNEQUAL.travel_high_q - 0.1)
    assert (a_pa - 3e6) * volume_a / UNEQUAL.bulk_modulus_pa == pytest.approx(-area_a * 0.2 * STEP)
    assert (b_pa - 4e6) * volume_b / UNEQUAL.bulk_modulus_pa == pytest.approx(area_b * 0.2 * STEP)


@pytest.mark.parametrize("ratio", [0.25, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("speed", [-0.3, 0.3])
def test_a_steady_piston_takes_in_at_one_side_and_gives_out_at_the_other_in_the_ratio_of_its_areas(ratio, speed):
    link = UNEQUAL._replace(area_ratio=ratio)
    swept = link.displacement_m3_per_q * speed
    a_pa, b_pa = chamber_step(link, LinkState(0.0, speed, 0.0, 3e6, 4e6), (swept, -ratio * swept), ENDS, STEP)
    assert (a_pa, b_pa) == pytest.approx((3e6, 4e6), abs=1e-6)  # flow in = volume swept: no pressure changes
