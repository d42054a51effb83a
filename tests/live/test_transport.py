"""Faults of the transport in a real cell on the lockstep clock: what happens, to the exact tick of simulated time."""

import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest

from hydrohil.cell import processes as cells
from hydrohil.cell.collect import Collector
from hydrohil.cell.session import arm, load, watch
from hydrohil.claims.trace import Trace
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import GateCause, GateState
from hydrohil.shared.transport.bus import Bus
from hydrohil.simulation.rollout import duration_ticks
from tests.support.live_cell import experiment, own_place

pytestmark = pytest.mark.live
LEASE_MS, PERIOD_MS, LATCH_MS = 90.0, 4.5, 3.6  # simulated time judges, so a busy machine does not; before the trial it does
TICK = 45  # at which the faults begin: 0.2 s
DURATION_S = 0.8
HELD = 19  # periods for which a command may be held: 19 * 4.5 + 3.6 <= 90 < 20 * 4.5 + 3.6
ATTEMPTS = 5
SETTLED_S = 0.2  # the last messages are under way


class Outcome(NamedTuple):
    """What one trial showed."""

    cuts: list[tuple[int, GateCause]]  # ticks at which the gate was revoked, and why
    trace: Trace | None
    open_after: bool  # it opened again after a cut
    status: dict[str, dict[str, Any]]
    trip_tick: int  # of the supervisor; without a trip it means nothing


@pytest.fixture(scope="module")
def bus() -> Iterator[Bus]:
    place = own_place()
    started = cells.start(place, cells.LOOP, with_parent=True, extra={"plant": ["--permit-ttl-ms", str(LEASE_MS)]})
    try:
        with cells.operator_bus(place) as bus:
            cells.await_ready(place, bus, started)
            yield bus
    finally:
        cells.stop(process.pid for process in started.values())


def trial(bus: Bus, *faults: Fault) -> Outcome:
    """A trial under these faults; one that a stall of the host ends before its first tick is begun again."""
    for _ in range(ATTEMPTS):
        cells.ask(bus, "plant", "reset")
        time.sleep(0.05)  # the supervisor judges a reset by the next samples
        bus.ask("supervisor", "reset", {}, 1.0)
        outcome = attempt(bus, *faults)
        if outcome is not None:
            return outcome
    raise AssertionError("never began")


def attempt(bus: Bus, *faults: Fault) -> Outcome | None:
    trial = experiment(DURATION_S)._replace(faults=faults, claims=())
    trial = trial._replace(plant=trial.plant._replace(jitter_substeps=0, bias_s=0.5))
    run = load(bus, trial, 1, "lockstep").run
    collector = Collector(bus)
    try:
        arm(bus)
        cells.ask(bus, "supervisor", "start")
    except cells.CellError:
        return None
    watch(collector, trial, lambda _: None)
    time.sleep(SETTLED_S)
    events = [m.body for m in collector.gate_events.drain() if isinstance(m, Received) and m.header.run == run]
    openings = [event for event in events if event.state == GateState.OPEN]
    if [event.tick for event in openings] != [0] and not openings[1:]:
        return None
    newest = collector.permits.peek()
    assert isinstance(newest, Received)
    cuts = [(event.tick, GateCause(event.cause)) for event in events if event.tick > 0 and event.state == GateState.REVOKED]
    status = cells.statuses(bus, cells.LOOP)
    trace = (
        None
        if cuts or any(fault.target.startswith("plant") for fault in faults)
        else collector.trace(run, duration_ticks(DURATION_S, trial.plant))
    )
    return Outcome(cuts[:1], trace, len(openings) > 1, status, newest.body.trip_number - openings[0].number)


@pytest.fixture(scope="module")
def undisturbed(bus: Bus) -> Trace:
    trace = trial(bus).trace
    assert trace is not None
    return trace


def same(one: Trace, other: Trace) -> bool:
    return all(
        np.array_equal(a, b) for name, a, b in zip(one._fields, one, other, strict=True) if name not in ("sample_age_s", "mode")
    )


STALE = {"controller": GateCause.COMMAND_STALE, "supervisor": GateCause.PERMIT_STALE}


@pytest.mark.parametrize("path", ["plant>controller", "controller>plant", "plant>supervisor", "supervisor>plant"])
def test_a_burst_is_bridged_up_to_the_lease_and_safe_at_the_first_latch_beyond_it(bus: Bus, path: str):
    peer = path.replace("plant", "").strip(">")
    assert trial(bus, Fault("burst", path, 0.2, value=float(HELD))).cuts == []
    assert trial(bus, Fault("burst", path, 0.2, value=float(HELD + 1))).cuts == [(TICK + HELD, STALE[peer])]


@pytest.mark.parametrize("path", ["plant>controller", "controller>plant", "plant>supervisor", "supervisor>plant"])
def test_a_delay_is_carried_up_to_the_lease_and_safe_just_past_it(bus: Bus, path: str):
    peer, longest_ms = path.replace("plant", "").strip(">"), HELD * PERIOD_MS + LATCH_MS
    assert trial(bus, Fault("delay", path, 0.2, value=longest_ms)).cuts == []
    assert trial(bus, Fault("delay", path, 0.2, value=longest_ms + 0.05)).cuts == [(TICK + HELD, STALE[peer])]


@pytest.mark.parametrize("cut", ["plant>controller", "controller>plant", "plant-controller"])
def test_a_partition_from_the_controller_is_safe_after_the_lease_and_nothing_resumes(bus: Bus, cut: str):
    outcome = trial(bus, Fault("partition", cut, 0.2, 0.2))
    assert outcome.cuts == [(TICK + HELD, GateCause.COMMAND_STALE)] and not outcome.open_after


@pytest.mark.parametrize("cut", ["plant>supervisor", "supervisor>plant", "plant-supervisor"])
def test_a_partition_from_the_supervisor_is_safe_after_the_lease_and_nothing_resumes(bus: Bus, cut: str):
    outcome = trial(bus, Fault("partition", cut, 0.2, 0.2))
    assert outcome.cuts == [(TICK + HELD, GateCause.PERMIT_STALE)] and not outcome.open_after
    assert outcome.status["supervisor"]["mode"] == "TRIPPED"


@pytest.mark.parametrize("cut", ["controller>supervisor", "controller-supervisor"])
def test_a_controller_that_the_supervisor_does_not_hear_trips_though_its_commands_arrive(bus: Bus, cut: str):
    outcome = trial(bus, Fault("partition", cut, 0.2, 0.2))
    last_heard, bearable = TICK - 1, int(LEASE_MS / PERIOD_MS) + 2
    assert (outcome.status["supervisor"]["cause"], outcome.trip_tick) == ("CONTROLLER_SILENT", last_heard + bearable + 1)
    assert outcome.status["plant"]["dac_counts"] == [2048, 2048, 2048] and not outcome.open_after


@pytest.mark.parametrize("path", ["controller>plant", "supervisor>plant"])
def test_a_duplicate_is_counted_and_changes_no_number(bus: Bus, undisturbed: Trace, path: str):
    outcome = trial(bus, Fault("duplicate", path, 0.2, 0.0045, 1.0))
    assert outcome.trace is not None and same(outcome.trace, undisturbed)


def test_the_delay_of_a_command_moves_the_instant_at_which_it_takes_effect(bus: Bus, undisturbed: Trace):
    early = trial(bus, Fault("delay", "controller>plant", 0.2, value=LATCH_MS)).trace
    late = trial(bus, Fault("delay", "controller>plant", 0.2, value=LATCH_MS + 0.05)).trace
    assert early is not None and late is not None
    assert same(early, undisturbed)
    assert not same(late, undisturbed)
