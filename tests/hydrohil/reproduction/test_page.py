"""The page: complete, valid, alone."""

import math
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

from hydrohil.claims.claims import verdict
from hydrohil.reproduction.page import heading, page
from hydrohil.reproduction.plan import figures, find_figure
from hydrohil.reproduction.play import Found
from hydrohil.reproduction.tally import result
from tests.support.reproduction_scene import CLAIM, SVG, computed, report, trial


def text(document):
    return " ".join("".join(ElementTree.fromstring(page(document)).itertext()).split())


def everything():
    """Every figure of the library with all its claims, none of which was measured."""
    results = []
    for figure in figures():
        claims = () if figure.computed else (*figure.subject.claims, *figure.pairs)
        results.append(result(figure, [(0, Found(figure.name, tuple(verdict(claim, math.nan) for claim in claims)))], ()))
    return report(*results)


class Tags(HTMLParser):
    """Ids, targets, and whatever would load something."""

    def __init__(self):
        super().__init__()
        self.ids, self.targets, self.loads = [], [], []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.ids += [given["id"]] if "id" in given else []
        self.targets += [given["href"]] if tag == "a" else []
        self.loads += [value for name, value in attrs if name in ("src", "srcset", "data") or (tag == "link" and name == "href")]


def test_every_figure_and_every_claim_is_on_the_page_and_links_lead_somewhere():
    document = everything()
    words, tags = text(document), Tags()
    tags.feed(page(document))
    assert {name for figure in figures() for name in (figure.name, *figure.also)} <= set(tags.ids)
    assert all(target.removeprefix("#") in tags.ids for target in tags.targets)
    assert len(tags.ids) == len(set(tags.ids))
    for figure in figures():
        assert f"{heading(figure)}: {figure.subject.title}" in words
        for claim in () if figure.computed else (*figure.subject.claims, *figure.pairs):
            assert " ".join(claim.statement.split()) in words and " ".join(claim.source.split()) in words


def test_the_page_loads_nothing_from_elsewhere():
    document, tags = page(report(trial(20), computed())), Tags()
    tags.feed(document)
    assert tags.loads == []
    assert not re.search(r"@import|url\((?!#)", document)


def test_what_was_stated_measured_and_concluded_is_shown_with_its_words_escaped():
    words = text(report(trial(19), computed()))
    assert "a < b & c" in words and 'thesis 6.2.1: "<sic>"' in words
    assert "within 1..2 mm" in words and "1.5 mm" in words
    assert "holds: 19 of 20" in words
    assert "2 of 2 claims hold" in words


def test_a_claim_that_fails_is_shown_failing_and_unexplained():
    words = text(report(trial(18), computed()))
    assert "1 of 2 claims hold" in words
    assert "does NOT hold: 18 of 20" in words
    assert "Claims that do not hold" in words and "unexplained" in words
    assert "Claims that do not hold" not in text(report(trial(20)))


def test_a_trip_and_a_gap_are_shown_as_no_verdict():
    assert "No verdict on fig-5-9: seed 0: too much" in text(report(trial(0, 1, tripped="too much")))
    assert "No verdict on fig-5-9: seed 0: tick 3 is missing" in text(report(trial(0, 1, gap="tick 3 is missing")))


def test_pictures_and_parameters_stand_beside_the_claims():
    document = page(report(trial(20)))
    assert document.count(SVG) == 2 and document.count("<figcaption>Motion plot</figcaption>") == 1
    assert "controller.impedance.stiffness_n_per_m = 1000.0" in document
    assert "hydrohil show fig-5-9 --toml" in document
    assert CLAIM.statement in document


def test_a_trial_that_is_set_against_is_no_link_where_it_is_not_on_the_page():
    figure = find_figure("fig-4-2")
    found = Found(figure.name, tuple(verdict(claim, 9.0) for claim in figure.pairs))
    document, tags = page(report(result(figure, [(0, found)], ()))), Tags()
    tags.feed(document)
    assert "against fig-4-21" in document
    assert all(target.removeprefix("#") in tags.ids for target in tags.targets)


def test_a_figure_is_headed_by_all_its_numbers():
    assert heading(find_figure("fig-5-9")) == "Figure 5-9, 5-10"
    assert heading(find_figure("deadband-sine")) == "deadband-sine"
