from functools import cache

from hydrohil.reproduction.explanations import DEVIATIONS, explanation
from hydrohil.reproduction.plan import Figure, find_figure
from hydrohil.reproduction.play import play

KEYS = [key for deviation in DEVIATIONS for key in deviation.of]


@cache
def stated(figure: Figure) -> set[str]:
    """Every statement of a figure; what a computed one states is known once it is computed."""
    if not figure.computed:
        return {claim.statement for claim in (*figure.subject.claims, *figure.pairs)}
    traces = [play(find_figure(name).subject, 0).trace for name in figure.trials]
    return {verdict.claim.statement for verdict in figure.subject.run(traces).verdicts}


def test_every_explanation_is_of_a_statement_of_that_figure():
    for name, statement in KEYS:
        figure = find_figure(name)
        assert figure.name == name
        assert statement in stated(figure), f"{name}: {statement}"


def test_no_statement_is_explained_twice():
    assert len(KEYS) == len(set(KEYS))


def test_what_has_no_row_is_unexplained():
    assert explanation("fig-4-2", "The moon is made of oil") == ""
