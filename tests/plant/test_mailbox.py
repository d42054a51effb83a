from hydrohil.services.plant.gate import NO_COMMAND_OBSERVATION, NO_PERMIT_OBSERVATION
from hydrohil.services.plant.ledger import IMPOSSIBLE, Ledger
from hydrohil.services.plant.mailbox import Mailbox
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_COMMAND, Mode
from hydrohil.shared.transport.bus import Run
from tests.support.wire_scene import ZERO, command_body, header, permit_body

RUN = Run(5, b"hash")
OURS = {"run": 5, "experiment": b"hash", "echo_number": 3, "echo_time_ns": 300}


def received(key, body, **changes):
    return Received(0, key, header(key, **(OURS | changes)), body)


def permit(**changes):
    return received("supervisor/permit", permit_body(recover_signs=(0, -1, 0)), **changes)


def command(**changes):
    return received("controller/command", command_body((2100, 2048, 2048)), **changes)


def mailbox():
    ledger = Ledger()
    ledger.issue(3, 300, 1000)
    return Mailbox(ledger)


def test_an_empty_mailbox_shows_nothing():
    empty = mailbox()
    assert (empty.observe_permit(1), empty.observe_command(1)) == (NO_PERMIT_OBSERVATION, NO_COMMAND_OBSERVATION)
    assert (empty.arming_id, empty.answered, empty.judged) == (0, NO_COMMAND, NO_COMMAND)


def test_what_is_held_is_shown_with_its_age_by_the_ledger():
    box = mailbox()
    assert box.take_permit(permit(), RUN)
    assert box.take_command(command(), RUN)
    assert box.observe_permit(1500) == (True, 77, 11, int(Mode.RUNNING), 500, (0, -1, 0))
    assert box.observe_command(1700) == (True, 77, 22, 700, 3, (2100, 2048, 2048))
    assert (box.arming_id, box.answered, box.judged) == (77, 3, 3)


def test_a_fresh_packet_with_an_old_or_forged_echo_is_as_old_as_its_echo():
    box = mailbox()
    box.take_permit(permit(echo_time_ns=301), RUN)
    box.take_command(command(echo_number=4), RUN)
    assert (box.observe_permit(1500).age_ns, box.observe_command(1500).age_ns) == (IMPOSSIBLE, IMPOSSIBLE)


def test_a_frame_of_another_run_or_experiment_is_not_taken():
    box = mailbox()
    assert not box.take_permit(permit(run=6), RUN)
    assert not box.take_command(command(experiment=b"other"), RUN)
    assert (box.permit, box.command) == (None, None)
    box.take_command(command(), RUN)
    assert not box.take_command(received("controller/command", command_body(ZERO), run=6), RUN)
    assert box.observe_command(1500).codes == (2100, 2048, 2048)
