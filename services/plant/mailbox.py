"""The newest valid permit and command, with their ages by this plant's ledger."""

from hydrohil.services.plant.gate import NO_COMMAND_OBSERVATION, NO_PERMIT_OBSERVATION, CommandObservation, PermitObservation
from hydrohil.services.plant.ledger import Ledger
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_COMMAND
from hydrohil.shared.transport.bus import Run, same_run


class Mailbox:
    """The messages that the gate judges by; a frame of another run or experiment is refused."""

    def __init__(self, ledger: Ledger) -> None:
        """Empty."""
        self._ledger = ledger
        self.permit: Received | None = None
        self.command: Received | None = None

    def take_permit(self, message: Received, run: Run) -> bool:
        """Hold a permit if it is of this run; returns whether it is."""
        taken = same_run(message.header, run)
        if taken:
            self.permit = message
        return taken

    def take_command(self, message: Received, run: Run) -> bool:
        """Hold a command if it is of this run; returns whether it is."""
        taken = same_run(message.header, run)
        if taken:
            self.command = message
        return taken

    @property
    def arming_id(self) -> int:
        """Arming id of the permit held, 0 without one."""
        return self.permit.header.arming_id if self.permit is not None else 0

    @property
    def answered(self) -> int:
        """Number of the sample that the command held answers."""
        return self.command.header.echo_number if self.command is not None else NO_COMMAND

    @property
    def judged(self) -> int:
        """Number of the sample that the permit held was judged on."""
        return self.permit.header.echo_number if self.permit is not None else NO_COMMAND

    def observe_permit(self, now_ns: int) -> PermitObservation:
        """The permit held, with its age at `now_ns`, for the gate."""
        if self.permit is None:
            return NO_PERMIT_OBSERVATION
        header, body = self.permit.header, self.permit.body
        age_ns = self._ledger.age(header.echo_number, header.echo_time_ns, now_ns)
        return PermitObservation(
            present=True,
            arming_id=header.arming_id,
            epoch=header.epoch,
            mode=body.mode,
            age_ns=age_ns,
            recover_signs=body.recover_signs,
        )

    def observe_command(self, now_ns: int) -> CommandObservation:
        """The command held, with its age at `now_ns`, for the gate."""
        if self.command is None:
            return NO_COMMAND_OBSERVATION
        header, body = self.command.header, self.command.body
        age_ns = self._ledger.age(header.echo_number, header.echo_time_ns, now_ns)
        return CommandObservation(
            present=True,
            arming_id=header.arming_id,
            epoch=header.epoch,
            age_ns=age_ns,
            number=header.echo_number,
            codes=body.dac_counts,
        )
