"""Every fault of the machine on the local clock: from its first tick on, and not a bit before."""

import numpy as np
import pytest

from hydrohil.services.controller.step import control_start
from hydrohil.services.plant.noise import force_noise_n
from hydrohil.services.plant.params import UNIMATE_PARAMS
from hydrohil.services.plant.sensors import MASK, encoder_counts, gauge_counts
from hydrohil.shared.contract.faults import ENCODERS, ROWS, Fault, of_group, ticks_of
from hydrohil.shared.machine import unimate
from hydrohil.simulation.columns import columns
from hydrohil.simulation.loop import begin, play
from hydrohil.simulation.rollout import fault_table, play_local
from tests.hydrohil.simulation.test_local import PLANT, plain_parts, press

SEED = 3
AT_S, LASTS_S = 0.2, 0.3
PERIOD_NS = 4_500_000
FIRST, END = 45, 112  # 0.2 / 0.0045 = 44.4, 0.5 / 0.0045 = 111.1
VALUES = {"gain": 1.5, "leak": 20.0, "drop": 0.5}
MACHINE = [
    Fault(row.kind, target, AT_S, LASTS_S, VALUES.get(row.kind, 37.0) if row.unit else 0.0)
    for row in ROWS
    if row.group in ("sensor", "actuator")
    for target in row.targets
]
SENSORS = of_group(tuple(MACHINE), "sensor")
QUIET = {("leak", "valve_rotate"), ("stuck", "valve_rotate"), ("stuck", "dac_rotate"), ("stuck", "encoder_rotate")}  # stands


def named(fault):
    return f"{fault.kind}-{fault.target}"


def with_faults(*faults):
    return press()._replace(faults=faults)


@pytest.fixture(scope="module")
def sound():
    return play_local(press(), SEED)


@pytest.fixture(scope="module")
def played():
    return {fault: play_local(with_faults(fault), SEED) for fault in MACHINE}


@pytest.mark.parametrize("fault", MACHINE, ids=named)
def test_a_trial_is_the_same_to_the_bit_until_the_fault_begins_and_another_from_then_on(fault, sound, played):
    assert ticks_of(fault, PERIOD_NS) == (FIRST, END)
    outcome = played[fault]
    differs = np.zeros(len(outcome.rows.tick), dtype=bool)
    for with_fault, without in zip(outcome.rows, sound.rows, strict=True):
        same = with_fault == without[: len(with_fault)]
        differs |= ~(same if same.ndim == 1 else same.all(axis=1))
    ticks = outcome.rows.tick[differs]
    assert (ticks >= FIRST).all()
    assert len(ticks) > 0 or (fault.kind, fault.target) in QUIET


def true_readings(outcome):
    """What sound sensors would have given at every sample: encoder counters (n, 3) and counts of the gauge (n,)."""
    rows, count = outcome.rows, len(outcome.rows.tick)
    noise_n = force_noise_n(
        SEED, outcome.first_tick, count, UNIMATE_PARAMS.force_noise_sigma_n, UNIMATE_PARAMS.force_noise_clip_n
    )
    counts = [encoder_counts(tuple(map(float, q)), UNIMATE_PARAMS.q4_rad)[:3] for q in rows.true_q]
    force = [gauge_counts(UNIMATE_PARAMS, float(f), float(n)) for f, n in zip(rows.contact_force_n, noise_n, strict=True)]
    return np.array(counts), np.array(force)


@pytest.mark.parametrize("fault", SENSORS, ids=named)
def test_the_sample_shows_a_sensors_fault_from_its_first_tick_to_its_last_and_only_there(fault, played):
    rows = played[fault].rows
    counts, force = true_readings(played[fault])
    acting = (rows.tick >= FIRST) & (rows.tick < END)
    if fault.target in ENCODERS:
        link = ENCODERS.index(fault.target)
        readings, true, sound_links = rows.encoder_counts[:, link], counts[:, link], [k for k in range(3) if k != link]
        assert (rows.encoder_counts[:, sound_links] == counts[:, sound_links]).all()
        assert (rows.force_counts == force).all()
        check_encoder(fault, readings, true, acting, rows.tick, MASK[link])
    else:
        readings, true = rows.force_counts, force
        assert (rows.encoder_counts[:, :3] == counts).all()
        check_force(fault, readings, true, acting, rows.tick)
    assert (readings[~acting] == true[~acting]).all()


