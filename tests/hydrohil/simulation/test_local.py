"""The local clock: the same bits again, a trip at the sample that earns it, and plain Python as the live services run it."""

import numpy as np
import pytest

from hydrohil.experiment.experiment import Experiment
from hydrohil.services.controller.config import ControllerConfig, ImpedanceConfig, Segment, segment_table
from hydrohil.services.controller.step import control_start
from hydrohil.services.plant.config import GateLimits, PlantConfig, StartPosition, tare_ticks
from hydrohil.services.plant.device import Timeline
from hydrohil.services.plant.emulator import Emulator
from hydrohil.services.plant.noise import force_noise_n, sample_intervals
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment
from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.shared.contract.messages import GateCause, GateState, Mode, TripCause
from hydrohil.shared.machine import unimate
from hydrohil.simulation.columns import columns
from hydrohil.simulation.loop import begin, play
from hydrohil.simulation.rollout import SEGMENT_COLUMNS, play_local, rollout, setup

SURFACE_M = UNIMATE_PARAMS.a2_m - UNIMATE_PARAMS.a4_m + 0.002  # the plate presses on the tool from the start
PLANT = PlantConfig(
    environment=Environment("plate", stiffness_n_per_m=7208.0, surface_m=SURFACE_M),
    initial_q=StartPosition(0.0, 0.0, 0.212),
    jitter_substeps=10,
    bias_s=0.3,
)


def press(duration_s=2.0, **limits):
    """A force step of 100 N on the soft plate."""
    return Experiment(
        name="press",
        alias="press",
        title="Press",
        source="test",
        duration_s=duration_s,
        plant=PLANT,
        controller=ControllerConfig(
            impedance=ImpedanceConfig(
                mass_kg=500.0,
                stiffness_n_per_m=50e3,
                damping_ratio=1.2,
                damping="net",
                environment_n_per_m=6200.0,
                setpoint_compensation=True,
            )
        ),
        supervisor=SupervisorConfig(**limits),
        reference=(Segment("force", "step", 0.1, amount=100.0),),
    )


@pytest.fixture(scope="module")
def pressed():
    return play_local(press(), 3)


def tared_n(outcome):
    """What the supervisor judged at every tick from 0 on."""
    counts = outcome.rows.force_counts[-outcome.first_tick :]
    return counts * unimate.UNIMATE.force.scale - outcome.supervisor.observer.bias.mean_n


def test_the_tool_presses_and_the_trial_runs_to_its_declared_end(pressed):
    assert len(pressed.rows.tick) == 444 - pressed.first_tick
    assert (pressed.rows.tick[0], pressed.rows.tick[-1]) == (-tare_ticks(PLANT), 443)
    assert (pressed.supervisor.mode, pressed.gate.state) == (Mode.RUNNING, GateState.OPEN)
    assert 60.0 < tared_n(pressed)[-50:].mean() < 140.0
    assert (pressed.rows.mode == Mode.RUNNING).all()


def test_the_valves_are_shut_while_the_bias_is_taken(pressed):
    bias = slice(0, -pressed.first_tick)
    assert (pressed.rows.dac_counts[bias] == 2048).all()
    assert (pressed.rows.true_q[bias] == pressed.rows.true_q[0]).all()
    force_n = pressed.rows.force_counts[bias] * unimate.UNIMATE.force.scale
    assert pressed.supervisor.observer.bias.mean_n == pytest.approx(force_n.mean())
    assert pressed.supervisor.observer.bias.spread_n == pytest.approx(force_n.std(), rel=1e-6)


def test_the_same_seed_gives_the_same_bits_and_another_does_not(pressed):
    again, other = play_local(press(), 3), play_local(press(), 4)
    for first, second in zip(pressed.rows, again.rows, strict=True):
        assert first.tobytes() == second.tobytes()
    assert (pressed.supervisor, pressed.gate) == (again.supervisor, again.gate)
    assert pressed.rows.force_counts.tobytes() != other.rows.force_counts.tobytes()


