"""The only file that imports zenoh: a full mesh of peers on explicit loopback endpoints, no router, no daemon.

A callback only stamps and appends to a bounded ring; whoever steps drains all of it, checks and counts every frame.
Every session tries for ever, so the order of starting does not matter. Liveliness tokens show presence, no more.
"""

import errno
import hashlib
import json
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Any, NamedTuple

import zenoh

from shared.acceptance import Acceptance
from shared.codec import WIRE_VERSION, Header, Received, Rejected, decode, encode
from shared.detour import FOREVER_NS, Conditions, Detour, Passage, idle
from shared.messages import NO_COMMAND, Answer, Ask
from shared.protection import Protection, ProtectionLimits
from shared.topics import ANSWER, ASK, BY_KEY, Topic, expression

LISTENERS = ("plant", "controller", "supervisor", "recorder")  # offset from the cell's first port
RING = 64  # frames kept for one step; a ring of one would let a foreign frame push out a valid one
DEFAULT_PORT = 7450
HOST = "127.0.0.1"
_PRIORITIES = ("control", "real_time", "interactive_high", "interactive_low", "data_high", "data", "data_low", "background")
_REQUESTS_REMEMBERED = 1024  # digests of frames; each names its sender's start and number, so that none comes twice by itself
_REPEATABLE = ("estop", "status")  # a stop is never refused; a question changes nothing, and must not push out what does
_ESTOP = b"\xa5estop"  # the verb as it stands in a frame: MessagePack text of five bytes
_QUEUED_BATCHES = 16  # two, the default, lose messages when the processor is contended


class BusError(Exception):
    """The transport cannot be had; the message says what to do."""


class Identity(NamedTuple):
    """What a service writes into every header."""

    cell: str
    sender: str
    epoch: int


class Run(NamedTuple):
    """What a frame belongs to."""

    run: int = 0
    experiment: bytes = b""
    arming: int = 0


def same_run(header: Header, run: Run) -> bool:
    """Whether a frame belongs to this run of this experiment."""
    return header.run == run.run and header.experiment == run.experiment


class Inbox:
    """One topic's bounded ring, filled by the transport and drained by the step."""

    def __init__(self, topic: Topic, cell: str, depth: int, wake: Callable[[], None]) -> None:
        """An empty ring of `depth` frames."""
        self.topic, self.cell = topic, cell
        self.acceptance = Acceptance()
        self.protection = Protection(self.acceptance, ProtectionLimits())
        self._key = expression(cell, topic.key)
        self._ring: deque[tuple[int, bytes]] = deque(maxlen=depth)
        self._wake = wake
        self.detour: Detour | None = None  # transport faults, while any are loaded

    def put(self, sample: Any) -> None:
        """Transport's callback: stamp and append."""
        self._ring.append((time.monotonic_ns(), sample.payload.to_bytes()))
        self._wake()

    def impair(self, conditions: Conditions) -> None:
        """Let faults act on this topic, if any of `conditions` touches it; what is under way of the same load stays so."""
        if self.detour is not None and self.detour.conditions is conditions:
            return
        self.detour = Detour(self.topic, conditions, self._decode) if conditions.touches(self.topic) else None

    def peek(self) -> Received | Rejected | None:
        """The newest frame, left where it is; for progress, never for control."""
        try:
            arrival_ns, frame = self._ring[-1]
        except IndexError:
            return None
        return self._decode(frame, arrival_ns)

    def drain(self, simulated_ns: int = FOREVER_NS) -> list[Received | Rejected]:
        """Everything that has come, in order, decoded but not yet judged; faults in lockstep go by simulated time."""
        frames = []
        while self._ring:
            arrival_ns, frame = self._ring.popleft()
            message = self._decode(frame, arrival_ns)
            if self.detour is None:
                frames.append(message)
            else:
                self.detour.admit(frame, message, simulated_ns)
        return frames if self.detour is None else self.detour.released(simulated_ns, time.monotonic_ns())

    def take(self, simulated_ns: int = FOREVER_NS) -> list[Received]:
        """Everything valid that has come, in order; the rest is counted in `acceptance`."""
        return [taken for message in self.drain(simulated_ns) if (taken := self.acceptance.take(message)) is not None]

    @property
    def number(self) -> int:
        """Sample that the newest frame taken is, answers or judges."""
        return NO_COMMAND if self.acceptance.bound is None else self.acceptance.bound.echo_number

    def passages(self) -> list[Passage]:
        """Samples that arrived in lockstep since the last call and did not come as they should."""
        if self.detour is None:
            return []
        passed, self.detour.passages = self.detour.passages, []
        return passed

    def arrived(self) -> int:
        """Newest sample whose answer a fault holds or took; nobody waits for it."""
        return NO_COMMAND if self.detour is None else self.detour.newest

    def delay_ns(self, message: Received) -> int:
        """Simulated time by which faults made `message` later than its sample."""
        return 0 if self.detour is None else self.detour.delay_ns(message.header.echo_number)

    def _decode(self, frame: bytes, arrival_ns: int) -> Received | Rejected:
        return decode(self._key, self.topic, self.cell, frame, arrival_ns)


