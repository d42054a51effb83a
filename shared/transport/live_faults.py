"""Faults that an operator injects into one service of a running cell: on its incoming links, and in its pace."""

import time
from typing import Any

from hydrohil.shared.contract.envelope import Envelope, one_fault
from hydrohil.shared.contract.faults import MOST_DELAY_MS, MOST_FAULTS, Fault, delay_ms, problem, row_of
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.impairment import paths_of
from hydrohil.shared.transport.impairment_conditions import Conditions, conditions_of
from hydrohil.shared.transport.requests import Request
from hydrohil.shared.units import NS_PER_S

_S_PER_MS = 1e-3
_FOR_EVER_NS = 1 << 62
_END = "end that first (`hydrohil inject --clear`)"


class LiveFaults:
    """Faults of groups transport and process that a service plays itself."""

    def __init__(self, bus: Bus) -> None:
        """No fault acts."""
        self._bus, self._service = bus, bus.conditions.service
        self._slow: Fault | None = None
        self._span_ns = (0, 0)  # in which the service is slow

    def answer(self, request: Request, number: int) -> None:
        """Answer "inject" and "clear"; `number` is that of the newest sample."""
        if request.verb == "clear":
            self.clear()
            return request.reply({})
        try:
            fault = one_fault(request.arguments.get("fault"))
            self.inject(fault, number)
        except ValueError as error:
            return request.refuse(str(error))
        return request.reply({"number": self._bus.conditions.begins(fault, number)})

    def inject(self, fault: Fault, number: int) -> None:
        """From the next sample on; raises ValueError with one line if this service cannot play it."""
        if what := problem(fault):
            raise ValueError(what)
        if fault.at_s < 0.0:
            raise ValueError(f"begins {fault.at_s:g} s from now, expected 0 or later")
        if self._bus.conditions.lockstep:
            raise ValueError("a lockstep trial is loaded, and its services must all know a fault beforehand: schedule it")
        if fault.kind == "slow" and fault.target == self._service:
            now_ns = time.monotonic_ns()
            if self._is_slow(now_ns):
                raise ValueError(f"the {self._service} is slow already, or will be: {_END}")
            self._slow = fault
            begin_ns = now_ns + round(fault.at_s * NS_PER_S)
            self._span_ns = (begin_ns, begin_ns + round(fault.lasts_s * NS_PER_S) if fault.lasts_s else _FOR_EVER_NS)
        elif row_of(fault).group == "transport" and any(path.endswith(f">{self._service}") for path in paths_of(fault)):
            lasting = self._bus.conditions.lasting()
            if len(lasting) >= MOST_FAULTS:
                raise ValueError(f"{MOST_FAULTS} faults act or wait already: {_END}")
            together = delay_ms((fault, *(before for before, _ in lasting)), fault.target)
            if together > MOST_DELAY_MS:
                raise ValueError(f"delays that act or wait would add up to {together:g} ms, at most {MOST_DELAY_MS:g}: {_END}")
            self._bus.conditions.inject((*lasting, (fault, number)))
            self._bus.impair(self._bus.conditions)
        else:
            raise ValueError(f"{fault.kind} of {fault.target} is not played by the {self._service}")

    def loaded(self, envelope: Envelope) -> Conditions:
        """The transport faults of a load; raises ValueError if it cannot be played, also beside what was injected by hand."""
        if envelope.clock == "lockstep" and self._is_slow(time.monotonic_ns()):
            raise ValueError(f"the {self._service} is slow still, or will be, and lockstep has none of it: {_END}")
        return conditions_of(envelope, self._bus.conditions)

    def _is_slow(self, now_ns: int) -> bool:
        """Whether an injected slowness acts or waits."""
        return self._slow is not None and now_ns < self._span_ns[1]

    def clear(self) -> None:
        """End every injected fault; frames that one has delayed still come."""
        self._slow = None
        self._bus.conditions.inject(())

    def spend(self) -> None:
        """Sleep for the time by which a slow service's step is longer."""
        if self._slow is None:
            return
        begin_ns, end_ns = self._span_ns
        now_ns = time.monotonic_ns()
        if now_ns >= end_ns:
            self._slow = None
        elif now_ns >= begin_ns:
            time.sleep(self._slow.value * _S_PER_MS)

    def acting(self) -> list[dict[str, Any]]:
        """For a status: what was injected and has not ended."""
        slow = () if self._slow is None else (self._slow,)
        return [fault._asdict() for fault in (*slow, *(fault for fault, _ in self._bus.conditions.lasting()))]
