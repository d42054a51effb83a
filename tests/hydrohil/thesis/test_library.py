import pytest

from hydrohil.claims.claims import problems
from hydrohil.claims.pairs import pair_problems
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import checked, from_bytes, to_bytes, to_toml
from hydrohil.thesis.library import catalogue, find, load, pairs


@pytest.mark.parametrize("experiment", catalogue(), ids=lambda experiment: experiment.name)
def test_every_experiment_is_valid_and_survives_toml_and_bytes(experiment, tmp_path):
    assert checked(experiment, experiment.name) is experiment
    path = tmp_path / "trial.toml"
    path.write_text(to_toml(experiment), encoding="utf-8")
    assert load(path) == experiment
    assert to_bytes(from_bytes(to_bytes(experiment))) == to_bytes(experiment)


@pytest.mark.parametrize("experiment", catalogue(), ids=lambda experiment: experiment.name)
def test_every_claim_states_its_source_and_can_be_measured(experiment):
    assert experiment.claims
    for claim in experiment.claims:
        assert claim.source.startswith("thesis ") and '"' in claim.source
        assert problems(claim, experiment.duration_s) == []


def test_every_pair_names_two_experiments_of_one_plant_and_states_its_source():
    for claim in pairs():
        assert pair_problems(claim) == []
        assert claim.source.startswith("thesis ") and '"' in claim.source
        of, against = find(claim.of), find(claim.against)
        assert claim.end_s <= min(of.duration_s, against.duration_s)
        assert of.plant.machine == against.plant.machine


def test_no_two_experiments_share_a_name():
    names = [name for experiment in catalogue() for name in {experiment.name, experiment.alias}]
    assert len(names) == len(set(names))


def test_an_experiment_is_found_by_figure_and_by_alias():
    assert find("fig-4-25") is find("final-sine")
    assert find("fig-5-5") is find("static-force-soft-plate")


def test_a_second_figure_leads_to_its_trial():
    assert find("fig-5-10") is find("fig-5-9")
    assert find("fig-5-12") is find("fig-5-11")


def test_no_statement_occurs_twice_in_a_figure():
    for experiment in catalogue():
        statements = [
            claim.statement for claim in (*experiment.claims, *(pair for pair in pairs() if pair.of == experiment.name))
        ]
        assert len(statements) == len(set(statements)), experiment.name


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(ExperimentError, match=r"fig-4-26 is no experiment: use one of .*fig-4-2"):
        find("fig-4-26")
    with pytest.raises(ExperimentError, match=r"^junk is no experiment: use one of those that `hydrohil list` shows$"):
        find("junk")


def test_every_trial_of_chapters_four_and_five_is_there():
    names = {experiment.name for experiment in catalogue()}
    figures = [f"fig-4-{n}" for n in (*range(2, 12), *range(16, 26))] + [f"fig-5-{n}" for n in (*range(2, 10), 11, 13, 14)]
    assert names >= set(figures)


def test_one_machine_serves_all():
    assert len({experiment.plant.machine for experiment in catalogue()}) == 1
    assert len({experiment.controller.gains for experiment in catalogue()}) == 1
