"""The rows of the matrix under way: local trials and those in cells one by one, then all tests in one process of pytest."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from random import Random
from typing import NamedTuple

from hydrohil.cell.processes import CellError
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.row_tests import NO_TESTS, ROOT, NodeOutcome, RowTestsError, combined, run_row_tests
from hydrohil.faulttest.tally import RowResult, WayResult
from hydrohil.faulttest.trial import ByTests, Live, NotTried, Row, Simulated, Trial, Way

LEFT_OUT = "left out by --quick"
INTERRUPTED = "interrupted"


class Settings(NamedTuple):
    """How often, with which seed, and whether what takes the wall clock is left out."""

    trials: int
    seed: int
    quick: bool


Rigs = Mapping[str, Rig]  # "L": a cell for lockstep, "W": one for the wall clock
Progress = Callable[[str, Trial | None], None]  # is given a row and its way, and what a trial showed; None where it begins


class Execution:
    """Plays the rows; complete results stay if it is interrupted."""

    def __init__(self, rows: Sequence[Row], rigs: Rigs, settings: Settings, progress: Progress) -> None:
        """Nothing runs before `play`."""
        self.rows, self.rigs, self.settings, self.progress = tuple(rows), rigs, settings, progress
        self.tried: dict[tuple[str, int], WayResult] = {}  # by a row's number and a way's index in it

    def play(self) -> None:
        """Everything, one kind after the other, since two cells at once would disturb each other.

        A KeyboardInterrupt passes through and leaves what is complete.
        """
        ways = [(row, index, way) for row in self.rows for index, way in enumerate(row.ways)]
        for row, index, way in ways:
            if isinstance(way, NotTried):
                self.tried[row.number, index] = WayResult(way, (), way.words)
            elif isinstance(way, Simulated):
                self._repeat(row, index, way, partial(self._simulated, way))
        for letter, rig in self.rigs.items():
            live = [(row, index, way) for row, index, way in ways if isinstance(way, Live) and way.letter == letter]
            with rig:
                for row, index, way in live:
                    if way.in_shared_cell:
                        self._live(row, index, way, rig)
            for row, index, way in live:  # those bring up cells of their own
                if not way.in_shared_cell:
                    self._live(row, index, way, rig)
        by_tests = [(row, index, way) for row, index, way in ways if isinstance(way, ByTests)]
        for row, index, way in by_tests:
            if is_left_out(way, self.settings):
                self.tried[row.number, index] = WayResult(way, (), LEFT_OUT)
        self._run_tests([one for one in by_tests if not is_left_out(one[2], self.settings)])

    def results(self) -> tuple[RowResult, ...]:
        """Every row, complete or not."""
        return tuple(RowResult(row, tuple(self._result(row, index) for index in range(len(row.ways)))) for row in self.rows)

    def _result(self, row: Row, index: int) -> WayResult:
        return self.tried.get((row.number, index)) or WayResult(row.ways[index], (), INTERRUPTED)

    def _repeat(self, row: Row, index: int, way: Simulated | Live, trial: Callable[[int], Trial]) -> None:
        for number in range(count(way, self.settings.trials)):
            self.progress(title(row, way), None)
            self._add(row, index, way, trial(number))

    def _simulated(self, way: Simulated, number: int) -> Trial:
        return way.trial(self.settings.seed + number)

    def _live(self, row: Row, index: int, way: Live, rig: Rig) -> None:
        if is_left_out(way, self.settings):
            self.tried[row.number, index] = WayResult(way, (), LEFT_OUT)
        else:
            self._repeat(row, index, way, partial(self._in_cell, row, way, rig))

    def _in_cell(self, row: Row, way: Live, rig: Rig, number: int) -> Trial:
        rng = Random(f"{self.settings.seed} {row.number} {way.words} {number}")
        try:
            trial = way.trial(rig, rng, number)
        except CellError as error:  # a cell that does not do what it should counts as not survived
            trial = Trial(False, str(error))
            if way.in_shared_cell:
                rig.restart_all()
        if way.in_shared_cell:
            rig.thaw()
            rig.restart_ended()
        return trial

    def _add(self, row: Row, index: int, way: Way, trial: Trial) -> None:
        before = self.tried.get((row.number, index)) or WayResult(way, ())
        self.tried[row.number, index] = before._replace(trials=(*before.trials, trial))
        self.progress(title(row, way), trial)

    def _run_tests(self, chosen: list[tuple[Row, int, ByTests]]) -> None:
        if not (ROOT / "tests").is_dir():
            for row, index, way in chosen:
                self.tried[row.number, index] = WayResult(way, (), NO_TESTS)
            return
        if not chosen:
            return
        self.progress("tests", None)
        try:
            found = run_row_tests(test for _, _, way in chosen for test in way.tests)
        except RowTestsError as error:
            found = {test: NodeOutcome((Trial(False, str(error)),)) for _, _, way in chosen for test in way.tests}
        for row, index, way in chosen:
            outcome = combined(found[test] for test in way.tests)
            self.tried[row.number, index] = WayResult(way, outcome.trials, outcome.skipped)
            if outcome.trials:
                failed = [trial.words for trial in outcome.trials if not trial.held]
                self.progress(title(row, way), Trial(not failed, "; ".join(failed)))


def title(row: Row, way: Way) -> str:
    """A row and a way, briefly."""
    return f"{row.number} {way.letter} {way.words}"


def is_left_out(way: Way, settings: Settings) -> bool:
    """Whether a quick fault test leaves it out: what takes the wall clock."""
    return settings.quick and isinstance(way, Live | ByTests) and way.letter == "W"


def count(way: Way, trials: int) -> int:
    """How many trials a way takes: `trials`, but not more than its own maximum; all tests of a way count as one."""
    return min(way.max_trials, trials) if isinstance(way, Simulated | Live) else int(isinstance(way, ByTests))


def total(rows: Iterable[Row], settings: Settings) -> int:
    """Trials of all rows, for a bar."""
    return sum(count(way, settings.trials) for row in rows for way in row.ways if not is_left_out(way, settings))
