"""Failure modes of a black channel (IEC 61784-3, EN 50159) against the measures of the frame, one real frame a cell.

Each frame goes through the plant's receiver as in a cell: codec, acceptance, mailbox, protection, gate. The gate stands open
on a permit and a command; what is not ours is discarded and counted, and moves nothing; what is ours but wrong, or stays
away for longer than its lease, shuts it and revokes the arming.
"""

import math
from typing import NamedTuple

import msgpack
import pytest

from hydrohil.shared.contract.codec import crc, encode
from hydrohil.shared.contract.messages import GateCause, GateState
from hydrohil.shared.contract.topics import expression
from tests.plant.test_gatekeeper import MOVING, MS, Scene
from tests.support.wire_scene import CELL, ZERO, command_body, header, permit_body

PERMIT, COMMAND = "supervisor/permit", "controller/command"
KEYS = (PERMIT, COMMAND)
OTHERS = (2050, 2050, 2050)  # codes that no honest command here has
STALE = {PERMIT: GateCause.PERMIT_STALE, COMMAND: GateCause.COMMAND_STALE}


class Channel(Scene):
    """An open gate, and frames that number themselves topic by topic."""

    def __init__(self):
        super().__init__()
        self.next = dict.fromkeys(KEYS, 0)
        self.tick(KEYS)
        assert self.judge().state == GateState.OPEN

    def inbox(self, key):
        return self.keeper.permits if key == PERMIT else self.keeper.commands

    def body(self, key, codes=MOVING):
        return permit_body() if key == PERMIT else command_body(codes)

    def frame(self, key, codes=MOVING, seq=None, body=None, **changes):
        head = header(key, self.next[key] if seq is None else seq, **({"arming_id": 77} | self.echo() | changes))
        return encode(expression(CELL, key), head, self.body(key, codes) if body is None else body)

    def put(self, key, frame=None, **changes):
        self.bus.send_bytes(key, self.frame(key, **changes) if frame is None else frame)

    def good(self, key, **changes):
        self.put(key, **changes)
        self.next[key] += 1

    def tick(self, keys):
        """A sample, and what answers it on these topics."""
        self.sample()
        for key in keys:
            self.good(key)


class Counted(NamedTuple):
    """Discarded under this cause, or counted under this name; the gate stays as it is."""

    cause: str


class Cut(NamedTuple):
    """The gate is at zero, for this cause (of permit and of command), and the arming is revoked."""

    permit: GateCause
    command: GateCause


def both(cause):
    return Cut(cause, cause)


def again(channel, key):
    frame = channel.frame(key)
    channel.good(key)
    channel.put(key, frame)


def again_and_again(channel, key):
    again(channel, key)
    channel.put(key, seq=channel.next[key] - 1)


def an_answer_that_stands_still(channel, key):
    """The sender goes on sending and numbering, but names the same sample for ever: as a controller that hangs in its law."""
    echo = channel.echo()
    other = KEYS[1 - KEYS.index(key)]
    for _ in range(5):
        channel.tick([other])
        channel.good(key, **echo)
        channel.judge()


def of_an_earlier_life(channel, key):
    channel.good(key)
    channel.inbox(key).acceptance._abandoned.add(5)
    channel.put(key, epoch=5, seq=900)


def a_number_is_skipped(channel, key):
    channel.next[key] += 1
    channel.good(key)


def silence(channel, key):
    channel.now_ns += 20 * MS
    channel.sample()
    channel.good(KEYS[1 - KEYS.index(key)])


def with_another(**changes):
    def attack(channel, key):
        channel.good(key)
        channel.good(key, **({"codes": OTHERS} | changes))

    return attack


def swapped(channel, key):
    older, newer = channel.frame(key, codes=OTHERS), channel.frame(key, seq=channel.next[key] + 1)
    channel.next[key] += 2
    channel.put(key, newer)
    channel.put(key, older)


