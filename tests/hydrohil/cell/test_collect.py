"""A trace from a trial's messages, and the first gap by name."""

from collections.abc import Callable

import numpy as np
import pytest

from hydrohil.cell.collect import Collector, GapError
from hydrohil.cell.session import remembered_changes
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_TRIAL, GateCause, GateEvent, GateState, Mode, ParameterEvent, TripCause
from hydrohil.shared.contract.topics import BY_KEY
from tests.support.recorder_trial import trial

TICKS = 40


class Ring:
    """What a topic would have received."""

    def __init__(self, key: str, messages: list[Received]):
        self.topic, self.messages = BY_KEY[key], messages
        self.waiting = messages

    def take(self) -> list[Received]:
        waiting, self.waiting = self.waiting, []
        return waiting

    def peek(self) -> Received | None:
        return self.messages[-1] if self.messages else None


class Network:
    """A bus that has heard a whole trial already."""

    def __init__(self, messages: list[Received]):
        self.messages = messages
        self.fed: list[Ring] = []

    def subscribe(self, key: str, depth: int) -> Ring:
        self.fed.append(Ring(key, [message for message in self.messages if message.topic == key]))
        return self.fed[-1]

    def unsubscribe(self, ring: Ring) -> None:
        self.fed.remove(ring)


MESSAGES = [message for message in trial(TICKS) if isinstance(message, Received)]
RUN = MESSAGES[-1].header.run
SAMPLES = {m.body.tick: m.body for m in MESSAGES if m.topic == "plant/sample" and m.body.tick != NO_TRIAL}


def collected(keep: Callable[[Received], bool] = lambda message: True) -> Collector:
    return Collector(Network([message for message in MESSAGES if keep(message)]))  # type: ignore[arg-type]


def without(topic: str, tick: int) -> Collector:
    """All but what `topic` says at `tick`."""
    number = SAMPLES[tick].number
    return collected(lambda m: m.topic != topic or (m.body.number if topic == "plant/sample" else m.header.echo_number) != number)


def test_every_tick_from_0_is_a_row():
    trace = collected().trace(RUN, TICKS)
    assert list(trace.tick) == list(range(TICKS))
    assert {len(column) for column in trace} == {TICKS}
    assert np.array_equal(trace.encoder_counts, [SAMPLES[tick].encoder_counts for tick in range(TICKS)])


def test_ticks_beyond_the_trial_are_left_out():
    assert len(collected().trace(RUN, TICKS - 1).tick) == TICKS - 1


@pytest.mark.parametrize(
    ("topic", "name"),
    [
        ("plant/sample", "sample"),
        ("controller/command", "command"),
        ("controller/state", "controller state"),
        ("supervisor/permit", "permit"),
    ],
)
@pytest.mark.parametrize("tick", [0, 7, TICKS - 2])
def test_one_missing_message_is_named_with_its_tick(topic: str, name: str, tick: int):
    with pytest.raises(GapError, match=f"{name} of tick {tick} is missing"):
        without(topic, tick).trace(RUN, TICKS)


def test_a_missing_message_before_tick_0_is_no_gap():
    assert len(without("controller/state", -1).trace(RUN, TICKS).tick) == TICKS


def test_a_trial_of_another_run_leaves_nothing():
    with pytest.raises(GapError, match="no sample of the trial"):
        collected().trace(RUN + 1, TICKS)


def event(state: GateState, cause: GateCause, run: int = RUN, measured: float = 0.0, limit: float = 0.0) -> Received:
    body = GateEvent(
        number=90, tick=5, state=int(state), cause=int(cause), permit_age_ns=0, command_age_ns=0, measured=measured, limit=limit
    )
    return Received(0, "plant/gate", MESSAGES[0].header._replace(run=run), body)


PERMIT = next(m for m in MESSAGES if m.topic == "supervisor/permit")


def permit(cause: TripCause, run: int = RUN, mode: Mode = Mode.TRIPPED) -> Received:
    body = PERMIT.body._replace(mode=int(mode), cause=int(cause), measured=340.0, limit=334.0, trip_number=91)
    return Received(0, "supervisor/permit", PERMIT.header._replace(run=run), body)


def trip(*messages: Received) -> str:
    return Collector(Network(list(messages))).trip(RUN)  # type: ignore[arg-type]


def test_a_trip_is_known_from_the_permits_though_nobody_answers_requests():
    assert trip(permit(TripCause.FORCE_TARED)).endswith("reached 340.0 N against its limit of 334.0 N (sample 91)")
    assert trip(permit(TripCause.ESTOP)) == "the operator pressed the emergency stop (sample 91)"


def test_neither_another_run_nor_a_supervisor_that_permits_is_a_trip():
    assert trip() == ""
    assert trip(permit(TripCause.FORCE_TARED, run=RUN + 1)) == ""
    assert trip(permit(TripCause.FORCE_TARED, mode=Mode.RUNNING)) == ""


def test_the_first_cut_of_the_run_is_named_with_its_numbers():
    stale = event(GateState.REVOKED, GateCause.COMMAND_STALE, measured=0.022, limit=0.02)
    assert trip(permit(TripCause.GATE_CUT), stale, event(GateState.REVOKED, GateCause.REVOKED_ARMING)) == (
        "the gate cut by itself: the command was 0.022 s old against a lease of 0.02 s (sample 90)"
    )


def test_neither_another_run_nor_a_gate_that_opens_is_a_cut():
    others = (event(GateState.REVOKED, GateCause.ESTOP, run=RUN + 1), event(GateState.OPEN, GateCause.NONE))
    assert trip(permit(TripCause.GATE_CUT), *others) == "the gate cut by itself (sample 91)"


def test_a_collector_that_is_closed_costs_no_later_trial_and_keeps_what_it_heard():
    network = Network(MESSAGES)
    collector = Collector(network)  # type: ignore[arg-type]
    assert network.fed
    collector.close()
    assert network.fed == []
    assert len(collector.trace(RUN, TICKS).tick) == TICKS


def test_what_was_changed_by_hand_in_this_run_is_reported_and_neither_the_scheduled_nor_another_run_s():
    head = MESSAGES[-1].header

    def changed(number: int, by_hand: int, run: int) -> Received:
        event = ParameterEvent(
            number=number, tick=3, by_hand=by_hand, path="controller.law", old='"final"', new='"pi"', ramp_samples=1
        )
        return Received(0, "controller/parameter_change", head._replace(run=run), event)

    events = [changed(7, 1, RUN), changed(8, 0, RUN), changed(9, 1, RUN + 1)]
    collector = Collector(Network([*MESSAGES, *events]))  # type: ignore[arg-type]
    words = ('changed by hand at sample 7: controller.law "final" -> "pi"',)
    assert collector.changed(RUN) == words
    assert collected().changed(RUN) == ()
    assert remembered_changes({"controller": {"by_hand": [events[0].body._asdict()]}}) == words
    assert remembered_changes({"plant": {}}) == remembered_changes({"controller": {}}) == ()
