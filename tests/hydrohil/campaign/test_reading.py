"""Campaign files: those that ship, and what is wrong with others in one line."""

from pathlib import Path
from typing import Any

import pytest

from hydrohil.campaign.reading import find_campaign, read, shipped
from hydrohil.campaign.trials import count, validate
from hydrohil.experiment.errors import ExperimentError
from hydrohil.shared.contract.link_units import plain_of
from tests.support.campaign_scene import plan, table, write


def refused(**changes: Any) -> str:
    with pytest.raises(ExperimentError) as caught:
        plan(**changes)
    return str(caught.value)


@pytest.mark.parametrize("name", sorted(shipped()))
def test_every_campaign_that_ships_is_valid_at_its_corners(name: str):
    validate(find_campaign(name))


def test_the_stability_map_has_a_hundred_by_a_hundred_trials_and_both_laws_meet_a_thousand_plants():
    assert count(find_campaign("stability-map").campaign) == 100 * 100
    laws = find_campaign("law-robustness").campaign
    assert (laws.repeats, laws.sweep["controller.law"].list) == (1000, ("pi", "final"))


@pytest.mark.parametrize(
    "field", ["coulomb_nm", "breakaway_nm", "flow_gain_m3_per_s_sqrt_pa", "bulk_modulus_pa", "cross_leak_m3_per_s_pa"]
)
def test_the_thousand_plants_lie_about_the_one_that_ships(field: str):
    from hydrohil.campaign.formula import evaluate
    from hydrohil.services.plant.params import UNIMATE_PARAMS

    path = f"plant.machine.down_up.{field}"
    formulas = [axis.sets[path] for axis in find_campaign("law-robustness").campaign.sweep.values() if path in axis.sets]
    assert [evaluate(formula, 1.0) for formula in formulas] == [pytest.approx(plain_of(UNIMATE_PARAMS)["down_up"][field])]


def test_a_name_that_nothing_has_leads_to_the_nearest():
    with pytest.raises(ExperimentError, match="stability-map"):
        find_campaign("stabilty-map")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"repeat": 3}, ("repeat is no field", "repeats")),
        ({"sweep": {"controller.law": {"lst": ["pi"]}}}, ("sweep.controller.law.lst is no field", "list")),
        ({"sweep": {"a": {"grid": {"from": 1.0, "too": 2.0, "count": 2}}}}, ("sweep.a.grid.too is no field", "to")),
        ({"sweep": {"a": {"grid": {"from": 1.0, "to": 2.0}}}}, ("sweep.a.grid.count is missing",)),
        ({"sweep": {"a": {"normal": {"mean": 1.0, "deviation": 0.0}}}}, ("deviation", "greater than 0")),
        ({"sweep": {"a": {}}}, ("sweep.a has nothing to sweep over",)),
        ({"repeats": 0}, ("repeats is 0", "greater than or equal to 1")),
        ({"repeats": 1}, ("repeats is 1", "drawn from once a repeat")),
        ({"repeats": "2"}, ("repeats", "integer")),
        ({"metrics": {}}, ("nothing is measured", "[metrics.NAME]")),
        ({"metrics": {"ended": table()["metrics"]["peak_n"]}}, ("ended names two columns",)),
        ({"metrics": {"peak": {**table()["metrics"]["peak_n"], "metric": "maximun"}}}, ("metrics.peak.metric", "maximun")),
        ({"experiment": "fig-5-55"}, ("fig-5-55 is no experiment", "fig-5-5")),
        ({"experiment": "none.toml"}, ("none.toml", "cannot be read")),
        ({"set": {"controller.lw": "pi"}}, ("mine.toml: set controller.lw", "law")),
        ({"set": {"duration_s": -1.0}}, ("mine.toml: set: duration_s is -1.0 s",)),
        ({"pictures": {"p": {"kind": "map", "of": "peak", "x": "mass_kg", "y": "mass_kg"}}}, ("pictures.p.of", "peak_n")),
        (
            {"pictures": {"p": {"kind": "map", "of": "peak_n", "x": "mass_kg", "y": "controller.law"}}},
            ("lists of two or more numbers",),
        ),
        (
            {"pictures": {"p": {"kind": "map", "of": "peak_n", "x": "mass_kg", "y": "mass_kg", "border": "limit-cycle"}}},
            ("border 'limit-cycle' needs", "stiffness_n_per_m"),
        ),
    ],
)
def test_what_is_wrong_is_reported_in_one_line_with_what_was_expected(changes: dict[str, Any], words: tuple[str, ...]):
    message = refused(**changes)
    assert all(any(word in line for line in message.splitlines()) for word in words), message


def test_a_file_that_is_no_toml_is_named(tmp_path: Path):
    bad = tmp_path / "bad.toml"
    bad.write_text("name = ")
    with pytest.raises(ExperimentError, match=r"bad\.toml: is no TOML"):
        read(bad)


def test_an_experiment_of_its_own_lies_beside_the_campaign(tmp_path: Path):
    from hydrohil.experiment.experiment import to_toml
    from hydrohil.thesis.library import find

    (tmp_path / "own.toml").write_text(to_toml(find("fig-5-5")._replace(title="Mine")))
    assert read(write(tmp_path, experiment="own.toml")).base.title == "Mine"


def test_the_digest_changes_with_what_decides_a_row_and_with_nothing_else():
    first = plan().digest
    assert plan().digest == first
    picture = {"p": {"kind": "distribution", "of": "peak_n"}}
    assert plan(title="Another", pictures=picture).digest == first
    for change in ({"seed": 6}, {"repeats": 3}, {"experiment": "fig-5-6"}, {"claims": False, "set": {}}):
        assert plan(**change).digest != first, change


def test_the_campaign_of_the_documentation_is_valid(tmp_path: Path):
    page = (Path(__file__).resolve().parents[3] / "docs" / "howto" / "run-a-campaign.md").read_text()
    file = tmp_path / "mine.toml"
    file.write_text(page.split("```toml\n")[1].split("```")[0])
    validate(read(file))


def test_the_documentation_lists_what_ships_with_its_number_of_trials():
    page = (Path(__file__).resolve().parents[3] / "docs" / "howto" / "run-a-campaign.md").read_text()
    assert all(f"| `{name}` | {count(find_campaign(name).campaign):,} |" in page for name in shipped())