def one_bit(channel, key):
    frame = bytearray(channel.frame(key, codes=OTHERS))
    frame[0] ^= 1  # of the structure: nothing can be read of it
    channel.good(key)
    channel.put(key, bytes(frame))


def a_bit_of_the_body(times):
    def attack(channel, key):
        for _ in range(times):
            frame = bytearray(channel.frame(key, codes=OTHERS))
            frame[-5] ^= 1  # the header still names the bound sender
            channel.put(key, bytes(frame))
        channel.good(key)

    return attack


def resealed(change):
    """The sender's own CRC over something that is no message."""

    def attack(channel, key):
        packed = msgpack.packb(change(msgpack.unpackb(channel.frame(key, codes=OTHERS)[:-4])))
        channel.good(key)
        channel.put(key, packed + crc(expression(CELL, key), packed))

    return attack


def of_another_key(channel, key):
    """A frame of the right sender that was sealed for another cell's key, moved here."""
    head = header(key, channel.next[key], arming_id=77, **channel.echo())
    channel.good(key)
    channel.put(key, encode(expression("left", key), head, channel.body(key, OTHERS)))


def held_back(channel, key):
    late = channel.frame(key, seq=channel.next[key] + 9)
    other = KEYS[1 - KEYS.index(key)]
    for _ in range(5):
        channel.tick([other])
    channel.put(key, late)


def from_the_future(channel, key):
    channel.good(key, echo_number=channel.timeline.number + 1)


def with_a_wrong_time(channel, key):
    channel.good(key, echo_time_ns=channel.timeline.number + 1)


TABLE = {
    ("repetition", "seq"): (again, Counted("sequence")),
    ("repetition", "seq, more than one a second"): (again_and_again, both(GateCause.LINK_FAULTS)),
    ("repetition", "echo"): (an_answer_that_stands_still, Cut(*STALE.values())),
    ("repetition", "epoch"): (of_an_earlier_life, Counted("epoch")),
    ("deletion", "seq"): (a_number_is_skipped, Counted("lost")),
    ("deletion", "echo and lease"): (silence, Cut(*STALE.values())),
    ("insertion", "run"): (with_another(run=8), Counted("other_run")),
    ("insertion", "experiment hash"): (with_another(experiment=b"another"), Counted("other_run")),
    ("insertion", "epoch"): (with_another(epoch=99), both(GateCause.EPOCH_CHANGED)),
    ("insertion", "arming_id"): (with_another(arming_id=78), both(GateCause.OTHER_ARMING)),
    ("insertion", "schema"): (with_another(schema=1), Counted("schema")),
    ("insertion", "wire version"): (with_another(version=2), Counted("version")),
    ("resequencing", "seq"): (swapped, Counted("sequence")),
    ("corruption", "CRC, of a frame that names nobody"): (one_bit, Counted("crc")),
    ("corruption", "CRC, once under the bound identity"): (a_bit_of_the_body(1), Counted("link_faults")),
    ("corruption", "CRC, twice under the bound identity"): (a_bit_of_the_body(2), both(GateCause.LINK_FAULTS)),
    ("corruption", "types"): (resealed(lambda fields: [*fields[:-1], [True]]), Counted("malformed")),
    ("corruption", "length"): (resealed(lambda fields: fields[:-2]), Counted("malformed")),
    ("corruption", "size"): (resealed(lambda fields: [*fields, b"x" * 5000]), Counted("oversized")),
    ("delay", "echo and lease"): (held_back, Cut(*STALE.values())),
    ("delay", "ledger: number"): (from_the_future, both(GateCause.IMPOSSIBLE_ECHO)),
    ("delay", "ledger: time"): (with_a_wrong_time, both(GateCause.IMPOSSIBLE_ECHO)),
    ("masquerade", "cell"): (with_another(cell="left"), Counted("cell")),
    ("masquerade", "sender"): (with_another(sender="operator"), Counted("sender")),
    ("masquerade", "CRC over the key"): (of_another_key, Counted("link_faults")),
}
MODES = {"repetition", "deletion", "insertion", "resequencing", "corruption", "delay", "masquerade"}


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize(("attack", "outcome"), TABLE.values(), ids=[": ".join(cell) for cell in TABLE])
def test_each_failure_mode_meets_its_measure(attack, outcome, key):
    channel = Channel()
    before = counts(channel, key)
    if attack not in (an_answer_that_stands_still, held_back, silence):
        channel.tick([KEYS[1 - KEYS.index(key)]])
    attack(channel, key)
    gate = channel.judge()
    if isinstance(outcome, Counted):
        grown = {name: now - before.get(name, 0) for name, now in counts(channel, key).items()}
        assert grown[outcome.cause] == 1
        assert (gate.state, channel.device.codes) == (GateState.OPEN, MOVING)
        channel.tick(KEYS)
        assert channel.judge().state == GateState.OPEN
        return
    assert channel.device.codes == ZERO
    cause = GateCause[channel.keeper.status()["last_cut"]]
    assert cause == (outcome.permit if key == PERMIT else outcome.command)
    assert 77 in channel.keeper.revoked
    channel.now_ns += 5_000 * MS
    channel.tick(KEYS)
    assert channel.judge().cause in (GateCause.REVOKED_ARMING, GateCause.EPOCH_CHANGED, GateCause.NO_PERMIT)
    assert channel.device.codes == ZERO


