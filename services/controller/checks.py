"""Configurations whose fields are each valid but do not fit together: refused before anything moves, in one line each.

Every rule states what must hold, so that NaN fails.
"""

import math
from collections.abc import Iterator
from functools import lru_cache

from hydrohil.services.controller.config import (
    ControllerConfig,
    ImpedanceConfig,
    Reference,
    Segment,
    impedance_params,
    segment_table,
)
from hydrohil.services.controller.contact_environment import ContactEnvironment, resting_m
from hydrohil.services.controller.kinematics import clamp_joints, inverse
from hydrohil.services.controller.reference import CHANNELS, reference_deltas
from hydrohil.shared.contract.pose import forward
from hydrohil.shared.machine.description import LINK_TITLES, LINK_UNITS, Geometry, Triple

READS = {  # channels of a target
    "joint": CHANNELS[:3],
    "cartesian": CHANNELS[3:6],
    "impedance": CHANNELS[3:],
    "explicit": CHANNELS[6:],
}
JOINT_CHANNELS = CHANNELS[:3]
CHECK_STEP_S = 0.01  # travel is checked at 100 Hz: references of a machine that follows 1 Hz
CHECKED_AT_ONCE = 25  # points of a reference: a fraction of a millisecond, so that a loop that runs can check beside it


def check(
    config: ControllerConfig,
    reference: Reference,
    q0: Triple,
    pitch_rad: float = 0.0,
    met: ContactEnvironment | None = None,
    *,
    geometry: Geometry,
) -> None:
    """Raise ValueError, one line, for a configuration whose fields are each valid but do not fit together.

    Travel is that of the machine with this `geometry`. Where it is known what the tool meets, the force set-point must not
    take it out of that either.
    """
    for _ in examine(config, reference, q0, pitch_rad, met, geometry=geometry):
        pass


def examine(
    config: ControllerConfig,
    reference: Reference,
    q0: Triple,
    pitch_rad: float = 0.0,
    met: ContactEnvironment | None = None,
    *,
    geometry: Geometry,
) -> Iterator[None]:
    """`check` in steps, each short enough to be taken between two samples; raises as `check` does."""
    impedance = config.impedance
    if not impedance.stiffness_n_per_m / impedance.mass_kg < math.inf:
        raise ValueError(
            f"controller.impedance: mass_kg {impedance.mass_kg:g} kg is none beside {impedance.stiffness_n_per_m:g} N/m; raise it"
        )
    if impedance.setpoint_compensation and not impedance.environment_n_per_m > 0.0:
        raise ValueError("controller.impedance: setpoint_compensation needs environment_n_per_m > 0")
    if config.target == "explicit" and not impedance.environment_n_per_m > 0.0:
        raise ValueError("controller.impedance: target 'explicit' divides by environment_n_per_m; give k_eff in N/m, > 0")
    if impedance.formulation == "measured":
        check_measured(config)
    if not any(config.acting):
        raise ValueError("controller.acting: no link acts; let at least one be true")
    check_adaptation(config)
    check_setpoint_scaling(config)
    if not config.tight_slew_codes <= config.slew_codes:
        raise ValueError(f"controller: tight_slew_codes {config.tight_slew_codes} exceeds slew_codes {config.slew_codes}")
    for index, segment in enumerate(reference):
        if segment.channel in JOINT_CHANNELS and not config.acting[JOINT_CHANNELS.index(segment.channel)]:
            raise ValueError(f"reference segment {index} moves {segment.channel}, which controller.acting holds still")
        check_segment(segment, config.target, f"reference segment {index} ({segment.channel}, {segment.kind})")
    if not all(map(math.isfinite, (*q0, pitch_rad))):
        raise ValueError(f"plant: the start pose {q0} (rad, rad, m) is not finite; give numbers")
    check_travel(geometry, config.target, reference, q0, pitch_rad)
    if met is not None and config.target == "impedance":
        yield from check_push(geometry, config.impedance, reference, q0, pitch_rad, met)


def check_measured(config: ControllerConfig) -> None:
    """Raise ValueError where the alternate formulation has no meaning."""
    if config.target == "explicit":
        raise ValueError("controller: target 'explicit' is the equivalent of formulation 'setpoint'; choose that one")
    if config.target != "impedance":
        raise ValueError(f"controller: formulation 'measured' is of target 'impedance', not {config.target!r}; choose that one")
    if not all(config.acting):
        raise ValueError(
            "controller.acting: formulation 'measured' integrates what each axis has not reached: all links must act"
        )


def check_adaptation(config: ControllerConfig) -> None:
    """Raise ValueError for an adaptation without room between onset and ceiling, or of a target that has nothing to adapt."""
    adaptation = config.adaptation
    if adaptation.kind == "none":
        return
    if config.target != "impedance" or config.impedance.formulation != "setpoint":
        raise ValueError(f"controller.adaptation: {adaptation.kind!r} adapts target 'impedance', formulation 'setpoint' only")
    if not adaptation.onset_n < adaptation.ceiling_n:
        what = f"onset_n {adaptation.onset_n:g} N must lie below ceiling_n {adaptation.ceiling_n:g} N"
        raise ValueError(f"controller.adaptation: {what}")


