"""The only file that imports zenoh: a mesh of peers on explicit endpoints, or clients of a router; `endpoints` says which.

A callback stamps each frame and appends it to a bounded ring; the step drains the ring, checks and counts every frame. After
`step_on_arrival` a service steps in that callback, without waking a thread of its own.
Every session keeps trying to connect, so the services may start in any order. Liveliness tokens only show presence.
"""

import errno
import json
import os
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, NamedTuple

# The thread that polls a link also reads it; by default each frame wakes one thread for either. A dead link holds a thread
# until it is closed.
os.environ.setdefault("ZENOH_RUNTIME", "(net:(worker_threads:8),rx:(handover:net),acc:(handover:net))")

import zenoh

from hydrohil.shared.contract.codec import WIRE_VERSION, Header, Received, decode, encode
from hydrohil.shared.contract.messages import NO_COMMAND, Answer, Ask
from hydrohil.shared.contract.topics import ANSWER, ASK, BY_KEY, Topic, expression
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.exit_status import EXIT_TRANSPORT
from hydrohil.shared.transport.endpoints import HERE, LISTENERS, Network, address, configuration, listener, router_configuration
from hydrohil.shared.transport.impairment_conditions import Conditions, idle
from hydrohil.shared.transport.inbox import RING, Inbox
from hydrohil.shared.transport.requests import REPEATABLE, TO, Request, Requests
from hydrohil.shared.transport.step_lock import StepLock
from hydrohil.shared.transport.thread_state import keep_thread_state

_TAKEN = "a {service} runs there already; stop it (`hydrohil down`) or give this cell other ports (`--port N`)"
_THERE = "a {service} of cell {cell!r} is at this router already; stop it (`hydrohil down`) or name another (`--cell NAME`)"


class BusError(HydrohilError):
    """The transport cannot be opened; the message says what to do."""

    exit_status = EXIT_TRANSPORT


class Identity(NamedTuple):
    """What a service writes into every header."""

    cell: str
    sender: str
    epoch: int


class Run(NamedTuple):
    """Run, experiment and arming that a frame belongs to."""

    run: int = 0
    experiment: bytes = b""
    arming_id: int = 0


def same_run(header: Header, run: Run) -> bool:
    """Whether a frame belongs to this run of this experiment."""
    return header.run == run.run and header.experiment == run.experiment