def check_encoder(fault, readings, true, acting, tick, mask):
    begun = (tick[acting] - FIRST + 1) * PERIOD_NS * 1e-9
    off = (readings[acting] - true[acting] + mask // 2) % (mask + 1) - mask // 2
    match fault.kind:
        case "stuck":
            assert (readings[acting] == readings[~acting][tick[~acting] < FIRST][-1]).all()
        case "garbage":
            assert set(readings[acting]) <= set(range(mask + 1)) and len(set(readings[acting])) > 0.9 * acting.sum()
        case "dropout":
            assert (readings[acting] == 0).all()
        case "offset":
            assert (off == fault.value).all()
        case "drift":
            assert (off == np.floor(fault.value * begun)).all()
        case "noise":
            assert abs(off).max() <= fault.value and len(set(off)) > 0.5 * acting.sum()
        case "wrap":
            assert (abs(readings[acting] - true[acting]) == (mask + 1) // 2).all()
        case _:
            raise AssertionError(fault.kind)


def check_force(fault, readings, true, acting, tick):
    begun = (tick[acting] - FIRST + 1) * PERIOD_NS * 1e-9
    off_n = (readings[acting] - true[acting]) * unimate.UNIMATE.force.scale
    near_n = 1.01 * unimate.UNIMATE.force.scale  # each of both is floored
    match fault.kind:
        case "stuck":
            assert (readings[acting] == readings[~acting][tick[~acting] < FIRST][-1]).all()
        case "garbage":
            assert (readings[acting] != true[acting]).all()
        case "dropout":
            assert (readings[acting] == unimate.UNIMATE.force.low).all()
        case "offset":
            assert abs(off_n - fault.value).max() <= near_n
        case "drift":
            assert abs(off_n - fault.value * begun).max() <= near_n
        case "gain":
            assert abs(readings[acting] - fault.value * true[acting]).max() <= 1.0 + fault.value
        case "noise":
            assert readings[acting].std() > 5.0 * readings[~acting].std()
        case _:
            raise AssertionError(fault.kind)


def test_a_force_noise_of_zero_leaves_a_reading_without_noise():
    rows = play_local(with_faults(Fault("noise", "force", -0.2, 0.1)), SEED).rows
    acting = (rows.tick >= -44) & (rows.tick < -22)
    assert len(set(rows.force_counts[acting])) == 1
    assert len(set(rows.force_counts[~acting & (rows.tick < 0)])) > 5


def test_a_fault_without_an_end_stays_to_the_trials_end():
    rows = play_local(with_faults(Fault("offset", "encoder_rotate", AT_S, 0.0, 3.0)), SEED).rows
    off = rows.encoder_counts[:, 0] - [encoder_counts(tuple(map(float, q)), UNIMATE_PARAMS.q4_rad)[0] for q in rows.true_q]
    assert (off == np.where(rows.tick >= FIRST, 3, 0)).all()
    assert rows.tick[-1] == 443


def test_garbage_is_a_function_of_the_seed():
    fault = Fault("garbage", "force", -0.1, 0.05)
    first, again, other = (play_local(with_faults(fault), seed).rows.force_counts for seed in (3, 3, 4))
    assert first.tobytes() == again.tobytes()
    acting = slice(play_local(press(0.1), 3).rows.tick.tolist().index(-22), None)
    assert (first[acting][:5] != other[acting][:5]).all()


@pytest.mark.parametrize("fault", [Fault("loss", "plant>controller", value=0.1), Fault("kill", "controller")], ids=named)
def test_what_a_local_run_cannot_break_is_refused_in_one_line(fault):
    with pytest.raises(ValueError, match=f"{fault.kind} of {fault.target} cannot be played on the local clock"):
        play_local(with_faults(fault), SEED)


MILD = (  # none of them ends the trial
    Fault("stuck", "force", -0.05, 0.03),
    Fault("offset", "force", -0.02, 0.05, 20.0),
    Fault("drift", "force", 0.0, 0.08, 100.0),
    Fault("gain", "force", 0.04, 0.05, 1.2),
    Fault("noise", "force", 0.05, 0.0, 1.5),
    *(Fault("offset", target, 0.01, 0.05, 2.0) for target in ENCODERS),
    *(Fault("noise", target, 0.02, 0.03, 1.0) for target in ENCODERS),
    *(Fault("drift", target, 0.03, 0.05, -50.0) for target in ENCODERS),
)
ACTUATORS = of_group(tuple(MACHINE), "actuator")


@pytest.mark.parametrize(
    "faults", [MILD, *((f._replace(at_s=0.1, lasts_s=0.05),) for f in ACTUATORS if "rotate" not in f.target)]
)
def test_plain_python_breaks_as_the_compiled_trial_does_bit_for_bit(faults):
    experiment = press(0.2)._replace(faults=faults, plant=PLANT._replace(bias_s=0.11))
    prepared, count, table, noise_n, intervals = plain_parts(experiment, SEED)
    broken_rows = tuple(tuple(map(float, row)) for row in fault_table(experiment, SEED))
    out = columns(count)
    start = begin(prepared, control_start(prepared.control), intervals)
    rows = play(
        setup=prepared, underway=start, table=table, faults=broken_rows, noise_n=noise_n, intervals=intervals, out=out, end=count
    ).row
    compiled = play_local(experiment, SEED)
    assert rows == len(compiled.rows.tick) == count
    for name, plain, machine in zip(out._fields, out, compiled.rows, strict=True):
        assert plain.tobytes() == machine.tobytes(), name