def check_setpoint_scaling(config: ControllerConfig) -> None:
    """Raise ValueError for an apparent stiffness that nothing can show."""
    impedance = config.impedance
    soft, stiff = impedance.apparent_stiffness_n_per_m, impedance.stiffness_n_per_m
    if soft is None:
        return
    if config.target != "impedance" or impedance.formulation != "setpoint" or config.adaptation.kind != "none":
        needs = "target 'impedance', formulation 'setpoint', without adaptation"
        raise ValueError(f"controller.impedance: apparent_stiffness_n_per_m is of {needs}; leave it out or choose these")
    if not impedance.environment_n_per_m > 0.0:
        raise ValueError("controller.impedance: apparent_stiffness_n_per_m needs environment_n_per_m > 0: give k_eff in N/m")
    if not soft < stiff:
        raise ValueError(
            f"controller.impedance: apparent_stiffness_n_per_m {soft:g} N/m must lie below stiffness_n_per_m {stiff:g} N/m"
        )


def check_segment(segment: Segment, target: str, name: str) -> None:
    """Raise ValueError for a segment that cannot be followed or that its target does not read."""
    if segment.channel not in READS[target]:
        raise ValueError(f"{name}: target {target!r} reads {' or '.join(', '.join(READS[target]).rsplit(', ', 1))}")
    if segment.kind in ("ramp", "sine") and not segment.duration_s > 0.0:
        raise ValueError(f"{name}: duration_s must be > 0")
    if segment.kind == "ramp" and not 2.0 * segment.blend_s <= segment.duration_s:
        raise ValueError(f"{name}: two blends of {segment.blend_s} s do not fit into {segment.duration_s} s")
    if segment.kind == "sine" and not segment.frequency_hz > 0.0:
        raise ValueError(f"{name}: frequency_hz must be > 0")


@lru_cache(maxsize=64)
def check_travel(geometry: Geometry, target: str, reference: Reference, q0: Triple, pitch_rad: float) -> None:
    """Raise ValueError where the reference, before any force acts, leaves the travel of a link.

    It samples all of the reference, and thousands of trials share one: what was found right is remembered.
    """
    table = segment_table(reference)
    x0_m = forward(geometry, q0, pitch_rad)
    for time_s in check_times(reference):
        deltas = reference_deltas(table, time_s)
        if target == "joint":
            _, clamped = clamp_joints(geometry, (q0[0] + deltas[0], q0[1] + deltas[1], q0[2] + deltas[2]))
        else:
            _, clamped = inverse(geometry, (x0_m[0] + deltas[3], x0_m[1] + deltas[4], x0_m[2] + deltas[5]), pitch_rad)
        if clamped:
            raise ValueError(f"reference leaves the travel of {clamped_links(geometry, clamped)} at {time_s:.2f} s")


def check_push(
    geometry: Geometry,
    impedance: ImpedanceConfig,
    reference: Reference,
    q0: Triple,
    pitch_rad: float,
    met: ContactEnvironment,
) -> Iterator[None]:
    """Raise ValueError where the force set-point, held, would take the tool out of the travel of a link; in steps."""
    table, k = segment_table(reference), impedance.stiffness_n_per_m
    x0_m, axis = forward(geometry, q0, pitch_rad), met.force_axis
    gain = impedance_params(impedance, axis, met.force_sign).force_gain
    for number, time_s in enumerate(check_times(reference), 1):
        deltas = reference_deltas(table, time_s)
        x_m = [x0_m[i] + deltas[3 + i] for i in range(3)]
        x_m[axis] = resting_m(met, x0_m[axis], x_m[axis], gain * deltas[6], k)
        _, clamped = inverse(geometry, (x_m[0], x_m[1], x_m[2]), pitch_rad)
        if clamped:
            raise ValueError(
                f"force set-point {gain * deltas[6]:.4g} N on {k:g} N/m takes the tool beyond the travel of "
                f"{clamped_links(geometry, clamped)} at {time_s:.2f} s; lower it or stiffen the target"
            )
        if number % CHECKED_AT_ONCE == 0:
            yield


@lru_cache(maxsize=64)
def check_times(reference: Reference) -> tuple[float, ...]:
    """Times after tick 0 at which travel is checked: a grid through every moving segment, and every start and end."""
    ends = {0.0} | {s.start_s for s in reference} | {s.start_s + s.duration_s for s in reference}
    moving = [s for s in reference if s.kind != "step"]
    grid = {s.start_s + i * CHECK_STEP_S for s in moving for i in range(int(s.duration_s / CHECK_STEP_S) + 1)}
    return tuple(sorted(ends | grid))


def clamped_links(geometry: Geometry, mask: int) -> str:
    """The links of a clamp mask and the ends of their travel, e.g. 'down/up (high, 0.471 rad)'."""
    ends = zip(geometry.low_q, geometry.high_q, strict=True)
    limits = [  # in the order of the mask's bits
        f"{link} ({side}, {value:.3g} {unit})"
        for link, unit, both in zip(LINK_TITLES, LINK_UNITS, ends, strict=True)
        for side, value in zip(("low", "high"), both, strict=True)
    ]
    names = [limit for bit, limit in enumerate(limits) if mask >> bit & 1]
    return ", ".join(names) or "every link (too near the shoulder)"
