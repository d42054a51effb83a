"""An experiment is loaded in two phases: every service reads and checks it first, and only then does each one take it over."""

import gc
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from hydrohil.shared.contract.envelope import Envelope, unseal
from hydrohil.shared.host.realtime import set_scheduling, without_realtime
from hydrohil.shared.transport.bus import Bus, Run
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request

Prepared = TypeVar("Prepared")


class Checked(NamedTuple, Generic[Prepared]):
    """What a service has prepared from its section of an envelope, and what it adds to its answer."""

    prepared: Prepared
    answer: dict[str, Any]


class TwoPhaseLoad(Generic[Prepared]):
    """The requests "load" and "commit" of one service.

    `busy()` says in one line why nothing can be loaded now, "" if it can. `check(envelope, arguments)` prepares the service's
    own part and raises ValueError with one line. `take(envelope, prepared)` makes it the service's own and cannot refuse.
    """

    def __init__(
        self,
        bus: Bus,
        faults: LiveFaults,
        *,
        busy: Callable[[], str],
        check: Callable[[Envelope, dict[str, Any]], Checked[Prepared]],
        take: Callable[[Envelope, Prepared], None],
    ) -> None:
        """Nothing is loaded."""
        self._bus, self._faults = bus, faults
        self._busy, self._check, self._take = busy, check, take
        self._pending: tuple[Envelope, Prepared] | None = None

    def load(self, request: Request) -> None:
        """Phase one: read and check; nothing that runs is changed."""
        if reason := self._busy():
            return request.refuse(reason)
        try:
            with without_realtime():
                envelope = unseal(str(request.arguments.get("envelope")))
                checked = self._check(envelope, request.arguments)
                self._faults.loaded(envelope)
        except ValueError as error:
            return request.refuse(str(error))
        self._pending = (envelope, checked.prepared)
        return request.reply({"digest": envelope.digest.hex()} | checked.answer)

    def commit(self, request: Request) -> None:
        """Phase two: take over what was loaded with this digest, with its run, its faults and its clock."""
        if reason := self._busy():
            return request.refuse(reason)
        if self._pending is None or self._pending[0].digest.hex() != request.arguments.get("digest"):
            return request.refuse("nothing with this hash was loaded: load it first")
        envelope, prepared = self._pending
        try:
            conditions = self._faults.loaded(envelope)  # once more: faults may have been injected since the load
        except ValueError as error:
            return request.refuse(str(error))
        self._bus.run = Run(envelope.run, envelope.digest, 0)
        self._bus.impair(conditions)
        self._bus.waits_for_room = envelope.clock == "lockstep"
        set_scheduling(envelope.clock)
        gc.collect()
        self._take(envelope, prepared)
        return request.reply({"digest": envelope.digest.hex()})
