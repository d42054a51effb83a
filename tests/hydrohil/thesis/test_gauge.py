import numpy as np
import pytest

from hydrohil.thesis.gauge import CONFIDENCE, fit

STIFFNESS, FORCES = 46e3, np.repeat([50.0, 100.0, 150.0, 200.0, 250.0], 20)


def test_without_scatter_the_stiffness_is_found_and_certain():
    found = fit(FORCES, 0.003 + FORCES / STIFFNESS)
    assert 1.0 / found.compliance_m_per_n == pytest.approx(STIFFNESS)
    assert found.offset_m == pytest.approx(0.003)
    assert found.half_width_m_per_n == pytest.approx(0.0, abs=1e-12)


def test_the_slope_is_polyfits():
    distances = FORCES / STIFFNESS + np.random.default_rng(3).normal(0.0, 0.003, len(FORCES))
    found = fit(FORCES, distances)
    assert (found.compliance_m_per_n, found.offset_m) == pytest.approx(np.polyfit(FORCES, distances, 1))


def test_the_interval_holds_the_truth_as_often_as_it_says():
    hands = np.random.default_rng(5)
    held = []
    for _ in range(400):
        found = fit(FORCES, FORCES / STIFFNESS + hands.uniform(-0.00635, 0.00635, len(FORCES)))
        held.append(abs(found.compliance_m_per_n - 1.0 / STIFFNESS) <= found.half_width_m_per_n)
    assert np.mean(held) == pytest.approx(CONFIDENCE, abs=0.03)
