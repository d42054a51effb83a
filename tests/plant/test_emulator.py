import pytest

from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.plant.device import Timeline
from hydrohil.services.plant.emulator import Emulator
from hydrohil.services.plant.machine import advance, machine_start
from hydrohil.services.plant.params import UNIMATE_PARAMS, Environment, contact_params
from hydrohil.shared.compiled.compiled_value import compiled_value
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import NO_TRIAL

MOVING = (2048, 2048, 2700)
ZERO = (2048, 2048, 2048)
WATCHDOG = 400  # sub-steps: 20 ms


@pytest.fixture(scope="module")
def emulation():
    timeline = Timeline()
    return timeline, Emulator(timeline, WATCHDOG)


@pytest.fixture
def scene(emulation):
    """The emulator at its declared pose, sub-step 0."""
    timeline, emulator = emulation
    timeline.substep = timeline.number = 0
    timeline.tick = NO_TRIAL
    emulator.watchdog(WATCHDOG)
    emulator.clear()
    emulator.load(PlantConfig(), 0, 0, 4096, ())
    emulator.begin()
    return timeline, emulator


def at(scene, substep):
    timeline, emulator = scene
    timeline.substep = substep
    emulator.read()
    return emulator.ground_truth()


def expected(*driven):
    """Positions after (codes, sub-steps) by the machine's own equations, plain."""
    contact = contact_params(Environment())
    state = machine_start(UNIMATE_PARAMS, contact, PlantConfig().initial_q)
    for codes, substeps in driven:
        state = advance(state, UNIMATE_PARAMS, contact, codes, substeps)
    return state.q, state.spool_a


def test_codes_act_from_the_sub_step_at_which_they_are_written(scene):
    timeline, emulator = scene
    timeline.substep = 72
    emulator.write(MOVING)
    reached = at(scene, 162)
    assert (reached.q, reached.spool_a) == expected((ZERO, 72), (MOVING, 90))
    assert reached.spool_a[2] > expected()[1][2] + 0.05


@pytest.mark.parametrize("silence", [WATCHDOG, WATCHDOG + 1, WATCHDOG + 300])
def test_a_converter_that_is_not_written_goes_to_zero_by_itself_at_the_end_of_the_lease(scene, silence):
    _, emulator = scene
    emulator.write(MOVING)
    reached = at(scene, silence)
    assert (reached.q, reached.spool_a) == expected((MOVING, WATCHDOG), (ZERO, silence - WATCHDOG))


def test_reading_does_not_feed_the_watchdog(scene):
    _, emulator = scene
    emulator.write(MOVING)
    for substep in range(90, 900, 90):
        reached = at(scene, substep)
    assert (reached.q, reached.spool_a) == expected((MOVING, WATCHDOG), (ZERO, 810 - WATCHDOG))


def test_writing_feeds_the_watchdog(scene):
    timeline, emulator = scene
    for substep in range(0, 900, 300):
        timeline.substep = substep
        emulator.write(MOVING)
    reached = at(scene, 900)
    assert reached.q == expected((MOVING, 900))[0]
    assert reached.q[2] > PlantConfig().initial_q[2]


def test_a_shorter_lease_falls_at_once_when_it_is_over_already(scene):
    _, emulator = scene
    emulator.write(MOVING)
    at(scene, 300)
    emulator.watchdog(200)
    reached = at(scene, 390)
    assert (reached.q, reached.spool_a) == expected((MOVING, 300), (ZERO, 90))


def test_a_trial_begins_at_its_declared_state_whatever_was_before(scene):
    timeline, emulator = scene
    emulator.write(MOVING)
    at(scene, 350)
    emulator.begin()
    timeline.substep = 350
    reached = emulator.ground_truth()
    assert (reached.q, reached.spool_a, reached.qd) == (*expected(), (0.0,) * 3)
    assert at(scene, 700).q == PlantConfig().initial_q


def test_the_noise_of_a_trial_is_that_of_its_ticks(scene):
    timeline, emulator = scene
    emulator.load(PlantConfig(environment=Environment("plate", surface_m=-0.5)), 3, -10, 20, ())
    emulator.begin()
    readings = []
    for number in (100, 200):
        row = []
        for tick in range(-10, 10):
            timeline.tick, timeline.number = tick, number + tick
            row.append(emulator.read().force_counts)
        readings.append(row)
    assert readings[0] == readings[1]
    assert len(set(readings[0])) > 1


@pytest.mark.parametrize("kind", ["free", "plate", "crate"])
def test_nothing_compiles_after_the_emulator_is_created(scene, kind):
    timeline, emulator = scene
    compiled_for, held_for = list(emulator._advance.signatures), list(compiled_value.signatures)
    emulator.load(PlantConfig(environment=Environment(kind=kind), sample_period_substeps=20), 5, -100, 300, ())
    emulator.begin()
    timeline.tick, timeline.substep = 0, 16
    emulator.write(MOVING)
    at(scene, 200)
    assert list(emulator._advance.signatures) == compiled_for
    assert list(compiled_value.signatures) == held_for
    assert len(compiled_for) == len(held_for) == 1


def sampled(scene, samples, codes=MOVING):
    """Readings and truths of that many samples with these codes written 72 sub-steps after each."""
    timeline, emulator = scene
    readings = []
    for number in range(samples):
        timeline.number, timeline.substep = number, 90 * number
        readings.append((emulator.read(), emulator.ground_truth()))
        timeline.substep += 72
        emulator.write(codes)
    return readings


def test_a_fault_by_hand_shows_in_the_readings_alone_and_the_ground_truth_stays(scene):
    sound = sampled(scene, 8)
    timeline, emulator = scene
    timeline.substep = timeline.number = 0
    emulator.begin()
    emulator.inject(Fault("dropout", "encoder_out_in", 0.009, 0.009))
    broken = sampled(scene, 8)
    assert [ground_truth for _, ground_truth in broken] == [ground_truth for _, ground_truth in sound]
    assert [reading.encoder_counts[2] == 0 for reading, _ in broken] == [number in (3, 4) for number in range(8)]
    assert [emulator.faults()[0], emulator.faults()[1]] == [(), ()]


def test_a_stuck_converter_holds_its_code_against_its_watchdog_and_the_others_go_to_zero(scene):
    timeline, emulator = scene
    emulator.write((2100, 2048, 2700))
    emulator.inject(Fault("stuck", "dac_out_in"))
    timeline.number, timeline.substep = 1, 90
    emulator.read()
    reached = at(scene, WATCHDOG + 100)
    assert (reached.q, reached.spool_a) == expected(((2100, 2048, 2700), WATCHDOG), (MOVING, 100))
    assert emulator.readback() == MOVING


def test_what_drives_the_valves_can_be_read_back_be_it_written_stuck_or_the_watchdogs(scene):
    timeline, emulator = scene
    emulator.read()  # what acts is looked up when the machine is read: nothing does
    emulator.write(MOVING)
    timeline.substep = WATCHDOG
    assert emulator.readback() == MOVING
    timeline.substep = WATCHDOG + 1
    assert emulator.readback() == ZERO
    emulator.write(MOVING)
    emulator.inject(Fault("stuck", "dac_out_in"))
    timeline.number += 1
    emulator.read()
    emulator.write(ZERO)
    assert emulator.readback() == MOVING


def test_what_only_the_bus_or_the_operator_can_break_is_no_matter_of_the_machine(scene):
    _, emulator = scene
    assert emulator.refuses((Fault("stuck", "force"), Fault("leak", "valve_rotate", value=2.0))) == ""
    assert "alone" in emulator.refuses((Fault("stuck", "force"), Fault("kill", "controller")))
