"""Chapter 4 of the thesis: five position laws on link 2, each on five patterns.

The figures' amplitudes and times are not in the text. They are chosen once here, the same for every law: 20 deg at
10 deg/s and 0.25 deg/s, more than two orders of magnitude in speed with the steps, and a 1 Hz sine of 1 deg that falls
linearly to nothing in 20 s. Multiple patterns go there and back.
"""

from typing import Literal, NamedTuple

from hydrohil.claims.pairs import PairClaim
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ControllerConfig, PlantConfig, Segment, StartPosition
from hydrohil.shared.units import RAD_PER_DEG
from hydrohil.thesis import claims4

JITTER_SUBSTEPS = 10  # 4.5 ms on average, "in (4, 5]": the program waited a whole number of milliseconds
Q3_M = 0.212  # d3' = 1 m: the lever at which the gains were tuned
BACK_S = 5.0  # patterns go there in the first half of the trial and back in the second

Law = Literal["pi", "morse", "vetia", "final", "deadband"]
Pattern = Literal["large-ramp", "large-step", "small-ramp", "small-step", "sine"]
LAW_TITLES: dict[Law, str] = {
    "pi": "PI control",
    "morse": "Modified Morse method",
    "vetia": "VETIA",
    "final": "Final position controller",
    "deadband": "Deadband compensation",
}
FIRST_FIGURE: dict[Law, int] = {"pi": 2, "morse": 7, "vetia": 16, "final": 21}  # deadband compensation has no figures
PATTERNS: tuple[Pattern, ...] = ("large-ramp", "large-step", "small-ramp", "small-step", "sine")  # in the figures' order


class Trajectory(NamedTuple):
    """A pattern of link 2: where it starts, what it does, how long."""

    start_deg: float
    reference: tuple[Segment, ...]
    duration_s: float = 2.0 * BACK_S


def ramps(start_s: float, height_deg: float, speed_deg_per_s: float, blend_s: float) -> tuple[Segment, ...]:
    """There and back at a constant speed, with parabolic (smooth) accelerations."""
    duration_s = height_deg / speed_deg_per_s + blend_s
    height_rad = height_deg * RAD_PER_DEG
    return (
        Segment("q2", kind="ramp", start_s=start_s, duration_s=duration_s, amount=height_rad, blend_s=blend_s),
        Segment("q2", kind="ramp", start_s=BACK_S + start_s, duration_s=duration_s, amount=-height_rad, blend_s=blend_s),
    )


def steps(start_s: float, height_deg: float) -> tuple[Segment, ...]:
    """There and back at once."""
    height_rad = height_deg * RAD_PER_DEG
    return (
        Segment("q2", "step", start_s, amount=height_rad),
        Segment("q2", "step", BACK_S + start_s, amount=-height_rad),
    )


SINE_S = 20.0
DECREASING_SINE = Segment(
    "q2", kind="sine", start_s=0.0, duration_s=SINE_S, amount=1.0 * RAD_PER_DEG, frequency_hz=1.0, amount_end=0.0
)
TRAJECTORIES: dict[Pattern, Trajectory] = {
    "large-ramp": Trajectory(-10.0, ramps(claims4.START_S, claims4.LARGE_DEG, 10.0, 0.5)),
    "large-step": Trajectory(-10.0, steps(claims4.START_S, claims4.LARGE_DEG)),
    "small-ramp": Trajectory(0.0, ramps(claims4.START_S, 0.69, 0.25, 0.1)),
    "small-step": Trajectory(0.0, steps(claims4.START_S, claims4.SMALL_DEG)),
    "sine": Trajectory(0.0, (DECREASING_SINE,), SINE_S),
}


def experiment(law: Law, pattern: Pattern) -> Experiment:
    """One of the 25 trials, named after its figure where it has one."""
    trajectory, descriptive = TRAJECTORIES[pattern], f"{law}-{pattern}"
    figure = f"4-{FIRST_FIGURE[law] + PATTERNS.index(pattern)}" if law in FIRST_FIGURE else ""
    words = "decreasing sine wave" if pattern == "sine" else pattern.replace("-", " ")
    return Experiment(
        name=f"fig-{figure}" if figure else descriptive,
        alias=descriptive,
        title=f"{LAW_TITLES[law]}, {words} pattern",
        source=f"thesis figure {figure}" if figure else "thesis 4.5.1, in words",
        duration_s=trajectory.duration_s,
        plant=PlantConfig(
            initial_q=StartPosition(down_up=trajectory.start_deg * RAD_PER_DEG, out_in=Q3_M), jitter_substeps=JITTER_SUBSTEPS
        ),
        controller=ControllerConfig(law=law, target="joint"),
        reference=trajectory.reference,
        claims=claims4.CLAIMS[descriptive],
    )


LAWS: tuple[Law, ...] = ("pi", "morse", "deadband", "vetia", "final")
EXPERIMENTS = tuple(experiment(law, pattern) for law in LAWS for pattern in PATTERNS)
PAIRS: tuple[PairClaim, ...] = claims4.PAIRS
