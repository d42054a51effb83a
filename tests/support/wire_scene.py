"""Frames as senders make them, and a bus without a network."""

import json
from types import SimpleNamespace

from hydrohil.shared.contract.codec import WIRE_VERSION, Header, encode
from hydrohil.shared.contract.messages import Ask, Command, ControllerState, Mode, Permit
from hydrohil.shared.contract.topics import ASK, BY_KEY, expression
from hydrohil.shared.transport.bus import Run
from hydrohil.shared.transport.impairment_queue import idle
from hydrohil.shared.transport.inbox import RING, Inbox
from hydrohil.shared.transport.requests import Requests

CELL = "cell"
EPOCHS = {"plant": 31, "supervisor": 11, "controller": 22}
ZERO = (2048, 2048, 2048)


def header(key, seq=0, **changes):
    topic = BY_KEY[key]
    made = Header(WIRE_VERSION, topic.schema, CELL, 0, b"", topic.publisher, EPOCHS[topic.publisher], 77, seq, 0, 0)
    return made._replace(**changes)


def permit_body(mode=Mode.RUNNING, **changes):
    return Permit(int(mode), 0, 0.0, 0.0, -1, 0, 100, 8, (0, 0, 0), 334.0, 0.0)._replace(**changes)


def command_body(codes=ZERO):
    return Command(codes)


def state_body(number=0, **changes):
    links = (0.0, 0.0, 0.0)
    made = ControllerState(number, 0, *[links] * 7, 0.0, 0.0, 0.0, 0.0, links, links, (0, 0, 0), 0, 1, 0)
    return made._replace(**changes)


def ask_header(seq=0, epoch=5):
    return Header(WIRE_VERSION, ASK.schema, CELL, 0, b"", "operator", epoch, 0, seq, -1, 0)


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
