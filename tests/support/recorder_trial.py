"""A made-up trial that looks like a real one: approach, contact, a sine in force, a trip near the end."""

import math
from collections.abc import Iterator

from hydrohil.shared.contract.codec import WIRE_VERSION, Header, Received
from hydrohil.shared.contract.converters import current_to_code
from hydrohil.shared.contract.messages import (
    NO_TRIAL,
    Command,
    ControllerState,
    GateCause,
    GateEvent,
    GateState,
    GroundTruth,
    Mode,
    Permit,
    Sample,
    TripCause,
)
from hydrohil.shared.contract.topics import BY_KEY
from hydrohil.shared.machine.description import machine_id
from hydrohil.shared.machine.unimate import UNIMATE
from tests.support.machines import description

PERIOD_NS = 4_500_000
TARE_TICKS = 444
FIRST_NUMBER = 1000  # samples before it belong to no trial
ARMING_ID, PLANT_EPOCH = 2**61 + 12345, 77
SENDERS = {key: topic.publisher for key, topic in BY_KEY.items()}
DESCRIPTION = description(force_axis=2, force_sign=1.0)


def received(key: str, body: object, seq: int, echo: int = -1, arrival_ns: int = 0, epoch: int = PLANT_EPOCH) -> Received:
    header = Header(
        version=WIRE_VERSION,
        schema=BY_KEY[key].schema,
        cell="bench",
        run=1,
        experiment=b"",
        sender=SENDERS[key],
        epoch=epoch,
        arming_id=ARMING_ID,
        seq=seq,
        echo_number=echo,
        echo_time_ns=0,
    )
    return Received(arrival_ns, key, header, body)


def trial(ticks: int = 1200, outside: int = 30, trip_tick: int = 10**9) -> Iterator[Received]:
    """`outside` samples without a trial, the force bias, then `ticks` of the reference."""
    yield received("plant/description", DESCRIPTION, 0)
    events = 0
    for i in range(outside + TARE_TICKS + ticks):
        tick = i - outside - TARE_TICKS if i >= outside else NO_TRIAL
        yield from _sample(i, tick, trip_tick)
        if tick == trip_tick:
            event = GateEvent(
                number=FIRST_NUMBER + i,
                tick=tick,
                state=GateState.REVOKED,
                cause=GateCause.FORCE_ABOVE_LIMIT,
                permit_age_ns=3_600_000,
                command_age_ns=3_600_000,
                measured=431.9,
                limit=420.0,
            )
            yield received("plant/gate", event, events, arrival_ns=i * PERIOD_NS + 200_000)
            events += 1


