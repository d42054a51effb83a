"""Frames as senders make them, and a bus without a network."""

from types import SimpleNamespace

from shared.bus import Run
from shared.codec import WIRE_VERSION, Header, encode
from shared.detour import idle
from shared.inbox import RING, Inbox
from shared.messages import Command, ControllerState, Mode, Permit
from shared.topics import BY_KEY, expression

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


class FakeBus:
    """Keeps what is published; `send` puts a frame where the transport would."""

    def __init__(self, service="supervisor"):
        self.run = Run()
        self.published = []
        self.inboxes = {}
        self.waits_for_room = False
        self.conditions = idle(service)

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
        return []

    def of(self, key):
        return [body for topic, body, _ in self.published if topic == key]

    def send(self, key, head, body):
        self.send_bytes(key, encode(expression(CELL, key), head, body))

    def send_bytes(self, key, frame):
        self.inboxes[key].put(SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: frame)))
