"""The newest valid permit and command, with their ages by this plant's ledger."""

from hydrohil.services.plant.gate import NO_COMMAND_SEEN, NO_PERMIT_SEEN, CommandSeen, PermitSeen
from hydrohil.services.plant.ledger import Ledger
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_COMMAND
from hydrohil.shared.transport.bus import Run, same_run


class Mailbox:
    """What the gate judges by; a frame of another run or experiment is not taken."""

    def __init__(self, ledger: Ledger) -> None:
        """Empty."""
        self._ledger = ledger
        self.permit: Received | None = None
        self.command: Received | None = None

    def take_permit(self, message: Received, run: Run) -> bool:
        """Hold a permit of this run."""
        taken = same_run(message.header, run)
        if taken:
            self.permit = message
        return taken

    def take_command(self, message: Received, run: Run) -> bool:
        """Hold a command of this run."""
        taken = same_run(message.header, run)
        if taken:
            self.command = message
        return taken

    @property
    def arming(self) -> int:
        """Arming number of the permit held, 0 without one."""
        return self.permit.header.arming if self.permit is not None else 0

    @property
    def answered(self) -> int:
        """Number of the sample that the command held answers."""
        return self.command.header.echo_number if self.command is not None else NO_COMMAND

    @property
    def judged(self) -> int:
        """Number of the sample that the permit held was judged on."""
        return self.permit.header.echo_number if self.permit is not None else NO_COMMAND

    def permit_seen(self, now_ns: int) -> PermitSeen:
        """The permit as the gate sees it now."""
        if self.permit is None:
            return NO_PERMIT_SEEN
        header, body = self.permit.header, self.permit.body
        age_ns = self._ledger.age(header.echo_number, header.echo_time_ns, now_ns)
        return PermitSeen(True, header.arming, header.epoch, body.mode, age_ns, body.recover_signs)

    def command_seen(self, now_ns: int) -> CommandSeen:
        """The command as the gate sees it now."""
        if self.command is None:
            return NO_COMMAND_SEEN
        header, body = self.command.header, self.command.body
        age_ns = self._ledger.age(header.echo_number, header.echo_time_ns, now_ns)
        return CommandSeen(True, header.arming, header.epoch, age_ns, header.echo_number, body.dac_counts)
