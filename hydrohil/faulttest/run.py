"""Plays the matrix: local trials and those in the cell one by one, the tests at the end, in one process of pytest."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from random import Random
from typing import NamedTuple

from hydrohil.cell.processes import CellError
from hydrohil.faulttest.proofs import NO_TESTS, ROOT, Proof, ProofsError, prove, together
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.tally import Result, Tried
from hydrohil.faulttest.trial import Lived, Played, Proved, Row, Trial, Untried, Way

QUICK = "left out by --quick"
INTERRUPTED = "interrupted"


class Wish(NamedTuple):
    """What the command line asks for."""

    trials: int
    seed: int
    quick: bool


Rigs = Mapping[str, Rig]  # "L": a cell for lockstep, "W": one for the wall clock


class FaultTest:
    """Rows under way; what is complete stays, whatever ends it."""

    def __init__(self, rows: Sequence[Row], rigs: Rigs, wish: Wish, show: Callable[[str, Trial | None], None]) -> None:
        """`show` is told of every trial: its row and way, and what it showed (None: it begins)."""
        self.rows, self.rigs, self.wish, self.show = tuple(rows), rigs, wish, show
        self.tried: dict[tuple[str, int], Tried] = {}

    def play(self) -> None:
        """Everything, one kind after the other: two cells at once would disturb each other. Ctrl-C leaves what is complete."""
        ways = [(row, place, way) for row in self.rows for place, way in enumerate(row.ways)]
        for row, place, way in ways:
            if isinstance(way, Untried):
                self.tried[row.number, place] = Tried(way, (), way.words)
            elif isinstance(way, Played):
                self._repeat(row, place, way, partial(self._alone, way))
        for letter, rig in self.rigs.items():
            mine = [(row, place, way) for row, place, way in ways if isinstance(way, Lived) and way.letter == letter]
            with rig:
                for row, place, way in mine:
                    if way.whole:
                        self._live(row, place, way, rig)
            for row, place, way in mine:  # those bring up cells of their own
                if not way.whole:
                    self._live(row, place, way, rig)
        proofs = [(row, place, way) for row, place, way in ways if isinstance(way, Proved)]
        for row, place, way in proofs:
            if is_left_out(way, self.wish):
                self.tried[row.number, place] = Tried(way, (), QUICK)
        self._prove([proof for proof in proofs if not is_left_out(proof[2], self.wish)])

    def results(self) -> tuple[Result, ...]:
        """Every row, complete or not."""
        return tuple(
            Result(row, tuple(self.tried.get((row.number, i)) or Tried(w, (), INTERRUPTED) for i, w in enumerate(row.ways)))
            for row in self.rows
        )

    def _repeat(self, row: Row, place: int, way: Played | Lived, trial: Callable[[int], Trial]) -> None:
        for number in range(count(way, self.wish.trials)):
            self.show(title(row, way), None)
            self._add(row, place, way, trial(number))

    def _alone(self, way: Played, number: int) -> Trial:
        return way.trial(self.wish.seed + number)

    def _live(self, row: Row, place: int, way: Lived, rig: Rig) -> None:
        if is_left_out(way, self.wish):
            self.tried[row.number, place] = Tried(way, (), QUICK)
        else:
            self._repeat(row, place, way, partial(self._in_cell, row, way, rig))

    def _in_cell(self, row: Row, way: Lived, rig: Rig, number: int) -> Trial:
        dice = Random(f"{self.wish.seed} {row.number} {way.words} {number}")
        try:
            trial = way.trial(rig, dice, number)
        except CellError as error:  # a cell that does not do what it should has not survived
            trial = Trial(False, str(error))
            if way.whole:
                rig.renew()
        if way.whole:
            rig.thaw()
            rig.revive()
        return trial

    def _add(self, row: Row, place: int, way: Way, trial: Trial) -> None:
        before = self.tried.get((row.number, place)) or Tried(way, ())
        self.tried[row.number, place] = before._replace(trials=(*before.trials, trial))
        self.show(title(row, way), trial)

    def _prove(self, proofs: list[tuple[Row, int, Proved]]) -> None:
        if not (ROOT / "tests").is_dir():
            for row, place, way in proofs:
                self.tried[row.number, place] = Tried(way, (), NO_TESTS)
            return
        if not proofs:
            return
        self.show("tests", None)
        try:
            found = prove(test for _, _, way in proofs for test in way.tests)
        except ProofsError as error:
            found = {test: Proof((Trial(False, str(error)),)) for _, _, way in proofs for test in way.tests}
        for row, place, way in proofs:
            proof = together(found[test] for test in way.tests)
            self.tried[row.number, place] = Tried(way, proof.trials, proof.skipped)
            if proof.trials:
                failed = [trial.words for trial in proof.trials if not trial.held]
                self.show(title(row, way), Trial(not failed, "; ".join(failed)))


def title(row: Row, way: Way) -> str:
    """A row and a way, briefly."""
    return f"{row.number} {way.letter} {way.words}"


def is_left_out(way: Way, wish: Wish) -> bool:
    """Whether a quick battery leaves it out: what takes the wall clock."""
    return wish.quick and isinstance(way, Lived | Proved) and way.letter == "W"


def count(way: Way, trials: int) -> int:
    """How many trials a way takes: its own most, or as many as asked for; tests, whatever their cases, are one."""
    return min(way.most, trials) if isinstance(way, Played | Lived) else int(isinstance(way, Proved))


def total(rows: Iterable[Row], wish: Wish) -> int:
    """Trials of all rows, for a bar."""
    return sum(count(way, wish.trials) for row in rows for way in row.ways if not is_left_out(way, wish))
