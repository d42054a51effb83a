"""What the supervisor's step takes and what it remembers: parameters of a trial, inputs of one step, memory."""

from typing import NamedTuple

from hydrohil.services.supervisor.modes import DISARMED
from hydrohil.services.supervisor.observe import LinkHealth, ObserverMemory, ObserverParams, observer_start
from hydrohil.services.supervisor.rule import Limits
from hydrohil.shared.contract.messages import NO_COMMAND

NO_SIGNS = (0, 0, 0)


class SupervisorParams(NamedTuple):
    """Everything that the supervisor knows before a trial."""

    limits: Limits
    observer: ObserverParams
    duration_ticks: int
    lead_samples: int  # from START to the trial's first sample, so that every service knows it in advance
    armed_samples: int  # ARMED unused for longer is disarmed
    recover_samples: int  # lease of a hold-to-run request


class SupervisorInput(NamedTuple):
    """What has come besides the sample."""

    event: int
    new_arming_id: int  # drawn for this step, used if it arms
    agreed: bool  # all services report this experiment, run and version, and the gate's limit stands above
    controller_ready: bool
    stale_ns: int  # 0 when a sample came; otherwise wall time since the last
    links: LinkHealth


class SupervisorMemory(NamedTuple):
    """State of the supervisor."""

    mode: int = DISARMED
    arming_id: int = 0
    cause: int = 0
    measured: float = 0.0  # what tripped
    limit: float = 0.0
    trip_number: int = NO_COMMAND
    first_sample: int = NO_COMMAND
    armed_at: int = 0
    held_until: int = 0
    recover_signs: tuple[int, int, int] = NO_SIGNS
    observer: ObserverMemory = observer_start()
    pressed: bool = False  # an emergency stop, here or at the gate, that no reset has released