class Request(NamedTuple):
    """A request that waits for its answer."""

    verb: str
    arguments: dict[str, Any]
    answer: Callable[[bool, str, dict[str, Any]], None]

    def reply(self, values: dict[str, Any]) -> None:
        """Accept."""
        self.answer(True, "", values)

    def refuse(self, reason: str) -> None:
        """Refuse, saying why and what to do."""
        self.answer(False, reason, {})


class Bus:
    """A service's place on the network."""

    def __init__(self, service: str, cell: str, port_base: int, epoch: int) -> None:
        """Nothing is opened before the `with`."""
        self.identity = Identity(cell, service, epoch)
        self.run = Run()
        self.requests_seen: deque[Any] = deque(maxlen=RING)
        self._asked_before: deque[bytes] = deque(maxlen=_REQUESTS_REMEMBERED)
        self.waits_for_room = False  # instead of dropping: in lockstep nothing may be lost to a slow reader
        self.conditions = idle(service)
        self._inboxes: list[Inbox] = []
        self._port_base = port_base
        self._lock = threading.Lock()
        self._lock.acquire()
        self._seq: dict[str, int] = {}
        self._publishers: dict[tuple[str, bool], Any] = {}

    def __enter__(self) -> "Bus":
        """Open the session; raises BusError if this service's port is taken."""
        self._refuse_taken_port()
        try:
            self._session = zenoh.open(_config(self.identity.sender, self._port_base))
        except zenoh.ZError as error:
            raise BusError(f"the transport does not open: {error}") from error
        self._queryable = self._session.declare_queryable(
            expression(self.identity.cell, f"{ASK.key}/{self.identity.sender}"),
            zenoh.handlers.Callback(self._asked, indirect=False),
        )
        self._token = self._session.liveliness().declare_token(expression(self.identity.cell, f"alive/{self.identity.sender}"))
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Close the session; what was sent is flushed."""
        self._session.close()  # type: ignore[no-untyped-call]

    def _refuse_taken_port(self) -> None:
        service = self.identity.sender
        if service not in LISTENERS:
            return
        port = self._port_base + LISTENERS.index(service)
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((HOST, port))
            except OSError as error:
                if error.errno != errno.EADDRINUSE:
                    raise BusError(f"port {port} on {HOST}: {error.strerror}") from error
                raise BusError(
                    f"port {port} on {HOST} is in use: a {service} runs there already; "
                    f"stop it (`hydrohil down`) or give this cell other ports (`--port N`)"
                ) from error

    def wake(self) -> None:
        """Let `wait` return. Safe from any thread."""
        try:
            self._lock.release()
        except RuntimeError:  # already awake
            return

    def wait(self, timeout_s: float) -> bool:
        """Sleep until something arrives, or a frame that a fault delays comes; False after `timeout_s`."""
        for inbox in self._inboxes:
            if inbox.detour is not None:
                timeout_s = min(timeout_s, (inbox.detour.next_ns() - time.monotonic_ns()) * 1e-9)
        return self._lock.acquire(timeout=max(0.0, timeout_s))

    def impair(self, conditions: Conditions) -> None:
        """From now on these faults act on what this service receives; a way that none touches stays free of cost."""
        self.conditions = conditions
        for inbox in self._inboxes:
            inbox.impair(conditions)

    def subscribe(self, key: str, depth: int = RING) -> Inbox:
        """A ring fed by one topic."""
        inbox = Inbox(BY_KEY[key], self.identity.cell, depth, self.wake)
        self._inboxes.append(inbox)
        handler = zenoh.handlers.Callback(inbox.put, indirect=False)
        self._session.declare_subscriber(expression(self.identity.cell, key), handler)
        return inbox

    def publish(self, key: str, body: tuple[Any, ...], echo: tuple[int, int] = (NO_COMMAND, 0)) -> None:
        """Send one message; `echo` is number and time of the sample it answers or judges."""
        topic = BY_KEY[key]
        name = expression(self.identity.cell, key)
        publisher = self._publishers.get((key, self.waits_for_room)) or self._declare(topic, name)
        publisher.put(encode(name, self._header(topic, echo), body))

    def _declare(self, topic: Topic, name: str) -> Any:
        publisher = self._session.declare_publisher(
            name,
            priority=zenoh.Priority.REAL_TIME if topic.loop else zenoh.Priority.DATA,
            congestion_control=zenoh.CongestionControl.BLOCK if self.waits_for_room else zenoh.CongestionControl.DROP,
        )
        self._publishers[topic.key, self.waits_for_room] = publisher
        return publisher

    def _header(self, topic: Topic, echo: tuple[int, int] = (NO_COMMAND, 0)) -> Header:
        seq = self._seq[topic.key] = self._seq.get(topic.key, -1) + 1
        cell, sender, epoch = self.identity
        run, experiment, arming = self.run
        return Header(WIRE_VERSION, topic.schema, cell, run, experiment, sender, epoch, arming, seq, echo[0], echo[1])

    def requests(self) -> list[Request]:
        """Requests that have arrived; each wants one answer."""
        made = []
        while self.requests_seen:
            query = self.requests_seen.popleft()
            key = str(query.key_expr)
            payload = query.payload.to_bytes() if query.payload is not None else b""
            asked = decode(key, ASK, self.identity.cell, payload, time.monotonic_ns())
            answer = self._answer(query, key)
            if isinstance(asked, Rejected):
                answer(False, f"malformed request: {asked.cause}: {asked.detail}", {})
                continue
            try:
                arguments = json.loads(asked.body.arguments)
            except (ValueError, RecursionError):
                arguments = None
            if not isinstance(arguments, dict):
                answer(False, "malformed request: the arguments are no JSON object", {})
                continue
            if asked.body.verb not in _REPEATABLE:
                digest = hashlib.sha256(payload).digest()
                if digest in self._asked_before:
                    answer(False, "this request came before, byte for byte: a replay has no effect", {})
                    continue
                self._asked_before.append(digest)
            made.append(Request(asked.body.verb, arguments, answer))
        return made

    def _asked(self, query: Any) -> None:
        """Transport's callback: an emergency stop goes first and always finds room; of others as many wait as the ring holds."""
        if query.payload is not None and _ESTOP in query.payload.to_bytes():
            self.requests_seen.appendleft(query)
        elif len(self.requests_seen) < RING:
            self.requests_seen.append(query)
        self.wake()

    def _answer(self, query: Any, key: str) -> Callable[[bool, str, dict[str, Any]], None]:
        def answer(accepted: bool, reason: str, values: dict[str, Any]) -> None:
            body = Answer(int(accepted), reason, json.dumps(values).encode())
            with query:
                query.reply(key, encode(key, self._header(ANSWER), body))

        return answer

    def ask(self, service: str, verb: str, arguments: dict[str, Any], timeout_s: float = 2.0) -> Answer | None:
        """The answer of `service`, or None if nobody gives one in time."""
        key = expression(self.identity.cell, f"{ASK.key}/{service}")
        frame = encode(key, self._header(ASK), Ask(verb, json.dumps(arguments).encode()))
        for reply in self._session.get(key, payload=frame, timeout=timeout_s):
            if reply.ok is None:
                return None
            answer = decode(key, ANSWER, self.identity.cell, reply.ok.payload.to_bytes(), time.monotonic_ns())
            return answer.body if isinstance(answer, Received) else None
        return None

    def alive(self, timeout_s: float = 1.0) -> set[str]:
        """Names of the services whose presence is announced."""
        tokens = self._session.liveliness().get(expression(self.identity.cell, "alive/*"), timeout=timeout_s)
        return {str(reply.ok.key_expr).rsplit("/", 1)[1] for reply in tokens if reply.ok is not None}


def _config(service: str, port_base: int) -> Any:
    """Listen on one's own port, connect to every listener started before; the operator only connects."""
    rank = LISTENERS.index(service) if service in LISTENERS else len(LISTENERS)
    listen = [f"tcp/{HOST}:{port_base + rank}"] if service in LISTENERS else []
    connect = [f"tcp/{HOST}:{port_base + i}" for i in range(rank)]
    queue = {"size": dict.fromkeys(_PRIORITIES, _QUEUED_BATCHES)}
    return zenoh.Config.from_json5(
        json.dumps(
            {
                "mode": "peer",
                "listen": {"endpoints": listen},
                "connect": {
                    "endpoints": connect,
                    "timeout_ms": -1,
                    "exit_on_failure": False,
                    "retry": {"period_init_ms": 50, "period_max_ms": 200, "period_increase_factor": 1.5},
                },
                "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}},
                "timestamping": {"enabled": False},
                "queries_default_timeout": 1000,
                "transport": {
                    "shared_memory": {"enabled": False},
                    "link": {"tx": {"lease": 500, "keep_alive": 4, "queue": queue}},
                },
            }
        )
    )
