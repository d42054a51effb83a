"""Where a link is tuned, by what measure, and what a step of the procedure leaves behind."""

from collections.abc import Callable
from typing import NamedTuple

from hydrohil.claims.trace import Trace
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import LinkGains
from hydrohil.shared.units import A_PER_MA, A_PER_RAD_PER_MA_PER_DEG, RAD_PER_DEG
from hydrohil.tuning import measure
from hydrohil.tuning.measure import Ringing, lasting, whole
from hydrohil.tuning.patterns import Law, Pattern, middle_q, trial

Run = Callable[[Experiment, int], Trace]  # one trial with the noise of a seed: on the local clock, or in a live cell
OUT_IN = 2  # the link that slides


class Criteria(NamedTuple):
    """What "stable", "maximum" and "optimum" of Appendix C mean in numbers: choices of this rig, since the text gives none."""

    ripple_counts: float = 0.76  # sqrt(1/12 + 1/2): one count of amplitude on the sawtooth of the encoder; below, no ringing
    decay: float = 0.9  # ringing that has not lost a tenth in a second is none that dies away
    hunting: int = 1  # one last correction at rest is none; turning round is
    margin: float = 1.2  # stable K_P over the one taken: the supply varies by 7 %, the inertia with the reach
    windup_share: float = 0.25  # of a large step, that linear PI may overshoot (4.3: wind-up is "expectedly large")
    overshoot_counts: float = 2.5  # two counts: the resolution that the text calls the limit (4.6)
    swing_ratio: float = 1.1  # of the sine's large swings under Morse's law, which then are tracked to a tenth (4.4)
    alpha_cost: float = 0.05  # of the error of the ramp, for an alpha that forgets sooner
    precision: float = 0.03  # to which a limit is found


class Bench(NamedTuple):
    """One link of one rig, ready for trials."""

    run: Run
    experiment: Experiment
    link: int
    seeds: tuple[int, ...]
    criteria: Criteria = Criteria()


Cell = float | int | str


class Step(NamedTuple):
    """One step of Appendix C: its rule, the values that were tried and measured, and the decision."""

    number: int
    title: str
    rule: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    decision: str
    gains: LinkGains | None  # none: no acceptable value was found


def middle(bench: Bench) -> float:
    """Where the bench's link is tuned, rad (link 3: m)."""
    return middle_q(bench.experiment, bench.link, bench.experiment.controller.gains[bench.link])


def play(bench: Bench, law: Law, gains: LinkGains, setpoint: Pattern) -> tuple[Trace, ...] | None:
    """One trace a seed; none if a trial did not run to its end."""
    experiment = trial(bench.experiment, bench.link, law, gains, setpoint, middle(bench))
    traces = []
    for seed in bench.seeds:
        trace = bench.run(experiment, seed)
        if not whole(trace, experiment.duration_s):
            return None
        traces.append(trace)
    return tuple(traces)


def unit(link: int) -> str:
    """Unit in which people state a link's position."""
    return "m" if link == OUT_IN else "deg"


def rad_per_unit(link: int) -> float:
    """Size of `unit(link)` in rad (link 3: in m)."""
    return 1.0 if link == OUT_IN else RAD_PER_DEG


def a_per_printed(link: int) -> float:
    """1 mA/deg in A/rad (link 3: 1 mA/m in A/m): factor of every gain of Table 2 that has a current in it."""
    return A_PER_MA if link == OUT_IN else A_PER_RAD_PER_MA_PER_DEG


def worst_ringing(bench: Bench, traces: tuple[Trace, ...], setpoint: Pattern) -> Ringing:
    """Ringing of the seed in which it lasts longest."""
    least = bench.criteria.ripple_counts
    return max((measure.ringing(trace, bench.link, setpoint, least) for trace in traces), key=lambda ring: lasting(ring, least))


def rings_on(criteria: Criteria, ring: Ringing) -> bool:
    """Whether there is ringing at the end that has not died away since the beginning."""
    return ring.late > max(criteria.ripple_counts, criteria.decay * ring.early)


def yes(passed: bool) -> str:
    """`passed` as a word of the table."""
    return "yes" if passed else "no"