def test_a_force_limit_just_below_the_peak_trips_at_that_very_tick_and_one_at_the_peak_does_not(pressed):
    force_n = tared_n(pressed)
    peak_n, at = float(force_n.max()), int(force_n.argmax())
    limit_n = float(np.nextafter(peak_n, 0.0))
    tripped = play_local(press(force_limit_n=limit_n), 3)
    assert tripped.rows.tick[-1] == at
    end = tripped.supervisor
    assert (end.mode, end.cause, end.measured, end.limit) == (Mode.TRIPPED, TripCause.FORCE_TARED, peak_n, limit_n)
    assert (tripped.gate.cause, tripped.gate.codes) == (GateCause.NO_PERMIT, (2048, 2048, 2048))
    assert tripped.gate.revoked[0] == 1
    rows = len(tripped.rows.tick)
    assert tripped.rows.force_counts.tobytes() == pressed.rows.force_counts[:rows].tobytes()
    assert play_local(press(force_limit_n=peak_n), 3).rows.tick[-1] == 443


def test_a_raw_limit_below_the_first_reading_ends_the_trial_at_its_first_tick(pressed):
    first_n = float(pressed.rows.force_counts[0] * unimate.UNIMATE.force.scale)
    assert first_n > 0.0
    tripped = play_local(press(raw_force_limit_n=first_n / 2), 3)
    assert (len(tripped.rows.tick), tripped.supervisor.cause) == (1, TripCause.FORCE_RAW)


def test_the_gate_cuts_by_itself_at_its_own_limit_and_the_supervisor_sees_it_one_sample_later(pressed):
    raw_n = pressed.rows.force_counts * unimate.UNIMATE.force.scale
    limit_n = float(np.nextafter(raw_n.max(), 0.0))
    cut = play_local(press(), 3, GateLimits(force_limit_n=limit_n))
    assert cut.rows.tick[-1] == pressed.rows.tick[raw_n.argmax()] + 1
    assert (cut.supervisor.cause, cut.gate.codes) == (TripCause.GATE_CUT, (2048, 2048, 2048))


def plain_parts(experiment, seed):
    prepared = setup(experiment, GateLimits())
    count = prepared.supervise.duration_ticks - prepared.first_tick
    machine = experiment.plant.machine
    noise_n = force_noise_n(seed, prepared.first_tick, count, machine.force_noise_sigma_n, machine.force_noise_clip_n)
    intervals = sample_intervals(
        seed, prepared.first_tick, count, experiment.plant.sample_period_substeps, experiment.plant.jitter_substeps
    )
    table = np.array(segment_table(experiment.reference), dtype=np.float64).reshape(-1, SEGMENT_COLUMNS)
    return prepared, count, table, [float(value) for value in noise_n], [int(value) for value in intervals]


def test_plain_python_plays_the_compiled_trial_bit_for_bit():
    experiment = press(0.4)
    prepared, count, table, noise_n, intervals = plain_parts(experiment, 3)
    out = columns(count)
    start = begin(prepared, control_start(prepared.control), intervals)
    end = play(setup=prepared, underway=start, table=table, faults=(), noise_n=noise_n, intervals=intervals, out=out, end=count)
    compiled = play_local(experiment, 3)
    assert end.row == count == len(compiled.rows.tick)
    for name, plain, machine in zip(out._fields, out, compiled.rows, strict=True):
        assert plain.tobytes() == machine.tobytes(), name
    assert end.watch == compiled.supervisor
    assert end.gate == compiled.gate
    assert (out.dac_counts != 2048).any()


def test_the_emulator_given_the_same_codes_is_the_rollouts_machine(pressed):
    prepared, _, _, _, intervals = plain_parts(press(), 3)
    timeline = Timeline()
    emulator = Emulator(timeline, 400)
    emulator.load(PLANT, 3, prepared.first_tick, len(intervals), ())
    emulator.begin()
    start = 0
    for i in range(len(pressed.rows.tick)):
        timeline.substep, timeline.number, timeline.tick = start, i, int(pressed.rows.tick[i])
        reading, actual = emulator.read(), emulator.ground_truth()
        assert reading.encoder_counts == tuple(pressed.rows.encoder_counts[i])
        assert reading.force_counts == pressed.rows.force_counts[i]
        assert actual.q == tuple(pressed.rows.true_q[i])
        assert actual.pressure_a_pa == tuple(pressed.rows.pressure_a_pa[i])
        timeline.substep = start + prepared.latch_substeps
        running = timeline.tick >= 0
        emulator.write(tuple(int(code) for code in pressed.rows.dac_counts[i]) if running else (2048, 2048, 2048))
        start += intervals[i]


def test_a_trace_begins_with_tick_0():
    trace = rollout(press(0.4), 3)
    assert (trace.tick[0], trace.t_s[0], len(trace.tick)) == (0, 0.0, 89)
    assert (trace.sample_age_s == 0.0036).all()
