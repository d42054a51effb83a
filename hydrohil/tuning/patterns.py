"""The five test patterns of chapter 4 for any link: scaled by its fastest set speed, placed in the middle of its travel."""

from typing import Literal, NamedTuple

from hydrohil.claims.signals import JOINTS
from hydrohil.experiment.experiment import Experiment
from hydrohil.experiment.sections import ActingLinks, AdaptationConfig, Environment, ImpedanceConfig, LinkGains, Segment
from hydrohil.shared.machine.description import LINKS
from hydrohil.shared.units import RAD_PER_DEG
from hydrohil.thesis.chapter4 import TRAJECTORIES, Trajectory
from hydrohil.thesis.chapter4 import Pattern as PatternName
from hydrohil.thesis.claims4 import LARGE_DEG, SMALL_DEG, START_S, THERE_S

FASTEST_RAD_PER_S = 10.0 * RAD_PER_DEG  # of the patterns in `chapter4`
SETTLE_S = 0.2  # of a ramp's constant speed that is left to its start
REST_S = 2.0  # at the end of each half of a pattern the link should stand
Law = Literal["pi", "morse", "vetia", "final"]


class Pattern(NamedTuple):
    """A set-point of one link, there and back: rad, or m for link 3."""

    name: str
    start_q: float  # from the middle of the place where the link is tuned
    reference: tuple[Segment, ...]
    duration_s: float
    size_q: float

    @property
    def cruises_s(self) -> tuple[tuple[float, float], ...]:
        """Windows of constant set speed, without their very beginning."""
        ramps = [segment for segment in self.reference if segment.kind == "ramp"]
        return tuple((r.start_s + r.blend_s + SETTLE_S, r.start_s + r.duration_s - r.blend_s) for r in ramps)

    @property
    def halves_s(self) -> tuple[tuple[float, float], ...]:
        """Windows of the way there and of the way back."""
        return ((0.0, THERE_S), (THERE_S + START_S / 2.0, 2.0 * THERE_S))

    @property
    def rests_s(self) -> tuple[tuple[float, float], ...]:
        """Windows at the end of each half in which the set-point stands."""
        return tuple((end - REST_S, end) for _, end in self.halves_s)


def pattern(name: PatternName, link: int, gains: LinkGains) -> Pattern:
    """A pattern of chapter 4 with every amount scaled by `link`'s fastest set speed over 10 deg/s."""
    trajectory: Trajectory = TRAJECTORIES[name]
    scale = gains.qd_max_q_per_s / FASTEST_RAD_PER_S
    sizes = {"large-ramp": LARGE_DEG, "large-step": LARGE_DEG}
    return Pattern(
        name,
        start_q=trajectory.start_deg * RAD_PER_DEG * scale,
        reference=tuple(_scaled(segment, link, scale) for segment in trajectory.reference),
        duration_s=trajectory.duration_s,
        size_q=sizes.get(name, SMALL_DEG) * RAD_PER_DEG * scale,
    )


def _scaled(segment: Segment, link: int, scale: float) -> Segment:
    end = None if segment.amount_end is None else segment.amount_end * scale
    return segment._replace(channel=JOINTS[link], amount=segment.amount * scale, amount_end=end)


def slow_ramp(link: int, start_q: float, speed_q_per_s: float, duration_s: float) -> Pattern:
    """A set-point that creeps away for the whole trial, so that a proportional law raises its current slowly."""
    size = speed_q_per_s * duration_s
    creep = Segment(JOINTS[link], kind="ramp", start_s=0.0, duration_s=duration_s, amount=size)
    return Pattern("slow ramp", start_q=start_q, reference=(creep,), duration_s=duration_s, size_q=size)


def middle_q(experiment: Experiment, link: int, gains: LinkGains) -> float:
    """Where the link is tuned: its initial pose, moved so far that the large pattern and as much again fit into its limits."""
    reach = LARGE_DEG * RAD_PER_DEG * gains.qd_max_q_per_s / FASTEST_RAD_PER_S
    low, high = experiment.supervisor.joint_low_q[link] + reach, experiment.supervisor.joint_high_q[link] - reach
    return 0.5 * (low + high) if low > high else min(max(experiment.plant.initial_q[link], low), high)


def trial(experiment: Experiment, link: int, law: Law, gains: LinkGains, setpoint: Pattern, middle: float) -> Experiment:
    """`experiment`'s plant in free space with one link on `setpoint` under `law` and `gains`.

    The other valves stay shut: each link is tuned in isolation (Appendix C).
    """
    name = LINKS[link]
    controller = experiment.controller._replace(
        law=law,
        target="joint",
        acting=ActingLinks(*(one == name for one in LINKS)),
        gains=experiment.controller.gains._replace(**{name: gains}),
        impedance=ImpedanceConfig(),
        adaptation=AdaptationConfig(),
    )
    initial_q = experiment.plant.initial_q._replace(**{name: middle + setpoint.start_q})
    plant = experiment.plant._replace(environment=Environment(), initial_q=initial_q)
    return experiment._replace(
        name=f"tune-{JOINTS[link]}",
        alias=f"tune-{JOINTS[link]}",
        title=f"tuning {JOINTS[link]}: {law}, {setpoint.name}",
        source="thesis Appendix C",
        duration_s=setpoint.duration_s,
        plant=plant,
        controller=controller,
        reference=setpoint.reference,
        claims=(),
    )