def counts(channel, key):
    acceptance = channel.inbox(key).acceptance
    return dict(acceptance.discarded) | {
        name: getattr(acceptance, name) for name in ("lost", "other_run", "link_faults", "epoch_conflicts")
    }


def test_the_table_answers_every_failure_mode_that_the_standards_list():
    assert {mode for mode, _ in TABLE} == MODES


@pytest.mark.parametrize("key", KEYS)
def test_a_flood_of_strangers_stops_nobody_and_is_counted(key):
    channel = Channel()
    for _ in range(50):
        for changes in ({"cell": "left"}, {"sender": "operator"}, {"version": 2}, {"schema": 1}):
            channel.put(key, **changes)
        channel.good(key, run=8)
        channel.put(key, b"\x91" * 60)
        channel.judge()
        channel.tick(KEYS)
        assert channel.judge().state == GateState.OPEN
    assert channel.device.codes == MOVING
    assert counts(channel, key)["link_faults"] == counts(channel, key)["epoch_conflicts"] == 0
    assert counts(channel, key)["cell"] == counts(channel, key)["other_run"] == 50


@pytest.mark.parametrize("key", KEYS)
def test_two_senders_at_once_are_safe_in_every_state_of_the_gate(key):
    bound = Channel()
    bound.tick(KEYS)
    bound.put(key, epoch=99, seq=0)
    assert (bound.judge().cause, bound.device.codes) == (GateCause.EPOCH_CHANGED, ZERO)
    shut = Channel()
    shut.timeline.tick = -1  # the trial's bias: nothing is bound yet
    shut.keeper.begin_trial()
    for seq in range(2):
        shut.tick(KEYS)
        shut.put(key, epoch=99, seq=seq)
        shut.judge()
    assert shut.keeper.gate.cause == GateCause.TWO_PUBLISHERS
    shut.timeline.tick = 0
    shut.now_ns += 2_000 * MS
    shut.tick(KEYS)
    assert shut.judge().state != GateState.OPEN


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_permit_whose_floats_are_not_finite_changes_nothing_that_the_gate_does(value):
    channel = Channel()
    channel.tick([COMMAND])
    body = permit_body(measured=value, limit=value, force_limit_n=value, force_bias_n=value)
    channel.good(PERMIT, body=body)
    assert (channel.judge().state, channel.device.codes) == (GateState.OPEN, MOVING)