class Bus:
    """A service's place on the network."""

    def __init__(self, service: str, cell: str, port_base: int, epoch: int, network: Network = HERE) -> None:
        """Nothing is opened before the `with`."""
        self.identity = Identity(cell, service, epoch)
        self.run = Run()
        self._requests = Requests(cell, epoch, self._header)
        self._starts: dict[str, int] = {}  # epoch of each service that has answered
        self.waits_for_room = False  # instead of dropping: in lockstep nothing may be lost to a slow reader
        self.conditions = idle(service)
        self._inboxes: dict[Inbox, Any] = {}  # and the subscriber that feeds each
        self._port_base, self._network = port_base, network
        self._lock = threading.Lock()
        self._lock.acquire()
        self._step_lock: StepLock | None = None  # of a service that steps in the transport's callback
        self._failure: BaseException | None = None  # of such a step
        self._impaired = False  # faults act on what arrives
        self._seq: dict[str, int] = {}
        self._publishers: dict[tuple[str, bool], Any] = {}

    def __enter__(self) -> "Bus":
        """Open the session; raises BusError if this service is there already, or no router answers within a second."""
        service = self.identity.sender
        own = listener(service, self._port_base, self._network)
        if own is not None:
            _refuse_taken(own, _TAKEN.format(service=service))
        self._session = _open(configuration(service, self._port_base, self._network), self._network.router)
        if self._network.router and service in LISTENERS and service in self.alive():
            self._session.close()
            raise BusError(_THERE.format(service=service, cell=self.identity.cell))
        self._queryable = self._session.declare_queryable(
            expression(self.identity.cell, f"{ASK.key}/{self.identity.sender}"),
            zenoh.handlers.Callback(self._asked, indirect=False),
        )
        self._token = self._session.liveliness().declare_token(expression(self.identity.cell, f"alive/{self.identity.sender}"))
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Close the session; what was sent is flushed."""
        self._session.close()

    def wake(self) -> None:
        """Let `wait` return. Safe from any thread."""
        if not self._lock.locked():  # already awake; catching the exception instead would double the cost of an arrival
            return
        try:
            self._lock.release()
        except RuntimeError:  # another thread was faster
            return

    def step_on_arrival(self, step_lock: StepLock) -> None:
        """From now on the transport's thread steps as soon as a frame is there, and `wait` returns for requests alone.

        While faults act on what arrives it only wakes `wait`: a delayed frame is released when no frame arrives.
        """
        self._step_lock = step_lock

    def _arrived(self) -> None:
        """Transport's callback, after a frame was put into its ring."""
        keep_thread_state()
        if self._step_lock is None or self._impaired:
            return self.wake()
        try:
            self._step_lock.step()
        except BaseException as failure:  # without this the transport would log the exception and go on
            self._failure = failure
            self.wake()

    def wait(self, timeout_s: float) -> bool:
        """Sleep until a frame arrives, or one that a fault delays is released; False after `timeout_s`.

        Raises the exception of a step in the transport's thread.
        """
        for inbox in self._inboxes:
            if inbox.impairment_queue is not None:
                timeout_s = min(timeout_s, (inbox.impairment_queue.next_ns() - time.monotonic_ns()) * 1e-9)
        woken = self._lock.acquire(timeout=max(0.0, timeout_s))
        if self._failure is not None:
            raise self._failure
        return woken

    def impair(self, conditions: Conditions) -> None:
        """From now on these faults act on what this service receives; a topic that none touches costs nothing."""
        self.conditions = conditions
        for inbox in self._inboxes:
            inbox.impair(conditions)
        self._impaired = any(inbox.impairment_queue is not None for inbox in self._inboxes)

    def subscribe(self, key: str, depth: int = RING) -> Inbox:
        """A ring fed by one topic."""
        inbox = Inbox(BY_KEY[key], self.identity.cell, depth, self._arrived)
        handler = zenoh.handlers.Callback(inbox.put, indirect=False)
        self._inboxes[inbox] = self._session.declare_subscriber(expression(self.identity.cell, key), handler)
        return inbox

    def unsubscribe(self, inbox: Inbox) -> None:
        """Feed a ring no longer; what it holds stays."""
        self._inboxes.pop(inbox).undeclare()

    def listen(self, key: str, take: Callable[[bytes], None]) -> None:
        """Bare payloads of a topic, to measure the transport: `take` runs in its callback."""

        def arrived(sample: Any) -> None:
            keep_thread_state()
            take(sample.payload.to_bytes())
            self.wake()

        self._session.declare_subscriber(expression(self.identity.cell, key), zenoh.handlers.Callback(arrived, indirect=False))

    def sender(self, key: str) -> Callable[[bytes], None]:
        """A function that sends bare payloads on a topic, with its quality of service."""
        put: Callable[[bytes], None] = self._declare(BY_KEY[key], expression(self.identity.cell, key)).put
        return put

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
        run, experiment, arming_id = self.run
        return Header(
            version=WIRE_VERSION,
            schema=topic.schema,
            cell=cell,
            run=run,
            experiment=experiment,
            sender=sender,
            epoch=epoch,
            arming_id=arming_id,
            seq=seq,
            echo_number=echo[0],
            echo_time_ns=echo[1],
        )

    def requests(self) -> list[Request]:
        """Requests that have arrived; each wants one answer."""
        return self._requests.take()

    def stops(self) -> list[Request]:
        """Emergency stops alone: they do not wait for the rest to be served."""
        return self._requests.stops()

    def _asked(self, query: Any) -> None:
        """Transport's callback."""
        self._requests.put(query)
        self.wake()

    def ask(self, service: str, verb: str, arguments: dict[str, Any], timeout_s: float = 2.0) -> Answer | None:
        """The answer of `service`, or None if none comes in time.

        A request that acts names the epoch in which the service answered last; the first such request asks for it.
        """
        if verb not in REPEATABLE:
            if service not in self._starts and self._put(service, "status", {}, timeout_s) is None:
                return None
            arguments = arguments | {TO: self._starts[service]}
        return self._put(service, verb, arguments, timeout_s)

    def _put(self, service: str, verb: str, arguments: dict[str, Any], timeout_s: float) -> Answer | None:
        key = expression(self.identity.cell, f"{ASK.key}/{service}")
        frame = encode(key, self._header(ASK), Ask(verb, json.dumps(arguments).encode()))
        for reply in self._session.get(key, payload=frame, timeout=timeout_s):
            if reply.ok is None:
                return None
            answer = decode(key, ANSWER, self.identity.cell, reply.ok.payload.to_bytes(), time.monotonic_ns())
            if not isinstance(answer, Received):
                return None
            self._starts[service] = answer.header.epoch
            body: Answer = answer.body
            return body
        return None

    def alive(self, timeout_s: float = 1.0) -> set[str]:
        """Names of the services whose presence is announced."""
        tokens = self._session.liveliness().get(expression(self.identity.cell, "alive/*"), timeout=timeout_s)
        return {str(reply.ok.key_expr).rsplit("/", 1)[1] for reply in tokens if reply.ok is not None}


@contextmanager
def router(listen: str) -> Iterator[None]:
    """Route between clients that connect to the endpoint `listen`; raises BusError if its port is taken."""
    _refuse_taken(address(listen, "--listen"), "another router may run there: stop it, or name another port (`--listen`)")
    session = _open(router_configuration(listen), "")
    try:
        yield
    finally:
        session.close()


def _open(text: str, router: str) -> Any:
    """A session; `router` is the endpoint that it needs, if any."""
    try:
        return zenoh.open(zenoh.Config.from_json5(text))
    except zenoh.ZError as error:
        if router:
            raise BusError(f"no router answers at {router}: start it (`hydrohil router`)") from error
        raise BusError(f"the transport does not open: {error}") from error


def _refuse_taken(where: tuple[str, int], advice: str) -> None:
    """Raise BusError, with `advice` where somebody listens there already."""
    host, port = where
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise BusError(f"port {port} on {host} is in use: {advice}") from error
            raise BusError(f"port {port} on {host}: {error.strerror}") from error
