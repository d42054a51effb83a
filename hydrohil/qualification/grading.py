"""The rule by which a rate is qualified: it turns measured numbers into a grade.

Each condition says what must HOLD, so that a number that is missing (NaN) fails. Those that are `required_to_run` must hold for a
trial to run at all; all of them must hold for a rate to be qualified.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from hydrohil.qualification.spread import Spread
from hydrohil.shared.contract.deadline_window import WINDOW, missed_limit, quality
from hydrohil.shared.host.lease import MAX_LEASE_NS, MIN_LEASE_NS, required_lease_ns

# A tenth of what the supervisor's rule on quality allows for: a link that loses 1 % each way. A late sample holds the
# valves for one period more; ten times as many changed no verdict of fig-4-25, fig-5-5 and fig-5-9 (commands lost in lockstep).
LATE_SHARE = 0.001
ENOUGH_SAMPLES = 1000  # fewer cannot show one in a thousand
_NS_PER_US, _NS_PER_MS = 1e3, 1e6
GRADES = {
    "A": "every sample on time, and the lease of industrial arms suffices: real runs equal lockstep",
    "B": "qualified",
    "C": "not qualified; trials run, with more late samples than a claim may rest on",
    "D": "not qualified; trials trip, have gaps, or come close to it",
}


class Figures(NamedTuple):
    """What was measured at one rate. NaN = not measured."""

    period_ns: int
    wake_ups_us: Spread = Spread()  # lateness of an empty process on the grid, in the rig's scheduling class
    wake_ups_shifting: float = math.nan  # of them, so late that the plant shifts its grid
    wake_ups_skipping: float = math.nan  # of them, later than a period
    limit_us: Spread = Spread()  # the machine's own: the same without the rig's code
    limit_by: str = ""  # program that measured it
    ping_us: Spread = Spread()  # bare round trip between two processes
    ping_lost: float = math.nan
    ended: str = "no trial was run"  # why the trial did not come to its end with every tick; "" = it did
    samples: int = 0  # of the trial
    unanswered: float = math.nan  # of them, without their command in force at the latch
    shifts: float = math.nan  # samples and latches so late that the plant's grid was shifted
    lost: float = math.nan  # frames missing at any receiver
    late_permits: float = math.nan
    worst_window: float = math.nan  # share in time of the worst 100 samples in a row
    accepted_us: Spread = Spread()  # sample -> accepted command, of those that were accepted
    grid_us: Spread = Spread()  # lateness of the plant's own wake-ups


class Condition(NamedTuple):
    """One row of the rule."""

    what: str
    measured: Callable[[Figures], float]
    holds: Callable[[Figures], bool]
    words: Callable[[Figures], str]  # what does not hold, with its number and limit
    required_to_run: bool  # must hold for a trial to run at all

    def reason(self, figures: Figures) -> str:
        """Why it does not hold."""
        return self.words(figures) if math.isfinite(self.measured(figures)) else f"{self.what}: not measured"


class Verdict(NamedTuple):
    """A rate, judged."""

    grade: str
    qualified: bool
    reasons: tuple[str, ...]  # conditions that do not hold


def late_share(figures: Figures) -> float:
    """Share of the samples that were taken late, or whose command was not in force at the latch. NaN without samples."""
    return (figures.unanswered + figures.shifts) / figures.samples if figures.samples else math.nan


def lost_share(figures: Figures) -> float:
    """Frames lost a sample. NaN without samples."""
    return figures.lost / figures.samples if figures.samples else math.nan


def lease_ns(figures: Figures) -> float:
    """The lease that this host needs, by the plant's own rule over every wake-up. NaN where any was not measured."""
    worst_us = (figures.wake_ups_us.max, figures.grid_us.max)
    return math.nan if any(map(math.isnan, worst_us)) else float(required_lease_ns(int(max(worst_us) * _NS_PER_US)))


