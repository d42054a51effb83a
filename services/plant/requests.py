"""What an operator may ask of the plant. Loading has two phases; nothing here can open the gate."""

import gc
import os
from typing import TYPE_CHECKING, Any

from hydrohil.services.plant.config import PlantConfig
from hydrohil.services.plant.plant_description import describe
from hydrohil.services.plant.trial import Schedule
from hydrohil.shared.contract.envelope import one_fault, section, unseal
from hydrohil.shared.contract.faults import MOST_FAULTS, Fault, problem, row_of, ticks_of
from hydrohil.shared.contract.messages import NO_TRIAL, GateCause
from hydrohil.shared.host.realtime import set_scheduling, without_realtime
from hydrohil.shared.transport.bus import Run
from hydrohil.shared.transport.link_stats import told
from hydrohil.shared.transport.requests import Request
from hydrohil.shared.units import SUBSTEP_NS

if TYPE_CHECKING:
    from hydrohil.services.plant.service import Plant


def answer(plant: "Plant", request: Request) -> None:
    """Answer one request."""
    known = {
        "load": _load,
        "commit": _commit,
        "estop": _estop,
        "reset": _reset,
        "inject": _inject,
        "clear": _clear,
        "status": _status,
    }
    handler = known.get(request.verb)
    if handler is None:
        request.refuse(f"the plant knows no request {request.verb!r}; it knows {', '.join(known)}")
    else:
        handler(plant, request)


def _armed(plant: "Plant") -> bool:
    """Whether the gate is bound, or a permit that is not stale carries an arming; that of a supervisor that died binds nobody."""
    if plant.keeper.gate.arming_id != 0:
        return True
    permit = plant.keeper.mailbox.observe_permit(plant.now_ns())
    return permit.arming_id != 0 and 0 <= permit.age_ns <= plant.keeper.limits.permit_ttl_ns


def _load(plant: "Plant", request: Request) -> None:
    if _armed(plant):
        return request.refuse("a trial is armed or running: stop it first (`hydrohil stop`)")
    try:
        with without_realtime():
            envelope = unseal(str(request.arguments.get("envelope")))
            schedule = Schedule(section(envelope, "plant", PlantConfig), envelope)
        describe(schedule.config, plant.keeper.limits)
        plant.faults.loaded(envelope)
        if refused := plant.device.refuses(schedule.faults):
            raise ValueError(refused)
    except ValueError as error:
        return request.refuse(str(error))
    plant.pending = schedule
    return request.reply({"digest": envelope.digest.hex()})


def _commit(plant: "Plant", request: Request) -> None:
    schedule = plant.pending
    if schedule is None or schedule.envelope is None or schedule.envelope.digest.hex() != request.arguments.get("digest"):
        return request.refuse("nothing with this hash was loaded: load it first")
    if _armed(plant):
        return request.refuse("a trial is armed or running: stop it first (`hydrohil stop`)")
    envelope = schedule.envelope
    try:
        conditions = plant.faults.loaded(envelope)  # once more: faults may have been injected since the load
    except ValueError as error:
        return request.refuse(str(error))
    with without_realtime():  # the noise of ten minutes at 1 kHz takes a tenth of a second
        plant.device.load(schedule.config, envelope.seed, schedule.first_tick, schedule.ticks, schedule.faults)
    plant.schedule = schedule
    plant.timeline.tick = NO_TRIAL  # nobody answers a sample of the trial before: in lockstep one may be waiting for that
    plant.bus.run = Run(envelope.run, envelope.digest, 0)
    plant.bus.impair(conditions)
    plant.bus.waits_for_room = schedule.lockstep
    set_scheduling(envelope.clock)
    gc.collect()
    plant.grid.restart_at(plant.due)
    plant.publish_description()
    return request.reply({"digest": envelope.digest.hex()})


def _estop(plant: "Plant", request: Request) -> None:
    plant.keeper.estop = True
    plant.keeper.judge(plant.now_ns(), at_latch=False)
    request.reply(_codes(plant))


def _codes(plant: "Plant") -> dict[str, Any]:
    """What the gate gives, and what drives the valves; null where the device cannot read that."""
    driven = plant.device.readback()
    return {"dac_counts": list(plant.keeper.gate.codes), "dac_readback": None if driven is None else list(driven)}


def _reset(plant: "Plant", request: Request) -> None:
    plant.keeper.estop = False
    plant.keeper.judge(plant.now_ns(), at_latch=False)
    request.reply({})


def _inject(plant: "Plant", request: Request) -> None:
    """Break the machine from the next sample on, or `at_s` later; or the ways to this service, or its pace."""
    try:
        fault = one_fault(request.arguments.get("fault"))
        if not problem(fault) and row_of(fault).group in ("transport", "process"):
            return plant.faults.answer(request, plant.timeline.number)
        if what := problem(fault) or _not_now(fault) or plant.device.refuses((fault,)):
            raise ValueError(what)
    except ValueError as error:
        return request.refuse(str(error))
    acting, waiting = plant.device.faults()
    if len(acting) + len(waiting) >= MOST_FAULTS:
        return request.refuse(f"{MOST_FAULTS} faults act or wait already: end them first (`hydrohil inject --clear`)")
    plant.device.inject(fault)
    return request.reply({"number": plant.timeline.number + ticks_of(fault, plant.schedule.period * SUBSTEP_NS)[0] + 1})


def _not_now(fault: Fault) -> str:
    return "" if fault.at_s >= 0.0 else f"begins {fault.at_s:g} s from now, expected 0 or later"


def _clear(plant: "Plant", request: Request) -> None:
    """End what was injected by hand; a trial's own faults end with it."""
    plant.device.clear()
    plant.faults.clear()
    request.reply({})


def _status(plant: "Plant", request: Request) -> None:
    keeper = plant.keeper
    values: dict[str, Any] = plant.status()
    request.reply(
        values
        | {
            "pid": os.getpid(),
            "gate": keeper.gate.state,
            "gate_cause": GateCause(keeper.gate.cause).name,
            **_codes(plant),
            "last_cut": GateCause(keeper.last_cut).name,
            "last_cut_ns": keeper.last_cut_ns,
            "last_cut_clock_ns": keeper.last_cut_clock_ns,
            "revoked_arming_ids": len(keeper.revoked),
            "estop": keeper.estop,
            "injected": plant.faults.acting(),
            "faults": {
                name: [fault._asdict() for fault in found]
                for name, found in zip(("acting", "waiting"), plant.device.faults(), strict=True)
            },
            "experiment": plant.bus.run.experiment.hex(),
            "run": plant.bus.run.run,
            "link_stats": told((keeper.commands, keeper.permits)),
        }
    )
