"""The one table of causes: what happened with its numbers and units, what must hold, what to do.

The supervisor's rules and the gate judge; every report of a trip has its words from here: status, run report, event log, trip
report, campaign. The numbers are those of the message: of a trip the permit's, of a cut the gate event's.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from hydrohil.shared.contract.messages import GateCause, TripCause


class Cause(NamedTuple):
    """Words for people. `happened` has places for `measured` and `limit`, both in `unit`; it is "" where there are no numbers."""

    happened: str
    holds: str
    remedy: str
    unit: str = ""


_UNLOAD = "`hydrohil recover` lowers it with the gate's consent, then `hydrohil reset`"
_GAUGE = "check gauge, cable and amplifier; a reading that is not valid is never taken for zero; then `hydrohil reset`"
_ENCODER = "check encoder and cable, and that its zero is where it was: a pose that jumped is not known; then `hydrohil reset`"
_VALVE = "check supply pressure, valve, its cable and the encoder; then `hydrohil reset`"
_SLOWER = "ask for less, or find what drove it; then `hydrohil reset`"
_TRANSPORT = "see the ages and counters: who was late or silent; then `hydrohil reset`"
_JOINT, _JOINT_SPEED = "rad (sliding joint: m)", "rad/s (sliding joint: m/s)"
_ANEW = "find out who said so; then `hydrohil reset`, and arm again"

TRIPS: dict[TripCause, Cause] = {
    TripCause.ESTOP: Cause(
        "the operator pressed the emergency stop",
        "no emergency stop is pressed, at the gate or at the supervisor",
        "when the reason is gone: `hydrohil reset` (it releases gate and supervisor)",
    ),
    TripCause.FORCE_INVALID: Cause(
        "the force reading was {measured:.0f} counts, outside its valid range that ends at {limit:.0f}",
        "the force reading lies inside the gauge's range and is not saturated",
        _GAUGE,
        "counts",
    ),
    TripCause.FORCE_RAW: Cause(
        "the raw force reached {measured:.1f} N against its limit of {limit:.1f} N",
        "the force as read, with its bias, is at most the raw limit, either sign",
        _UNLOAD,
        "N",
    ),
    TripCause.FORCE_TARED: Cause(
        "the contact force reached {measured:.1f} N against its limit of {limit:.1f} N",
        "the force without its bias is at most the force limit, either sign",
        _UNLOAD,
        "N",
    ),
    TripCause.FORCE_FROZEN: Cause(
        "the force reading stood still for {measured:.0f} samples; {limit:.0f} are too many for its known noise",
        "the force reading shows the gauge's known noise",
        _GAUGE,
        "samples",
    ),
    TripCause.FORCE_JUMP: Cause(
        "the force reading jumped by {measured:.1f} N where noise and motion explain {limit:.1f} N",
        "from sample to sample the force changes by no more than noise, and the gauge's stiffness times the way, explain",
        _GAUGE,
        "N",
    ),
    TripCause.FORCE_RATE: Cause(
        "the contact force changed at {measured:.0f} N/s against its limit of {limit:.0f} N/s",
        "the contact force changes slowly enough to be stopped below its limit",
        _UNLOAD,
        "N/s",
    ),
    TripCause.FORCE_HELD: Cause(
        "the contact force stayed above its level for {measured:.2f} s against at most {limit:.2f} s",
        "the contact force stays above the contact level only briefly",
        _UNLOAD,
        "s",
    ),
    TripCause.FORCE_ENERGY: Cause(
        "this contact put {measured:.1f} J into the environment against its limit of {limit:.1f} J",
        "the work done on the environment by one contact is bounded",
        _UNLOAD,
        "J",
    ),
    TripCause.FORCE_DRIFT: Cause(
        "the force reading rose by {measured:.1f} N where the way into the environment explains {limit:.1f} N",
        "the force grows only as the tool goes further in",
        _GAUGE,
        "N",
    ),
    TripCause.FORCE_BELOW_BIAS: Cause(
        "the force read {measured:.1f} N below its bias against at most {limit:.1f} N",
        "the gauge, which can only be pushed, does not read below its bias",
        _GAUGE,
        "N",
    ),
    TripCause.BIAS: Cause(
        "the force bias, or its spread, was {measured:.1f} N against its limit of {limit:.1f} N",
        "before motion starts the gauge's bias is small and steady",
        "free the tool from contact, let it come to rest; then `hydrohil reset`",
        "N",
    ),
    TripCause.ENCODER_INVALID: Cause(
        "an encoder stood at {measured:.0f} counts, its counter ends at {limit:.0f}",
        "no encoder stands at an end of its counter",
        _ENCODER,
        "counts",
    ),
    TripCause.ENCODER_JUMP: Cause(
        "an encoder jumped by {measured:.4g} rad (sliding joint: m) where its link can move {limit:.4g}",
        "from sample to sample an encoder moves no further than its link can",
        _ENCODER,
        _JOINT,
    ),
    TripCause.MOTION_AGAINST: Cause(
        "a link moved by {measured:.4g} rad (sliding joint: m) against its current, it brakes within {limit:.4g}",
        "under a current above its worst break-away a link does not move against it",
        _VALVE,
        _JOINT,
    ),
    TripCause.NO_MOTION: Cause(
        "a link stood still for {measured:.3f} s under a current that moves it within {limit:.3f} s",
        "under a current above its worst break-away a link moves",
        _VALVE,
        "s",
    ),
    TripCause.JOINT_LIMIT: Cause(
        "a joint reached {measured:.4g} rad (sliding joint: m) against its limit of {limit:.4g}",
        "every joint lies inside its range",
        _UNLOAD,
        _JOINT,
    ),
    TripCause.WORKSPACE: Cause(
        "the tip reached {measured:.4g} m against its limit of {limit:.4g} m on one axis",
        "the tip lies inside the workspace",
        "move it back (another experiment, or by hand with the supply off); then `hydrohil reset`",
        "m",
    ),
    TripCause.JOINT_SPEED: Cause(
        "a joint moved at {measured:.4g} rad/s (sliding joint: m/s) against its limit of {limit:.4g}",
        "every joint is slower than its limit",
        _SLOWER,
        _JOINT_SPEED,
    ),
    TripCause.TIP_SPEED: Cause(
        "the tip moved at {measured:.4g} m/s against its limit of {limit:.4g} m/s",
        "the tip is slower than its limit",
        _SLOWER,
        "m/s",
    ),
    TripCause.SAMPLE_LOST: Cause(
        "{measured:.0f} samples were lost in a row against at most {limit:.0f} (below 0: the plant started anew)",
        "no more samples in a row are lost than a lease holds",
        _TRANSPORT,
        "samples",
    ),
    TripCause.SAMPLE_STALE: Cause(
        "no sample came for {measured:.4g} s against a lease of {limit:.4g} s",
        "the plant's samples come, each within a lease of the last",
        "see whether the plant lives (`hydrohil status`); then `hydrohil reset`",
        "s",
    ),
    TripCause.COMMAND_STALE: Cause(
        "the command in force answered a sample {measured:.0f} samples back against at most {limit:.0f}",
        "the controller's commands advance with the samples",
        "see whether the controller lives (`hydrohil status`); then `hydrohil reset`",
        "samples",
    ),
    TripCause.CONTROLLER_SILENT: Cause(
        "the controller's newest state answered a sample {measured:.0f} samples back against at most {limit:.0f}",
        "the controller's states reach the supervisor and advance with the samples",
        "see the link from controller to supervisor (`hydrohil status`); then `hydrohil reset`",
        "samples",
    ),
    TripCause.LINK_FAULTS: Cause(
        "{measured:.0f} frames of the plant or the controller came corrupt, again or late in a second, against {limit:.0f}",
        "at most one frame a second of a bound sender is corrupt, repeated or out of order",
        "see the counters: which link, and which fault; then `hydrohil reset`",
        "frames",
    ),
    TripCause.TWO_PUBLISHERS: Cause(
        "{measured:.0f} frames in a second came from a second plant or controller, or one started anew, against {limit:.0f}",
        "there is one plant and one controller, and neither starts anew while the machine moves",
        "end the other one; then `hydrohil reset`, and arm again",
        "frames",
    ),
    TripCause.OTHER_RUN: Cause(
        "{measured:.0f} frames of plant or controller were of another run or experiment than the permit, against {limit:.0f}",
        "every sample and every state of a running trial carries the permit's run and experiment",
        "load again: `hydrohil run NAME`; a service that was restarted has nothing loaded",
        "frames",
    ),
    TripCause.QUALITY: Cause(
        "a share of {measured:.2f} of the last 100 samples was answered in time, against at least {limit:.2f}",
        "of the last 100 samples no more stay unanswered than one outage of a lease and a link that loses 1 % explain",
        _TRANSPORT,
        "of the last 100 samples",
    ),
    TripCause.GATE_CUT: Cause(
        "the gate cut by itself",
        "the gate has not cut",
        "the gate's own cause decides; then `hydrohil reset`",
    ),
    TripCause.NOT_READY: Cause(
        "the controller was not ready when motion was to start",
        "the controller's buffers are full and its reference starts within 2 counts of the pose",
        "start the reference at the pose; then `hydrohil reset`",
    ),
}
CUTS: dict[GateCause, Cause] = {
    GateCause.NO_PERMIT: Cause("there was no permit", "a permit with an arming is held", "arm: `hydrohil run NAME`"),
    GateCause.NOT_RUNNING: Cause(
        "the permit no longer said that the trial runs",
        "the permit's mode is RUNNING from tick 0 on, or RECOVER",
        "the supervisor decides: see its cause",
    ),
    GateCause.REVOKED_ARMING: Cause(
        "the arming was revoked by an earlier cut", "the permit's arming was never cut", "`hydrohil reset`, and arm again"
    ),
    GateCause.PERMIT_STALE: Cause(
        "the permit was {measured:.4g} s old against a lease of {limit:.4g} s",
        "the permit's sample is at most a lease old, by the plant's own clock",
        "see whether the supervisor lives (`hydrohil status`); then `hydrohil reset`",
    ),
    GateCause.NO_COMMAND: Cause("there was no command", "a command is held", "start the controller; then arm again"),
    GateCause.COMMAND_STALE: Cause(
        "the command was {measured:.4g} s old against a lease of {limit:.4g} s",
        "the command's sample is at most a lease old, by the plant's own clock",
        "see whether the controller lives (`hydrohil status`); then `hydrohil reset`",
    ),
    GateCause.OTHER_ARMING: Cause(
        "permit and command were of different armings", "permit, command and gate carry one arming", _ANEW
    ),
    GateCause.EPOCH_CHANGED: Cause(
        "controller or supervisor was restarted, or there were two",
        "both senders are those that were bound when the gate opened",
        _ANEW,
    ),
    GateCause.IMPOSSIBLE_ECHO: Cause(
        "a permit or command named a sample that the plant never sent", "every echo is in the plant's ledger", _ANEW
    ),
    GateCause.OUT_OF_RANGE: Cause(
        "a code of the command was {measured:.0f}, outside the converter's range that ends at {limit:.0f}",
        "every code lies in the converter's range",
        _ANEW,
    ),
    GateCause.BEYOND_SLEW: Cause(
        "a code of the command stepped by {measured:.0f} against a slew limit of {limit:.0f}",
        "no code is further from the last accepted one than the slew limit",
        "check the controller's law; then `hydrohil reset`",
    ),
    GateCause.FORCE_INVALID: Cause(
        "the force reading was {measured:.0f} counts, outside its valid range that ends at {limit:.0f}",
        "the force reading lies inside the gauge's range and is not saturated",
        _GAUGE,
    ),
    GateCause.FORCE_ABOVE_LIMIT: Cause(
        "the raw force reached {measured:.1f} N against the gate's own limit of {limit:.1f} N",
        "the raw force is at most the gate's own limit",
        _UNLOAD,
    ),
    GateCause.NOT_UNLOADING: Cause(
        "a code of RECOVER was {measured:.0f}, beyond {limit:.0f}: it did not unload, or was too large",
        "in RECOVER only the unloading sign moves, at low current",
        _ANEW,
    ),
    GateCause.ESTOP: Cause(
        "the operator pressed the emergency stop",
        "no emergency stop is pressed at the gate",
        "when the reason is gone: `hydrohil reset`",
    ),
    GateCause.OVERRUN: Cause(
        "the plant itself stood still for longer than the lease",
        "the plant wakes within a lease of its grid",
        "free this host, or give a longer lease (`--permit-ttl-ms`); then `hydrohil reset`",
    ),
    GateCause.LINK_FAULTS: Cause(
        "{measured:.0f} frames of a bound sender came corrupt, again or late within a second, against at most {limit:.0f}",
        "at most one frame a second of a bound sender is corrupt, repeated or out of order",
        "see the counters: which link, and which fault; then `hydrohil reset`",
    ),
    GateCause.TWO_PUBLISHERS: Cause(
        "{measured:.0f} frames within a second came from a second controller or supervisor, against at most {limit:.0f}",
        "there is one controller and one supervisor",
        "end the other one; then `hydrohil reset`, and arm again",
    ),
}


def trip_words(cause: int, measured: float, limit: float, number: int) -> str:
    """A trip of the supervisor for people: what happened with its numbers and units, and the sample."""
    return f"{trip_happened(cause, measured, limit)} (sample {number})"


def cut_words(cause: int, measured: float, limit: float, number: int) -> str:
    """A cut of the gate for people: what happened with its numbers and units, and the sample."""
    return f"the gate cut by itself: {cut_happened(cause, measured, limit)} (sample {number})"


def trip_happened(cause: int, measured: float, limit: float) -> str:
    """What tripped, with its numbers; a cause of another version of the contract is reported by its number."""
    return _happened(TRIPS, cause, measured, limit)


def cut_happened(cause: int, measured: float, limit: float) -> str:
    """What the gate cut for, with its numbers; a cause of another version of the contract is reported by its number."""
    return _happened(CUTS, cause, measured, limit)


def _happened(table: Mapping[Any, Cause], cause: int, measured: float, limit: float) -> str:
    if (row := table.get(cause)) is None:
        return f"cause {cause}: {measured:.4g} against {limit:.4g}"
    return row.happened.format(measured=measured, limit=limit)
