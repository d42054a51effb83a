"""Requests of operators to a service: each is answered once, and a replayed one has no effect.

A request names the epoch of the service that it is meant for, which every answer carries: a request recorded before a restart
has no effect after it. Within one epoch the numbers of each operator's session only rise.
"""

import json
import time
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from hydrohil.shared.contract.codec import Header, Rejected, decode, encode
from hydrohil.shared.contract.messages import Answer
from hydrohil.shared.contract.topics import ANSWER, ASK, Topic
from hydrohil.shared.transport.inbox import RING

TO = "to"  # argument of every request that acts: epoch of the service that it is meant for
REPEATABLE = ("estop", "status")  # a stop is never refused, and a status request changes nothing
MOST_SESSIONS = 1 << 16  # of operators in one epoch, 10 MB; the requests of a forgotten one could act again
_ESTOP = b"\xa5estop"  # the verb as it stands in a frame: MessagePack text of five bytes


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


class Requests:
    """Queries between the transport, which brings them, and the step, which serves them.

    A query has `key_expr`, `payload` and `reply(key, frame)`, and ends with its `with`.
    """

    def __init__(self, cell: str, epoch: int, header: Callable[[Topic], Header]) -> None:
        """No request has come; `epoch` is the service's own, `header` builds that of an answer."""
        self._cell, self._epoch, self._header = cell, epoch, header
        self._stops: deque[Any] = deque(maxlen=RING)
        self._waiting: deque[Any] = deque()
        self._others: list[Request] = []  # decoded, and no emergency stops
        self._newest: dict[int, int] = {}  # number of the newest request that acted, by the asker's epoch

    def put(self, query: Any) -> None:
        """An emergency stop always finds room; of others as many wait as the ring holds."""
        if query.payload is not None and _ESTOP in query.payload.to_bytes():
            self._stops.append(query)
        elif len(self._waiting) < RING:
            self._waiting.append(query)

    def stops(self) -> list[Request]:
        """Emergency stops that have arrived, and nothing else; each wants one answer."""
        found: list[Request] = []
        while self._stops:
            request = self._request(self._stops.popleft())
            if request is not None:
                (found if request.verb == "estop" else self._others).append(request)  # the word may stand elsewhere in one
        return found

    def take(self) -> list[Request]:
        """Requests that have arrived, emergency stops first; each wants one answer. What cannot be served is refused here."""
        stops, others = self.stops(), self._others
        self._others = []
        while self._waiting:
            if (request := self._request(self._waiting.popleft())) is not None:
                others.append(request)
        return [*stops, *others]

    def _request(self, query: Any) -> Request | None:
        key = str(query.key_expr)
        payload = query.payload.to_bytes() if query.payload is not None else b""
        asked = decode(key, ASK, self._cell, payload, time.monotonic_ns())
        answer = self._answer(query, key)
        if isinstance(asked, Rejected):
            return answer(False, f"malformed request: {asked.cause}: {asked.detail}", {})
        try:
            arguments = json.loads(asked.body.arguments)
        except (ValueError, RecursionError):
            arguments = None
        if not isinstance(arguments, dict):
            return answer(False, "malformed request: the arguments are no JSON object", {})
        to = arguments.pop(TO, None)
        if asked.body.verb not in REPEATABLE and (what := self._stale(asked.header, to)):
            return answer(False, what, {})
        return Request(asked.body.verb, arguments, answer)

    def _stale(self, header: Header, to: Any) -> str:
        """Why a request must not act, one line; "" if it may, once: its number counts as used from now on."""
        if type(to) is not int:
            return "it names no start of this service: ask for `status`, and give the epoch of that answer as argument `to`"
        if to != self._epoch:
            return "it is meant for another start of this service, which has started anew since: see `hydrohil status`, ask again"
        if header.seq <= self._newest.get(header.epoch, -1):
            return "this request, or a later one of the same session, came before: a replay has no effect"
        if header.epoch not in self._newest and len(self._newest) >= MOST_SESSIONS:
            return f"{MOST_SESSIONS} sessions have asked since this service started, and it keeps no more of them: start it anew"
        self._newest[header.epoch] = header.seq
        return ""

    def _answer(self, query: Any, key: str) -> Callable[[bool, str, dict[str, Any]], None]:
        def answer(accepted: bool, reason: str, values: dict[str, Any]) -> None:
            body = Answer(int(accepted), reason, json.dumps(values).encode())
            with query:
                query.reply(key, encode(key, self._header(ANSWER), body))

        return answer