def floor(period_ns: int) -> float:
    """The supervisor's own floor of quality at the lease of industrial arms: a longer lease would lower it."""
    return quality(missed_limit(MIN_LEASE_NS // period_ns))


def _measured(figures: Figures) -> bool:
    every = (*figures.wake_ups_us, *figures.limit_us, *figures.ping_us, *figures.accepted_us)
    return all(map(math.isfinite, every))


RULE = (
    Condition(
        what="the end of the trial",
        measured=lambda _: 0.0,
        holds=lambda f: f.ended == "",
        words=lambda f: f"the trial did not come to its end: {f.ended}",
        required_to_run=True,
    ),
    Condition(
        what="wake-ups, the machine's own, the ping-pong or the loop",
        measured=lambda f: 0.0 if _measured(f) else math.nan,
        holds=_measured,
        words=lambda _: "",
        required_to_run=True,
    ),
    Condition(
        what=f"the worst {WINDOW} samples",
        measured=lambda f: f.worst_window,
        holds=lambda f: f.worst_window >= floor(f.period_ns),
        words=lambda f: (
            f"in the worst {WINDOW} samples {f.worst_window:.0%} were in time, the supervisor asks for {floor(f.period_ns):.0%}"
        ),
        required_to_run=True,
    ),
    Condition(
        what="the lease",
        measured=lease_ns,
        holds=lambda f: lease_ns(f) <= MAX_LEASE_NS,
        words=lambda f: (
            f"wake-ups need a lease of {lease_ns(f) / _NS_PER_MS:.0f} ms, at most {MAX_LEASE_NS / _NS_PER_MS:.0f} are given"
        ),
        required_to_run=True,
    ),
    Condition(
        what="the number of samples",
        measured=lambda f: float(f.samples),
        holds=lambda f: f.samples >= ENOUGH_SAMPLES,
        words=lambda f: (
            f"{f.samples} samples are too few to show one late in a thousand: {ENOUGH_SAMPLES} are needed (--seconds)"
        ),
        required_to_run=False,
    ),
    Condition(
        what="late samples",
        measured=late_share,
        holds=lambda f: late_share(f) <= LATE_SHARE,
        words=lambda f: f"{late_share(f):.2%} of the samples were taken or answered late, {LATE_SHARE:.1%} may be",
        required_to_run=False,
    ),
    Condition(
        what="lost frames",
        measured=lost_share,
        holds=lambda f: lost_share(f) <= LATE_SHARE,
        words=lambda f: f"{f.lost:.0f} frames were lost in {f.samples} samples, {LATE_SHARE:.1%} may be",
        required_to_run=False,
    ),
)


def judge(figures: Figures) -> Verdict:
    """Grade and reasons of one rate."""
    broken = [condition for condition in RULE if not condition.holds(figures)]
    reasons = tuple(condition.reason(figures) for condition in broken)
    if broken:
        return Verdict("D" if any(condition.required_to_run for condition in broken) else "C", False, reasons)
    nothing_late = late_share(figures) == 0 and figures.late_permits == 0 and figures.lost == 0
    perfect = nothing_late and lease_ns(figures) <= MIN_LEASE_NS
    return Verdict("A" if perfect else "B", True, ())


def is_evidence(figures: Figures) -> bool:
    """Whether a trial says something of this host: it ended badly, or was long enough."""
    return figures.ended != "" or figures.samples >= ENOUGH_SAMPLES


def qualified_period_ns(verdicts: dict[int, Verdict]) -> int:
    """The shortest period in ns that is qualified, if no longer one was tried without success; 0 = none."""
    qualified = 0
    for period_ns in sorted(verdicts, reverse=True):
        if not verdicts[period_ns].qualified:
            break
        qualified = period_ns
    return qualified


def deciding_period_ns(verdicts: dict[int, Verdict]) -> int:
    """The trial that a record quotes: that of the qualified rate, or of the lowest rate tried."""
    return qualified_period_ns(verdicts) or max(verdicts)