def _sample(i: int, tick: int, trip_tick: int) -> Iterator[Received]:
    number, arrival = FIRST_NUMBER + i, 10**9 + i * PERIOD_NS
    t = tick * PERIOD_NS / 1e9 if tick != NO_TRIAL else -3.0
    running, tripped = tick >= 0, tick >= trip_tick
    s, contact = max(0.0, t), max(0.0, t - 2.0)
    force_set = 100.0 + 60.0 * math.sin(2.0 * math.pi * 0.25 * contact) if contact else 0.0
    force = force_set * (1.0 - math.exp(-contact / 0.4)) + (14.0 * math.sin(23.0 * t) * math.exp(-contact) if contact else 0.0)
    force += 320.0 * max(0.0, t - trip_tick * PERIOD_NS / 1e9 + 0.15) / 0.15 if not tripped else 320.0
    noise = 6.0 * math.sin(997.0 * i) * math.cos(31.0 * i * i)
    z_nominal = -0.37 - 0.05 * min(s, 3.0)
    z_set = z_nominal + force / 5000.0
    z = z_set + 0.0012 * math.sin(3.0 * t) * running
    out = 0.30 + 0.02 * s * running
    q = (0.05 * math.sin(0.5 * s) * running, math.asin((-0.37 - z) / (out + 0.788)), out)
    qd = (0.025 * math.cos(0.5 * s) * running, 0.045 * (0.0 < s < 3.0), 0.02 * running)
    current = (
        0.05 * math.sin(0.5 * s) * running,
        (0.114 if qd[1] > 0.0 else 0.02 + 0.07 * math.sin(9.0 * t)) * running,
        0.14 * math.sin(1.5 * t) * running,
    )
    gate = GateState.REVOKED if tripped else GateState.OPEN if running else GateState.SHUT
    cause = GateCause.FORCE_ABOVE_LIMIT if tripped else GateCause.NONE if running else GateCause.NOT_RUNNING
    dac = tuple(current_to_code(UNIMATE.drive, c) if gate == GateState.OPEN else 2048 for c in current)
    counts = tuple(int((v - c.offset) / c.scale) for v, c in zip((*q, 0.0, -q[1]), UNIMATE.encoders, strict=True))
    late = 3 if i % 400 == 399 else 0
    age = 1_900_000 + int(500_000 * abs(math.sin(i))) + 2_500_000 * (late > 0)
    sample = Sample(
        number=number,
        time_ns=i * PERIOD_NS,
        tick=tick,
        trial_time_ns=tick * PERIOD_NS if tick != NO_TRIAL else 0,
        encoder_counts=counts,
        force_counts=int((force + noise) / UNIMATE.force.scale),
        dac_counts=dac,
        gate=gate,
        gate_cause=cause,
        gate_open_samples=max(0, tick),
        recover_signs=(0, 0, 0),
        command_number=number - 1,
        command_late_substeps=late,
        command_age_ns=age,
    )
    yield received("plant/sample", sample, i, arrival_ns=arrival)
    tip = ((q[2] + 0.788) * math.cos(q[0]), (q[2] + 0.788) * math.sin(q[0]), z)
    stuck = tuple(int(abs(c) < 0.09 and running) for c in current)
    pressure_a, pressure_b = tuple(3.5e6 + 8e6 * c for c in current), tuple(3.5e6 - 8e6 * c for c in current)
    yield received(
        "plant/ground_truth",
        GroundTruth(
            number=number,
            tick=tick,
            q=q,
            qd=qd,
            pressure_a_pa=pressure_a,
            pressure_b_pa=pressure_b,
            spool_a=current,
            sticking=stuck,
            tip_m=tip,
            contact_force_n=force,
            environment_m=0.0,
        ),
        i,
        arrival_ns=arrival,
    )
    mode = Mode.TRIPPED if tripped else Mode.RUNNING if running else Mode.ARMED if tick != NO_TRIAL else Mode.DISARMED
    trip = (TripCause.FORCE_TARED, 341.2, 334.0, number) if tripped else (TripCause.NONE, 0.0, 0.0, -1)
    permit = Permit(
        mode=mode,
        cause=trip[0],
        measured=trip[1],
        limit=trip[2],
        trip_number=trip[3],
        first_sample=FIRST_NUMBER + 30 if tick != NO_TRIAL else -1,
        duration_ticks=3000,
        tare_ticks=TARE_TICKS,
        recover_signs=(0, 0, 0),
        force_limit_n=334.0,
        force_bias_n=4.2,
    )
    yield received("supervisor/permit", permit, i, number, arrival + 700_000, epoch=5)
    yield received("controller/command", Command(dac), i, number, arrival + age - 400_000, epoch=6)
    q_set = (q[0] + 0.0004 * math.sin(5 * t), q[1] + 0.001 * math.sin(3 * t), q[2] + 0.002 * math.sin(2 * t))
    state = ControllerState(
        number=number,
        tick=tick,
        q=q,
        q_set=q_set,
        qd=tuple(v + 0.004 * math.sin(40 * t) for v in qd),
        qd_set=qd,
        x_m=tip,
        x_set_m=(tip[0], tip[1], z_set),
        x_nominal_m=(tip[0], tip[1], z_nominal),
        force_n=force + noise,
        force_mean_n=force + 0.3 * noise,
        force_set_n=force_set,
        force_bias_n=4.2,
        current_a=current,
        integral_a=tuple(0.6 * c for c in current),
        boosted=tuple(int(abs(c) > 0.1) for c in current),
        clamped=int(abs(current[2]) > 0.135),
        ready=1,
        machine_id=machine_id(DESCRIPTION.machine_hash),
        compute_ns=310_000 + int(60_000 * abs(math.sin(3.0 * i))),
    )
    yield received("controller/state", state, i, number, arrival + 900_000, epoch=6)


def exact(messages: list[Received]) -> list[list[float]]:
    """The scalars of messages, one by one: what a recording must give back."""
    return [[m.header.seq, *(x for v in m.body for x in (v if isinstance(v, tuple) else (v,)))] for m in messages]
