"""The qualification of a host in one call: rates from the highest down, until one is qualified."""

from collections.abc import Callable, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

from hydrohil.cell.processes import Place
from hydrohil.qualification.grading import Figures, is_evidence, judge
from hydrohil.qualification.host import Found, found, load_now
from hydrohil.qualification.measure import STEPS, Settings, measure
from hydrohil.qualification.record import RateTrial, keep, plain
from hydrohil.shared.compiled.kernel import source_version
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.exit_status import EXIT_CLAIM, EXIT_OK
from hydrohil.shared.host.qualified import Host, Qualified, record_file, this_host
from hydrohil.shared.units import NS_PER_S, SUBSTEP_NS

RATES_HZ = (1000.0, 500.0, 222.2, 100.0)
PLACE = Place("qualify", 7750)  # its ports lie beside those of a cell that is up, and beside those of the fault test
SHORTEST_SUBSTEPS, LONGEST_SUBSTEPS = 20, 200  # sampling periods that a plant accepts
LOOP_S, BASELINE_S = 20.0, 5.0
QUICK_SAMPLES, QUICK_BASELINE_S = 1000, 1.0


class RateError(HydrohilError, ValueError):
    """A sampling rate that no plant accepts."""


class RecordError(HydrohilError):
    """The record cannot be written; `qualification` holds what was measured."""

    def __init__(self, message: str, qualification: "Qualification") -> None:
        """Keep the measurement, so that minutes of work are not lost."""
        super().__init__(message)
        self.qualification = qualification


class QualificationProgress(NamedTuple):
    """What is being measured, and for how long already."""

    period_ns: int
    step: str
    elapsed_s: float  # at this rate
    total_s: float  # at this rate


class Qualification(NamedTuple):
    """What was found of this host, what each rate gave, and what is on record now."""

    host: Host
    facts: tuple[Found, ...]  # the host as found, with what is recommended
    trials: tuple[RateTrial, ...]  # in the order in which they were run
    fifo: bool  # whether the host granted real-time scheduling; with and without it there is a record each
    on_record: Qualified | None = None  # None: nothing was recorded
    record_file: Path | None = None

    @property
    def qualified_period_ns(self) -> int:
        """The shortest sampling period that was qualified now; 0 = none."""
        return min((one.figures.period_ns for one in self.trials if one.verdict.qualified), default=0)

    @property
    def exit_status(self) -> int:
        """0 if a rate is qualified, otherwise 1."""
        return EXIT_OK if self.qualified_period_ns else EXIT_CLAIM

    def summary(self) -> dict[str, Any]:
        """Every number, ready for JSON; None is what was not measured."""
        return {
            "host": self.host._asdict(),
            "fifo": self.fifo,
            "source_version": source_version(),
            "found": [fact._asdict() for fact in self.facts],
            "trials": [plain(one) for one in self.trials],
            "qualified_period_ns": self.qualified_period_ns or None,
            "exit_status": self.exit_status,
        }


def qualify(
    rates_hz: Sequence[float] = RATES_HZ,
    *,
    seconds: float | None = None,
    quick: bool = False,
    realtime: bool = True,
    place: Place = PLACE,
    record: bool = True,
    progress: Callable[[QualificationProgress], object] = lambda _: None,
) -> Qualification:
    """Measure this host at each rate (100 to 1000 Hz) in turn, until one is qualified, and put the result on record.

    At each rate: wake-ups of an empty process, the machine's own, a bare ping-pong, then the full loop for `seconds` in a private
    cell at `place`. Without `seconds` the loop lasts 20 s, or if `quick` the 1000 samples that a qualification needs. From then
    on no cell on this host arms above the qualified rate on the real clock. `record=False` leaves the record as it is.

    Raises RateError before anything is measured, CellError where no cell comes up, RecordError where the record cannot be
    written. KeyboardInterrupt passes through; then nothing is recorded.
    """
    trials: list[RateTrial] = []
    granted: dict[str, bool] = {}
    load = load_now()
    for period in [_period_substeps(rate_hz) for rate_hz in rates_hz]:
        settings = Settings(place, _loop_s(period, seconds, quick=quick), QUICK_BASELINE_S if quick else BASELINE_S, realtime)
        measured = measure(settings, period, _step_progress(settings, period, progress))
        granted = measured.granted
        trials.append(judged(measured.figures))
        if trials[-1].verdict.qualified:
            break
    result = Qualification(this_host(), found(granted, load), tuple(trials), granted.get("fifo", False))
    return recorded(result) if record else result


def _period_substeps(rate_hz: float) -> int:
    """Sub-steps of the sampling period that is nearest to a rate. Raises RateError where the plant accepts none such."""
    period = round(NS_PER_S / (rate_hz * SUBSTEP_NS)) if rate_hz > 0.0 else 0
    if not SHORTEST_SUBSTEPS <= period <= LONGEST_SUBSTEPS:
        lowest, highest = (NS_PER_S / (substeps * SUBSTEP_NS) for substeps in (LONGEST_SUBSTEPS, SHORTEST_SUBSTEPS))
        raise RateError(f"rate_hz is {rate_hz:g} Hz: expected {lowest:g} to {highest:g} Hz")
    return period


def _loop_s(period_substeps: int, seconds: float | None, *, quick: bool) -> float:
    if seconds is not None:
        return seconds
    return QUICK_SAMPLES * period_substeps * SUBSTEP_NS / NS_PER_S if quick else LOOP_S


def _step_progress(
    settings: Settings, period: int, progress: Callable[[QualificationProgress], object]
) -> Callable[[str, float], object]:
    total_s = STEPS * settings.baseline_s + settings.seconds
    return lambda step, elapsed_s: progress(QualificationProgress(period * SUBSTEP_NS, step, elapsed_s, total_s))


def judged(figures: Figures) -> RateTrial:
    """The figures of one rate with their verdict, dated now."""
    return RateTrial(figures, judge(figures), datetime.now().astimezone().isoformat(" ", "seconds"))


def recorded(result: Qualification) -> Qualification:
    """The qualification, put on record as far as it says something of this host. Raises RecordError."""
    file = record_file(result.host, fifo=result.fifo)
    try:
        on_record = keep(file, result.host, result.trials)
    except OSError as reason:
        words = f"{file}: cannot be written ({reason.strerror or reason}): make room or name another"
        raise RecordError(words, result) from None
    if not any(is_evidence(one.figures) for one in result.trials):
        return result
    return result._replace(on_record=on_record, record_file=file)
