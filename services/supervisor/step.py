"""One step of the supervisor: observe, judge, change mode, issue the permit. Verdict n is a function of sample n."""

from hydrohil.services.supervisor.mode_entry import Judgement, memory_in
from hydrohil.services.supervisor.modes import ARMED, ESTOP, HOLD_RECOVER, RECOVER, RESET, RUNNING, Facts, next_mode
from hydrohil.services.supervisor.observe import SampleContext, observe_step
from hydrohil.services.supervisor.recovery import can_recover
from hydrohil.services.supervisor.rules import first_broken
from hydrohil.services.supervisor.state import NO_SIGNS, SupervisorInput, SupervisorMemory, SupervisorParams
from hydrohil.shared.compiled.kernel import kernel
from hydrohil.shared.contract.messages import GateCause, Permit, Sample

_STOPPED_AT_GATE = int(GateCause.ESTOP)


@kernel
def supervisor_step(
    memory: SupervisorMemory, params: SupervisorParams, sample: Sample, inputs: SupervisorInput
) -> tuple[SupervisorMemory, Permit]:
    """Judge one sample (or its absence, when inputs.stale_ns > 0); returns the memory and the permit."""
    context = SampleContext(
        running=memory.mode == RUNNING, stale_ns=inputs.stale_ns, ready=inputs.controller_ready, links=inputs.links
    )
    observer, observed = observe_step(memory.observer, params.observer, sample, context)
    broken = first_broken(observed, params.limits)
    stopped_at_gate = sample.gate_cause == _STOPPED_AT_GATE  # a stop here and one at the gate: either alone suffices
    trial_samples = params.observer.tare_ticks + params.duration_ticks
    facts = Facts(
        broken=broken[0],
        estop=stopped_at_gate,
        may_arm=inputs.agreed,
        can_recover=can_recover(memory, params, observed, broken[0]),
        held=sample.number < memory.held_until or inputs.event == HOLD_RECOVER,
        finished=memory.mode == RUNNING and sample.number >= memory.first_sample + trial_samples,
        armed_too_long=memory.mode == ARMED and sample.number - memory.armed_at > params.armed_samples,
    )
    stopped = stopped_at_gate or inputs.event == ESTOP
    judgement = Judgement(
        number=sample.number,
        event=inputs.event,
        new_arming_id=inputs.new_arming_id,
        stopped=stopped,
        pressed=stopped or (memory.pressed and inputs.event != RESET),
        broken=broken,
        observed=observed,
        observer=observer,
    )
    memory = memory_in(next_mode(memory.mode, inputs.event, facts), memory, params, judgement)
    return memory, _permit(memory, params)


@kernel
def _permit(memory: SupervisorMemory, params: SupervisorParams) -> Permit:
    return Permit(
        mode=memory.mode,
        cause=memory.cause,
        measured=memory.measured,
        limit=memory.limit,
        trip_number=memory.trip_number,
        first_sample=memory.first_sample,
        duration_ticks=params.duration_ticks,
        tare_ticks=params.observer.tare_ticks,
        recover_signs=memory.recover_signs if memory.mode == RECOVER else NO_SIGNS,
        force_limit_n=params.limits.config.force_limit_n,
        force_bias_n=memory.observer.bias.mean_n,
    )
