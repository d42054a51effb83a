import pytest

from hydrohil.claims.contact import CONTACT_N
from hydrohil.services.controller.config import ImpedanceConfig
from hydrohil.thesis.beyond_impedance import ADAPTATIONS, EXPERIMENTS, PAIRS
from hydrohil.thesis.chapter5 import RADIUS_M
from hydrohil.thesis.library import find

FILTER_FIELDS = ("force_filter", "force_cutoff_hz", "force_noise_n")
CIRCLES = [e for e in EXPERIMENTS if e.name.startswith("circle")]
ADAPTIVE = [e for e in EXPERIMENTS if e.name.startswith("adaptive")]


def original(name):
    return find("fig-5-9" if "soft" in name else "fig-5-11")


@pytest.mark.parametrize("circle", CIRCLES, ids=lambda e: e.name)
def test_a_light_circle_differs_from_its_figure_in_mass_and_filter_only(circle):
    figure, target = original(circle.name), circle.controller.impedance
    plain = target._replace(mass_kg=50.0, **{name: ImpedanceConfig._field_defaults[name] for name in FILTER_FIELDS})
    assert (circle.plant, circle.reference, circle.duration_s) == (figure.plant, figure.reference, figure.duration_s)
    assert circle.controller._replace(impedance=plain) == figure.controller


def test_one_filter_serves_all():
    chosen = {
        tuple(getattr(e.controller.impedance, name) for name in FILTER_FIELDS) for e in EXPERIMENTS if e.name.endswith("filtered")
    }
    assert chosen == {("bounded", 0.7, 10.0)}


@pytest.mark.parametrize("trial", ADAPTIVE, ids=lambda e: e.name)
def test_an_adaptive_circle_differs_from_figure_5_11_in_its_adaptation_only(trial):
    figure = find("fig-5-11")
    assert (trial.plant, trial.reference, trial.duration_s) == (figure.plant, figure.reference, figure.duration_s)
    assert trial.controller._replace(adaptation=figure.controller.adaptation) == figure.controller
    assert trial.controller.adaptation.kind != "none"


def test_one_ceiling_above_what_the_target_holds_at_rest_and_one_onset_above_the_noise():
    (ceiling_n,) = {adaptation.ceiling_n for adaptation in ADAPTATIONS}
    (onset_n,) = {adaptation.onset_n for adaptation in ADAPTATIONS}
    k, k_eff = 1e3, 25e3
    assert ceiling_n > k * k_eff / (k + k_eff) * RADIUS_M > onset_n >= CONTACT_N
    for trial in ADAPTIVE:
        (claim,) = (claim for claim in trial.claims if claim.metric == "maximum")
        assert (claim.high, claim.start_s, claim.end_s) == (ceiling_n, 0.0, trial.duration_s)


def test_every_technique_is_asked_for_the_same_price():
    claimed = {trial.name: {(p.metric, p.high) for p in PAIRS if p.of == trial.name} for trial in ADAPTIVE}
    assert len(claimed) == 3
    assert len({frozenset(prices) for prices in claimed.values()}) == 1
