from analysis.studies import STUDIES
from reproduction.explanations import DEVIATIONS, explanation
from reproduction.plan import find_figure

KEYS = [key for deviation in DEVIATIONS for key in deviation.of]


def test_every_explanation_is_of_a_statement_that_is_made():
    for name, statement in KEYS:
        figure = find_figure(name)
        assert figure.name == name
        if not figure.computed:
            assert statement in {claim.statement for claim in (*figure.subject.claims, *figure.pairs)}, f"{name}: {statement}"
        else:
            assert figure.subject in STUDIES


def test_no_statement_is_explained_twice():
    assert len(KEYS) == len(set(KEYS))


def test_what_has_no_row_is_unexplained():
    assert explanation("fig-4-2", "The moon is made of oil") == ""
