"""Rows 1 to 7: processes that die, freeze or fall silent."""

from functools import partial
from signal import SIGKILL, SIGSTOP

from hydrohil.faulttest.loads import recorder_struck
from hydrohil.faulttest.processes import frozen, killed, plant_frozen, plant_killed
from hydrohil.faulttest.routed import mesh_runs_on, router_struck
from hydrohil.faulttest.trial import Lived, Proved, Row

LEASE_T = "lease + T"
PROCESSES = (
    Row(
        "1",
        "controller killed",
        "safe; the controller is named",
        LEASE_T,
        (Lived("SIGKILL, started again, watched", partial(killed, service="controller")),),
    ),
    Row(
        "2",
        "controller frozen, thawed",
        "safe; its old commands are refused",
        LEASE_T,
        (Lived("SIGSTOP, SIGCONT, watched", partial(frozen, service="controller")),),
    ),
    Row(
        "3",
        "controller repeats a command, or its sample number stands still",
        "safe",
        LEASE_T,
        (
            Proved(
                "ages are those of the echo; a lag trips",
                (
                    "tests/plant/test_gatekeeper.py::test_a_fresh_frame_does_not_refresh_an_old_judgement",
                    "tests/plant/test_mailbox.py::test_a_fresh_packet_with_an_old_or_forged_echo_is_as_old_as_its_echo",
                    "tests/supervisor/test_step.py::test_a_controller_that_does_not_advance_trips",
                ),
            ),
        ),
    ),
    Row(
        "4",
        "supervisor killed or frozen",
        "safe by the lease alone",
        LEASE_T,
        (
            Lived("SIGKILL, started again, watched", partial(killed, service="supervisor")),
            Lived("SIGSTOP, SIGCONT, watched", partial(frozen, service="supervisor")),
        ),
    ),
    Row(
        "5",
        "plant killed",
        "the supervisor trips; nothing resumes when the plant returns",
        LEASE_T,
        (Lived("SIGKILL, started again, watched", plant_killed),),
    ),
    Row(
        "5b",
        "plant frozen, thawed",
        "D/A to zero by its own watchdog; arming revoked on waking",
        "lease, of simulated time",
        (
            Lived("SIGSTOP, SIGCONT; judged by its first words", plant_frozen),
            Proved(
                "the D/A's watchdog",
                (
                    "tests/plant/test_emulator.py::test_a_converter_that_is_not_written_goes_to_zero_by_itself_at_the_end_of_the_lease",
                ),
            ),
        ),
    ),
    Row(
        "6",
        "recorder killed, frozen, its disk full, its viewer hung",
        "nothing: the same control timing",
        "0",
        (
            Lived("SIGKILL while it records", partial(recorder_struck, how="killed")),
            Lived("SIGSTOP while it records", partial(recorder_struck, how="frozen")),
            Lived("its file may not grow", partial(recorder_struck, how="full")),
            Proved(
                "a viewer that hangs",
                ("tests/recorder/test_live.py::test_a_viewer_that_hangs_costs_the_oldest_rows_and_no_waiting",),
            ),
        ),
    ),
    Row(
        "7",
        "Zenoh router killed or frozen",
        "a routed cell becomes safe; a mesh runs on",
        "lease + T / 0",
        (
            Lived("SIGKILL of a routed cell's router, which returns", partial(router_struck, how=SIGKILL), whole=False),
            Lived("SIGSTOP, SIGCONT", partial(router_struck, how=SIGSTOP), whole=False),
            Lived("SIGKILL of a router beside a mesh", mesh_runs_on, most=1),  # nothing connects them: one trial shows it
        ),
    ),
)
