"""What an operator asks of a service: requests that wait, the one answer that each gets, and none of them twice."""

import hashlib
import json
import time
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from shared.codec import Header, Rejected, decode, encode
from shared.inbox import RING
from shared.messages import Answer
from shared.topics import ANSWER, ASK, Topic

_REMEMBERED = 1024  # digests of frames; each names its sender's start and number, so that none comes twice by itself
_REPEATABLE = ("estop", "status")  # a stop is never refused; a question changes nothing, and must not push out what does
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

    def __init__(self, cell: str, header: Callable[[Topic], Header]) -> None:
        """None has come; `header` makes that of an answer."""
        self._cell, self._header = cell, header
        self._stops: deque[Any] = deque(maxlen=RING)
        self._waiting: deque[Any] = deque()
        self._others: list[Request] = []  # looked at, and no stops
        self._before: deque[bytes] = deque(maxlen=_REMEMBERED)

    def put(self, query: Any) -> None:
        """An emergency stop always finds room; of others as many wait as the ring holds."""
        if query.payload is not None and _ESTOP in query.payload.to_bytes():
            self._stops.append(query)
        elif len(self._waiting) < RING:
            self._waiting.append(query)

    def stops(self) -> list[Request]:
        """Emergency stops that have arrived, and nothing else; each wants one answer."""
        made: list[Request] = []
        while self._stops:
            request = self._request(self._stops.popleft())
            if request is not None:
                (made if request.verb == "estop" else self._others).append(request)  # the word may stand elsewhere in one
        return made

    def take(self) -> list[Request]:
        """Requests that have arrived, emergency stops first; each wants one answer. What cannot be served is refused here."""
        made, others = self.stops(), self._others
        self._others = []
        while self._waiting:
            if (request := self._request(self._waiting.popleft())) is not None:
                others.append(request)
        return [*made, *others]

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
        if asked.body.verb not in _REPEATABLE:
            digest = hashlib.sha256(payload).digest()
            if digest in self._before:
                return answer(False, "this request came before, byte for byte: a replay has no effect", {})
            self._before.append(digest)
        return Request(asked.body.verb, arguments, answer)

    def _answer(self, query: Any, key: str) -> Callable[[bool, str, dict[str, Any]], None]:
        def answer(accepted: bool, reason: str, values: dict[str, Any]) -> None:
            body = Answer(int(accepted), reason, json.dumps(values).encode())
            with query:
                query.reply(key, encode(key, self._header(ANSWER), body))

        return answer
