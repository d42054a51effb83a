"""Frames as senders make them, and a bus without a network."""

import json
from types import SimpleNamespace

from hydrohil.shared.contract.codec import WIRE_VERSION, Header, encode
from hydrohil.shared.contract.messages import Ask, Command, ControllerState, Mode, Permit
from hydrohil.shared.contract.topics import ASK, BY_KEY, expression
from hydrohil.shared.machine.description import machine_hash, machine_id
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.transport.bus import Run
from hydrohil.shared.transport.impairment_conditions import idle
from hydrohil.shared.transport.inbox import RING, Inbox
from hydrohil.shared.transport.requests import Requests

CELL = "cell"
EPOCHS = {"plant": 31, "supervisor": 11, "controller": 22}
ZERO = (2048, 2048, 2048)


def header(key, seq=0, **changes):
    topic = BY_KEY[key]
    header = Header(
        version=WIRE_VERSION,
        schema=topic.schema,
        cell=CELL,
        run=0,
        experiment=b"",
        sender=topic.publisher,
        epoch=EPOCHS[topic.publisher],
        arming_id=77,
        seq=seq,
        echo_number=0,
        echo_time_ns=0,
    )
    return header._replace(**changes)


MACHINE_ID = machine_id(machine_hash(UNIMATE))


def permit_body(mode=Mode.RUNNING, **changes):
    return Permit(
        mode=int(mode),
        cause=0,
        measured=0.0,
        limit=0.0,
        trip_number=-1,
        first_sample=0,
        duration_ticks=100,
        tare_ticks=8,
        recover_signs=(0, 0, 0),
        force_limit_n=334.0,
        force_bias_n=0.0,
    )._replace(**changes)


def command_body(codes=ZERO):
    return Command(codes)


def state_body(number=0, **changes):
    links = (0.0, 0.0, 0.0)
    vectors = dict.fromkeys(("q", "q_set", "qd", "qd_set", "x_m", "x_set_m", "x_nominal_m", "current_a", "integral_a"), links)
    forces = dict.fromkeys(("force_n", "force_mean_n", "force_set_n", "force_bias_n"), 0.0)
    counts = {"boosted": (0, 0, 0), "clamped": 0, "ready": 1, "machine_id": MACHINE_ID, "compute_ns": 0}
    return ControllerState(**{"number": number, "tick": 0} | vectors | forces | counts | changes)


def ask_header(seq=0, epoch=5):
    return Header(
        version=WIRE_VERSION,
        schema=ASK.schema,
        cell=CELL,
        run=0,
        experiment=b"",
        sender="operator",
        epoch=epoch,
        arming_id=0,
        seq=seq,
        echo_number=-1,
        echo_time_ns=0,
    )


class Query:
    """A request as the transport hands it over, and the frames that answered it."""

    def __init__(self, service, verb, seq=0, epoch=5, **arguments):
        self.key_expr = expression(CELL, f"{ASK.key}/{service}")
        self._say(verb, json.dumps({"to": EPOCHS[service]} | arguments, ensure_ascii=False), seq, epoch)
        self.payload = SimpleNamespace(to_bytes=lambda: self.frame)
        self.replies = []

    def _say(self, verb, arguments, seq, epoch):
        self.frame = encode(self.key_expr, ask_header(seq, epoch), Ask(verb, arguments.encode()))

    @classmethod
    def of_text(cls, service, verb, arguments):
        """Arguments as they stand, object or not."""
        query = cls(service, verb)
        query._say(verb, arguments, 0, 5)
        return query

    def reply(self, key, frame):
        self.replies.append(frame)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return None


class FakeBus:
    """Keeps what is published; `send` puts a frame where the transport would."""

    def __init__(self, service="supervisor"):
        self.run = Run()
        self.published = []
        self.inboxes = {}
        self.waits_for_room = False
        self.conditions = idle(service)
        self.asked = Requests(CELL, EPOCHS[service], lambda topic: ask_header()._replace(schema=topic.schema, sender=service))

    def subscribe(self, key, depth=RING):
        self.inboxes[key] = Inbox(BY_KEY[key], CELL, depth, lambda: None)
        return self.inboxes[key]

    def impair(self, conditions):
        self.conditions = conditions
        for inbox in self.inboxes.values():
            inbox.impair(conditions)

    def publish(self, key, body, echo=(-1, 0)):
        self.published.append((key, body, echo))

    def requests(self):
        return self.asked.take()

    def stops(self):
        return self.asked.stops()

    def of(self, key):
        return [body for topic, body, _ in self.published if topic == key]

    def send(self, key, head, body):
        self.send_bytes(key, encode(expression(CELL, key), head, body))

    def send_bytes(self, key, frame):
        self.inboxes[key].put(SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: frame)))
