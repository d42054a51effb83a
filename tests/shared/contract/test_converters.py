import math
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from hydrohil.shared.compiled.kernel import compiled
from hydrohil.shared.contract.converters import calibration, code_to_current, current_to_code
from hydrohil.shared.machine.unimate import UNIMATE

current_to_code_compiled = compiled(current_to_code)


def codes_of(current_a):
    plain = current_to_code(UNIMATE.drive, current_a)
    assert current_to_code_compiled(UNIMATE.drive, current_a) == plain
    return plain


@pytest.mark.parametrize("half", [0.0, 0.5])
def test_every_count_gives_the_code_of_the_programs_integer_algebra(half):
    for counts in range(-2048, 2049):
        scaled = counts + math.copysign(half, counts)
        limited = max(-2048, min(2047, math.trunc(scaled)))
        expected = 2048 + math.trunc(Fraction(3 * limited, 5))
        current_a = math.nextafter(scaled / UNIMATE.drive.counts_per_a, math.copysign(math.inf, counts)) if counts else 0.0
        assert codes_of(current_a) == expected, counts


@pytest.mark.parametrize(
    ("current_a", "code"),
    [(0.0, 2048), (-0.0, 2048), (math.nan, 2048), (math.inf, 3276), (-math.inf, 820), (1e308, 3276), (-1e308, 820)],
)
def test_nothing_leaves_the_converters_range_and_a_nan_is_zero_current(current_a, code):
    assert codes_of(current_a) == code


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_more_current_never_gives_a_lower_code_and_signs_are_symmetric(a, b):
    low, high = min(a, b), max(a, b)
    assert current_to_code(UNIMATE.drive, low) <= current_to_code(UNIMATE.drive, high)
    assert abs((current_to_code(UNIMATE.drive, a) - 2048) + (current_to_code(UNIMATE.drive, -a) - 2048)) <= 1


@given(st.floats(-0.359, 0.359))
@example(0.1)
def test_a_code_drives_the_current_it_stands_for_within_its_resolution(current_a):
    driven_a = code_to_current(UNIMATE.drive, current_to_code(UNIMATE.drive, current_a))
    assert abs(driven_a) <= abs(current_a) + 1e-15  # truncation is towards zero
    assert abs(driven_a - current_a) < 2 * UNIMATE.drive.a_per_code


def test_zero_current_is_exactly_zero_and_the_ends_are_those_of_the_channel_table():
    assert code_to_current(UNIMATE.drive, 2048) == 0.0
    assert {(channel.low, channel.high) for channel in UNIMATE.converters} == {(820, 3276)}
    for channel in UNIMATE.converters:
        for code in (820, 2048, 3276):
            assert channel.scale * code + channel.offset == pytest.approx(code_to_current(UNIMATE.drive, code), abs=1e-12)
    assert code_to_current(UNIMATE.drive, 3276) == pytest.approx(0.360, rel=1e-3)


def test_the_calibration_leaves_out_the_roll_encoder():
    found = calibration(UNIMATE.encoders, UNIMATE.force)
    used = [UNIMATE.encoders[i] for i in (0, 1, 2, 4)]
    assert found.scale == tuple(channel.scale for channel in used)
    assert found.offset == tuple(channel.offset for channel in used)
    assert found.force_n_per_count == pytest.approx(20 / 66 * 9.8 / 2.2)
    assert UNIMATE.encoders[1].scale < 0.0  # counts fall as the link goes down
