"""Every combination of broken rules: the most severe decides, and no further broken rule makes a verdict less severe.

Exhaustive: every subset of the first and of the last 12 rows (of all rows while there are at most 12), every pair and every
triple. For any number n of rows, all 2^n subsets by induction: one link of the fold is tried with both answers of its row
in front of a rest that is opaque, and the chain is shown to be these links alone, one a row in order, then nothing. If the
rest decides by its first broken row, so does the link in front of it.
"""

from itertools import combinations
from types import FunctionType

import pytest

from hydrohil.services.supervisor.rules import RULES, _before, _nothing_broken, first_broken, fold

N = len(RULES)
FULL = 12


def flagged(rows):
    """The rows with flags in place of predicates: bit i of what is observed set = row i is broken."""
    return tuple(
        rule._replace(
            holds=lambda observed, _, i=i: not observed >> i & 1,
            measured=lambda observed, _, i=i: float(i),
            limit=lambda observed, _, i=i: -float(i),
        )
        for i, rule in enumerate(rows)
    )


def first_of(broken, rows):
    """What must come out: cause and numbers of the lowest set bit."""
    if not broken:
        return 0, 0.0, 0.0
    i = (broken & -broken).bit_length() - 1
    return int(rows[i].cause), float(i), -float(i)


@pytest.mark.parametrize("rows", [RULES[:FULL], RULES[-FULL:]], ids=["first 12", "last 12"])
def test_of_every_subset_the_first_broken_row_decides(rows):
    verdict = fold(flagged(rows))
    for broken in range(2 ** len(rows)):
        assert verdict(broken, None) == first_of(broken, rows)


@pytest.mark.parametrize("size", [0, 1, 2, 3])
def test_of_every_pair_and_triple_of_all_rows_the_first_decides(size):
    verdict, rows = fold(flagged(RULES)), RULES
    for chosen in combinations(range(N), size):
        broken = sum(1 << i for i in chosen)
        assert verdict(broken, None) == first_of(broken, rows)


@pytest.mark.parametrize("rows", [RULES[:FULL], RULES[-FULL:]], ids=["first 12", "last 12"])
def test_severity_is_monotone_another_broken_rule_never_makes_the_verdict_less_severe(rows):
    verdict = fold(flagged(rows))
    place = {0: len(rows)} | {int(rule.cause): i for i, rule in enumerate(rows)}
    severity = [place[verdict(broken, None)[0]] for broken in range(2 ** len(rows))]
    for broken, decided in enumerate(severity):
        for i in range(len(rows)):
            assert severity[broken | 1 << i] == min(decided, i)


def links(chain):
    """(predicate, cause) of each link of a folded chain, front to back, and what stands at its end."""
    found = []
    while chain is not _nothing_broken:
        cells = dict(zip(chain.__code__.co_freevars, (cell.cell_contents for cell in chain.__closure__), strict=True))
        found.append((chain, cells["holds"], cells["cause"]))
        chain = cells["rest"]
    return found


def test_the_chain_is_one_link_a_row_in_order_and_nothing_else():
    found = links(first_broken)
    assert [(holds, cause) for _, holds, cause in found] == [(rule.holds, int(rule.cause)) for rule in RULES]
    code = {link.__code__ for link, _, _ in found}
    assert len(code) == 1  # every link is the same code
    assert code == {_before(lambda *_: True, 1, float, float, _nothing_broken).__code__}
    assert isinstance(first_broken, FunctionType)


def test_a_link_gives_its_own_verdict_if_its_row_is_broken_and_else_the_rest_s_untouched():
    asked, theirs = [], (99, 1.5, 2.5)

    def rest(observed, limits):
        asked.append((observed, limits))
        return theirs

    for holds in (True, False):
        asked.clear()
        link = _before(
            lambda observed, limits, holds=holds: holds,
            7,
            lambda observed, limits: observed,
            lambda observed, limits: limits,
            rest,
        )
        assert link(3.0, 4.0) == (theirs if holds else (7, 3.0, 4.0))
        assert asked == ([(3.0, 4.0)] if holds else [])


def test_the_end_of_the_chain_finds_nothing_broken():
    assert _nothing_broken(None, None) == (0, 0.0, 0.0)
    assert fold(()) is _nothing_broken


def test_rows_stand_in_the_order_of_severity():
    causes = [int(rule.cause) for rule in RULES]
    assert 0 not in causes
    assert len(set(causes)) == N
