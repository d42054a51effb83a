"""What an operator may ask of the plant. Loading has two phases; nothing here can open the gate."""

import os
from collections.abc import Callable
from typing import Any

from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.plant.device import Device
from hydrohil.services.plant.gatekeeper import Gatekeeper
from hydrohil.services.plant.plant_clock import PlantClock
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.plant.trial import Schedule
from hydrohil.shared.contract.envelope import Envelope, one_fault, section
from hydrohil.shared.contract.faults import MOST_FAULTS, Fault, problem, row_of, ticks_of
from hydrohil.shared.host.realtime import without_realtime
from hydrohil.shared.host.two_phase_load import Checked, TwoPhaseLoad
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.live_faults import LiveFaults
from hydrohil.shared.transport.requests import Request


class PlantRequests:
    """Answers the operator's requests, each in its turn between two samples."""

    def __init__(
        self,
        bus: Bus,
        device: Device,
        keeper: Gatekeeper,
        clock: PlantClock,
        faults: LiveFaults,
        *,
        loaded: Callable[[], None],
        status: Callable[[], dict[str, Any]],
    ) -> None:
        """`loaded` is called after another experiment was taken over; `status` gives the plant's own part of its status."""
        self._bus, self._device, self._keeper, self._clock, self._faults = bus, device, keeper, clock, faults
        self._loaded, self._own_status = loaded, status
        self._loading = TwoPhaseLoad(bus, faults, busy=self._busy, check=self._check, take=self._take)
        self._handlers: dict[str, Callable[[Request], None]] = {
            "load": self._loading.load,
            "commit": self._loading.commit,
            "estop": self._estop,
            "reset": self._reset,
            "inject": self._inject,
            "clear": self._clear,
            "status": self._status,
        }

    def answer(self, request: Request) -> None:
        """Answer one request."""
        handler = self._handlers.get(request.verb)
        if handler is None:
            request.refuse(f"the plant knows no request {request.verb!r}; it knows {', '.join(self._handlers)}")
        else:
            handler(request)

    def _busy(self) -> str:
        armed = self._keeper.armed(self._clock.now_ns())
        return "a trial is armed or running: stop it first (`hydrohil stop`)" if armed else ""

    def _check(self, envelope: Envelope, _: dict[str, Any]) -> Checked[Schedule]:
        schedule = Schedule(section(envelope, "plant", PlantConfig), envelope)
        describe(schedule.config, self._keeper.limits)
        if refused := self._device.refuses(schedule.faults):
            raise ValueError(refused)
        return Checked(schedule, {})

    def _take(self, envelope: Envelope, schedule: Schedule) -> None:
        with without_realtime():  # drawing the noise of ten minutes at 1 kHz takes a tenth of a second
            self._device.load(schedule.config, envelope.seed, schedule.first_tick, schedule.ticks, schedule.faults)
        self._clock.load(schedule)
        self._loaded()

    def _estop(self, request: Request) -> None:
        self._keeper.stop(self._clock.now_ns())
        request.reply(self._codes())

    def _codes(self) -> dict[str, Any]:
        """Codes that the gate gives, and those that drive the valves; null where the device cannot read them back."""
        driven = self._device.readback()
        return {"dac_counts": list(self._keeper.gate.codes), "dac_readback": None if driven is None else list(driven)}

    def _reset(self, request: Request) -> None:
        self._keeper.release_stop(self._clock.now_ns())
        request.reply({})

    def _inject(self, request: Request) -> None:
        """Break the machine from the next sample on, or `at_s` later; or a link to this service, or its pace."""
        number = self._clock.timeline.number
        try:
            fault = one_fault(request.arguments.get("fault"))
            if not problem(fault) and row_of(fault).group in ("transport", "process"):
                return self._faults.answer(request, number)
            if what := problem(fault) or _not_now(fault) or self._device.refuses((fault,)):
                raise ValueError(what)
        except ValueError as error:
            return request.refuse(str(error))
        acting, waiting = self._device.faults()
        if len(acting) + len(waiting) >= MOST_FAULTS:
            return request.refuse(f"{MOST_FAULTS} faults act or wait already: end them first (`hydrohil inject --clear`)")
        self._device.inject(fault)
        return request.reply({"number": number + ticks_of(fault, self._clock.period_ns)[0] + 1})

    def _clear(self, request: Request) -> None:
        """End what was injected by hand; a trial's own faults end with it."""
        self._device.clear()
        self._faults.clear()
        request.reply({})

    def _status(self, request: Request) -> None:
        acting, waiting = self._device.faults()
        request.reply(
            self._own_status()
            | self._keeper.status()
            | self._codes()
            | {
                "pid": os.getpid(),
                "injected": self._faults.acting(),
                "faults": {
                    "acting": [fault._asdict() for fault in acting],
                    "waiting": [fault._asdict() for fault in waiting],
                },
                "experiment": self._bus.run.experiment.hex(),
                "run": self._bus.run.run,
            }
        )


def _not_now(fault: Fault) -> str:
    return "" if fault.at_s >= 0.0 else f"begins {fault.at_s:g} s from now, expected 0 or later"
