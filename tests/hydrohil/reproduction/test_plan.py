import pytest

from hydrohil.experiment.errors import ExperimentError
from hydrohil.reproduction.plan import CHAPTERS, chapter_of, choose, figures, find_figure, groups
from hydrohil.reproduction.studies import STUDIES
from hydrohil.thesis.library import catalogue, pairs


def names(chosen):
    return [figure.name for figure in choose(chosen)]


def test_every_experiment_and_every_study_is_a_figure_once():
    assert sorted(figure.name for figure in figures()) == sorted(subject.name for subject in (*catalogue(), *STUDIES))


def test_no_two_figures_share_a_name():
    listed = [name for figure in figures() for name in figure.names]
    assert len(listed) == len(set(listed))


def test_figures_come_in_the_order_of_the_thesis():
    ordered = [figure.name for figure in figures()]
    chosen = ["fig-4-2", "fig-4-11", "deadband-sine", "fig-4-14", "fig-4-16", "fig-5-14", "fig-6-4", "fig-6-6", "fig-9-8"]
    assert [name for name in ordered if name in chosen] == chosen
    chapters = [figure.chapter for figure in figures()]
    assert [*dict.fromkeys(chapters)] == [chapter for chapter in CHAPTERS if chapter in chapters]


def test_a_chapter_and_a_name_choose_figures_in_the_order_of_the_page():
    assert names(["fig-4-25", "5"])[0] == "fig-4-25"
    assert names(["5"]) == [figure.name for figure in figures() if figure.chapter == "5"]
    assert names([]) == [figure.name for figure in figures()]
    assert names(["appendix"])


def test_an_alias_and_a_second_figure_choose_their_trial():
    assert names(["circle-soft-plate"]) == names(["fig-5-10"]) == ["fig-5-9"]
    assert find_figure("force-filter").computed


def test_the_velocity_figures_answer_to_both_their_numbers():
    assert names(["fig-9-3"]) == names(["fig-9-7"]) == ["fig-9-7"]  # in the list of figures, at the figure
    assert names(["fig-9-4"]) == names(["fig-9-8"]) == ["fig-9-8"]


def test_unknown_figures_are_all_answered_with_the_nearest():
    with pytest.raises(ExperimentError) as refused:
        choose(["fig-4-26", "fig-5-2", "8"])
    assert [problem.split(" ")[0] for problem in refused.value.problems] == ["fig-4-26", "8"]
    assert "fig-4-25" in refused.value.problems[0] and "fig-4-2," in refused.value.problems[0] + ","


def test_a_source_without_a_chapter_is_refused():
    assert chapter_of("deadband-sine", "thesis 4.5.1, in words") == "4"
    with pytest.raises(ValueError, match="hearsay"):
        chapter_of("rumour", "hearsay")


def test_every_claim_finds_its_trials_in_one_group():
    all_groups = groups(figures())
    assert sorted(name for group in all_groups for name in group.figures) == sorted(figure.name for figure in figures())
    played = [trial for group in all_groups for trial in group.trials]
    assert len(played) == len(set(played))
    for claim in pairs():
        assert any({claim.of, claim.against} <= set(group.trials) for group in all_groups)


def test_a_pair_brings_the_trial_that_it_is_set_against():
    (group,) = groups(choose(["fig-4-2"]))
    assert (group.figures, group.trials) == (("fig-4-2",), ("fig-4-2", "fig-4-21"))
