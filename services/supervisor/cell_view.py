"""What the supervisor knows of its cell: what plant and controller publish, what is loaded, what the host is qualified for."""

from collections.abc import Callable
from typing import Any, NamedTuple

from hydrohil.services.supervisor.config import SupervisorConfig
from hydrohil.services.supervisor.observe import LinkHealth
from hydrohil.services.supervisor.params import supervisor_params
from hydrohil.services.supervisor.prearm_checks import Declared, prearm_problem
from hydrohil.services.supervisor.state import SupervisorParams
from hydrohil.shared.contract.codec import Header, Received
from hydrohil.shared.contract.envelope import Envelope, section
from hydrohil.shared.contract.messages import NO_COMMAND, PlantDescription
from hydrohil.shared.host.qualified import Standing, beyond, plain
from hydrohil.shared.host.two_phase_load import Checked
from hydrohil.shared.machine.description import machine_id
from hydrohil.shared.transport.bus import Bus, same_run
from hydrohil.shared.transport.protection import worst


class Loaded(NamedTuple):
    """An experiment's section, and whether the operator allows a rate that this host is not qualified for."""

    config: SupervisorConfig
    unqualified: bool


class CellView:
    """Newest messages of plant and controller, and the loaded experiment; the supervisor's parameters follow from both."""

    def __init__(self, bus: Bus, qualification: Callable[[], Standing]) -> None:
        """Nothing has come and nothing is loaded. `qualification` reads what is on record of this host."""
        self._bus, self._qualification = bus, qualification
        self.samples, self.descriptions = bus.subscribe("plant/sample"), bus.subscribe("plant/description")
        self.states = bus.subscribe("controller/state")
        self.inboxes = (self.samples, self.states, self.descriptions)
        self.description: PlantDescription | None = None
        self.described: Header | None = None  # of the newest description
        self.machine_id = 0  # of the machine in it
        self.sample: Received | None = None
        self.controller: Received | None = None  # its newest state
        self.envelope: Envelope | None = None
        self.config = SupervisorConfig()
        self.unqualified = False  # the operator allows this run above the qualified rate
        self.qualification = qualification()
        self.params: SupervisorParams
        self._other_run = 0  # frames of another run at the last verdict

    @property
    def lockstep(self) -> bool:
        """Whether the loaded experiment waits for its answers instead of the wall clock."""
        return self.envelope is not None and self.envelope.clock == "lockstep"

    @property
    def complete(self) -> bool:
        """Whether plant and controller have both sent something."""
        return self.description is not None and self.sample is not None and self.controller is not None

    def receive(self) -> None:
        """Take the newest description and the newest state of the controller."""
        for message in self.descriptions.take():
            self.describe(message)
        for message in self.states.take():
            self.controller = message
            self.states.acceptance.other_run += not same_run(message.header, self._bus.run)

    def describe(self, message: Received) -> None:
        """Take the plant's description; a new one gives new parameters."""
        self.described = message.header
        if message.body != self.description:
            self.description = message.body
            self.machine_id = machine_id(message.body.machine_hash)
            self._prepare()

    def sampled(self, message: Received) -> None:
        """Note that a sample is about to be judged."""
        self.sample = message
        self.samples.acceptance.other_run += not same_run(message.header, self._bus.run)

    def check(self, envelope: Envelope, arguments: dict[str, Any]) -> Checked[Loaded]:
        """This service's section of a load; raises ValueError with one line."""
        config = section(envelope, "supervisor", SupervisorConfig)
        self.look_up_qualification()
        loaded = Loaded(config, unqualified=arguments.get("unqualified") is True)
        return Checked(loaded, {"qualification": plain(self.qualification)})

    def load(self, envelope: Envelope, loaded: Loaded) -> None:
        """Another experiment is loaded."""
        self.envelope, self.config, self.unqualified = envelope, loaded.config, loaded.unqualified
        self._prepare()

    def _prepare(self) -> None:
        if self.description is not None:
            tare, duration = (0, 0) if self.envelope is None else (self.envelope.tare_ticks, self.envelope.duration_ticks)
            self.params = supervisor_params(self.config, self.description, tare, duration)

    def look_up_qualification(self) -> None:
        """Read again what is on record of this host; only while nothing may move, because it reads a file."""
        self.qualification = self._qualification()

    def link_health(self, message: Received, now_ns: int) -> LinkHealth:
        """Faults of the links in the second before `now_ns`; frames of another run since the last call."""
        worst_link = worst(*(inbox.protection.observe(now_ns) for inbox in self.inboxes))
        other_run = sum(inbox.acceptance.other_run for inbox in self.inboxes)
        before, self._other_run = self._other_run, other_run
        answered = NO_COMMAND if self.controller is None else self.controller.header.echo_number
        return LinkHealth(
            faults=worst_link.faults,
            epoch_conflicts=worst_link.epoch_conflicts,
            other_run=other_run - before,
            state_lag=message.body.number - answered,
        )

    def prearm_problem(self, message: Received) -> str:
        """Why the services do not agree at this sample, "" if they do."""
        return prearm_problem(
            Declared(
                envelope=self.envelope,
                config=self.config,
                description=self.description,
                run=self._bus.run,
                plant=message.header,
                controller=None if self.controller is None else self.controller.header,
                described=self.described,
                machine_id=self.machine_id,
                driven_id=0 if self.controller is None else self.controller.body.machine_id,
                beyond_qualified=self._beyond_qualified(),
            )
        )

    def _beyond_qualified(self) -> str:
        """Why the loaded rate is above what this host is qualified for; "" where it is not, or the wall clock does not pace."""
        if self.description is None or self.lockstep or self.unqualified:
            return ""
        return beyond(self.qualification.qualified, self.description.sample_period_ns)
