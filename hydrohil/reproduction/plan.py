"""What there is to reproduce: every figure in the order of the thesis, by chapter and name, and which trials go together."""

import re
from collections.abc import Iterable, Sequence
from functools import cache
from typing import Any, NamedTuple

from hydrohil.claims.pairs import PairClaim
from hydrohil.claims.study import Study
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment
from hydrohil.reproduction.studies import STUDIES
from hydrohil.shared.contract.assignments import nearest
from hydrohil.thesis.library import SECOND_FIGURES, catalogue, pairs

CHAPTERS = {
    "4": "4. Position control",
    "5": "5. Position based impedance control",
    "6": "6. Explicit force control",
    "7": "7. Limit cycles",
    "9": "9. Beyond the thesis: its list of future work",
    "appendix": "Appendices",
}
LAST = 999  # a computed figure without a number comes after those of its chapter


class Figure(NamedTuple):
    """A trial or a computed figure, as one entry of the page."""

    name: str
    subject: Experiment | Study
    chapter: str  # a key of CHAPTERS
    also: tuple[str, ...]  # second figures of the same trial, other names of a computed figure

    @property
    def names(self) -> tuple[str, ...]:
        """Every name by which it is found."""
        return tuple(dict.fromkeys((self.name, self.subject.alias, *self.also)))

    @property
    def computed(self) -> bool:
        """Whether it is a study of other trials, or of none."""
        return isinstance(self.subject, Study)

    def has(self, words: Iterable[str]) -> bool:
        """Whether names, title and chapter together hold every one of `words`, in any case of the letters."""
        line = " ".join((*self.names, self.subject.title, CHAPTERS[self.chapter])).casefold()
        return all(word.casefold() in line for word in words)

    def summary(self) -> dict[str, Any]:
        """What `hydrohil list --json` prints of it: `claims` of a trial, `computed` of a figure that is none."""
        about = {"name": self.name, "alias": self.subject.alias, "title": self.subject.title}
        return about | ({"computed": True} if isinstance(self.subject, Study) else {"claims": len(self.subject.claims)})

    @property
    def pairs(self) -> tuple[PairClaim, ...]:
        """Claims that set this trial against another."""
        return tuple(claim for claim in pairs() if claim.of == self.name)

    @property
    def trials(self) -> tuple[str, ...]:
        """Names of every experiment that its claims look at."""
        if isinstance(self.subject, Study):
            return self.subject.trials
        return tuple(dict.fromkeys((self.name, *(claim.against for claim in self.pairs))))


class Group(NamedTuple):
    """Figures that look at the same trials, so that each is played once."""

    figures: tuple[str, ...]
    trials: tuple[str, ...]


def chapter_of(name: str, source: str) -> str:
    """The chapter that a figure's source is in, by its number or by that of a section."""
    if "Appendix" in source:
        return "appendix"
    found = re.match(r"fig-(\d+)-", name) or re.search(r"(\d+)[-.]\d", source)
    if found is None or found[1] not in CHAPTERS:
        raise ValueError(f"{name}: its source, {source!r}, names no chapter: expected one of {', '.join(CHAPTERS)}")
    return found[1]


@cache
def figures() -> tuple[Figure, ...]:
    """Trials in the order of the library; a computed figure stands among them by its number."""
    second = {name: tuple(figure for figure, of in SECOND_FIGURES.items() if of == name) for name in SECOND_FIGURES.values()}
    subjects: tuple[Experiment | Study, ...] = (*catalogue(), *STUDIES)
    second |= {study.name: study.also for study in STUDIES}
    found = [Figure(s.name, s, chapter_of(s.name, s.source), second.get(s.name, ())) for s in subjects]
    order, reached = {}, dict.fromkeys(CHAPTERS, 0)
    for figure in found:
        number = re.match(r"fig-\d+-(\d+)", figure.name)
        at = int(number[1]) if number else LAST if figure.computed else reached[figure.chapter]
        if not figure.computed:
            reached[figure.chapter] = at  # what has no number stays with its predecessor
        order[figure.name] = ([*CHAPTERS].index(figure.chapter), at)
    return tuple(sorted(found, key=lambda figure: order[figure.name]))


def find_figure(name: str) -> Figure:
    """The figure of any of its names. Raises ExperimentError with the nearest names."""
    known = {alias: figure for figure in figures() for alias in figure.names}
    if name not in known:
        hint = nearest(name, known, "those that `hydrohil list` shows")
        raise ExperimentError([f"{name} is no figure: use a chapter ({', '.join(CHAPTERS)}) or one of {hint}"])
    return known[name]


def choose(chosen: Sequence[str]) -> tuple[Figure, ...]:
    """Figures of chapters (`5`, `appendix`) and by name (`fig-4-25`); all, if nothing is asked for. Raises ExperimentError."""
    names: set[str] = set()
    problems: list[str] = []
    for word in chosen:
        try:
            if word not in CHAPTERS:
                names.add(find_figure(word).name)
        except ExperimentError as unknown:
            problems += unknown.problems
    if problems:
        raise ExperimentError(problems)
    return tuple(figure for figure in figures() if not chosen or figure.name in names or figure.chapter in chosen)


def groups(chosen: Iterable[Figure]) -> tuple[Group, ...]:
    """`chosen`, joined where they share a trial."""
    found: list[Group] = []
    for figure in chosen:
        mine = set(figure.trials)
        touching = [group for group in found if mine & set(group.trials)]
        found = [group for group in found if group not in touching]
        names = tuple(name for group in touching for name in group.figures)
        trials = dict.fromkeys((*(trial for group in touching for trial in group.trials), *figure.trials))
        found.append(Group((*names, figure.name), tuple(trials)))
    return tuple(found)
