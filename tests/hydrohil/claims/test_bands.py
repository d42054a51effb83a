import pytest

from hydrohil.claims.bands import Measure, at_least, at_most, between
from hydrohil.claims.claims import Claim, band, within_band

MEAN = Measure("mean", "force", "N", 1.0, 2.0)


def test_each_band_is_the_claim_that_its_name_says():
    common = {"metric": "mean", "channel": "force", "start_s": 1.0, "end_s": 2.0, "unit": "N", "source": "5.3"}
    assert at_most("small", MEAN, 3.0, "5.3") == Claim("small", comparison="below", high=3.0, **common)
    assert at_least("large", MEAN, 3.0, "5.3") == Claim("large", comparison="above", low=3.0, **common)
    assert between("near", MEAN, 2.0, 3.0, "5.3") == Claim("near", comparison="within", low=2.0, high=3.0, **common)


@pytest.mark.parametrize(
    ("claim", "text", "holds"),
    [
        (at_most("", MEAN, 3.0, ""), "below 3 N", (True, True, False)),
        (at_least("", MEAN, 3.0, ""), "above 3 N", (False, True, True)),
        (between("", MEAN, 2.0, 3.0, ""), "within 2..3 N", (True, True, False)),
    ],
)
def test_a_value_on_the_band_holds(claim, text, holds):
    assert band(claim) == text
    assert tuple(within_band(claim, value) for value in (2.0, 3.0, 4.0)) == holds
