"""Rows 1 to 7: processes that die, freeze or fall silent."""

from functools import partial
from signal import SIGKILL, SIGSTOP

from hydrohil.faulttest.loads import recorder_fault
from hydrohil.faulttest.processes import frozen, killed, plant_frozen, plant_killed
from hydrohil.faulttest.router import mesh_runs_on, router_fault
from hydrohil.faulttest.trial import ByTests, Live, Row

LEASE_T = "lease + T"
PROCESSES = (
    Row(
        number="1",
        fault="controller killed",
        must="safe; the controller is named",
        bound=LEASE_T,
        ways=(Live("SIGKILL, started again, watched", partial(killed, service="controller")),),
    ),
    Row(
        number="2",
        fault="controller frozen, thawed",
        must="safe; its old commands are refused",
        bound=LEASE_T,
        ways=(Live("SIGSTOP, SIGCONT, watched", partial(frozen, service="controller")),),
    ),
    Row(
        number="3",
        fault="controller repeats a command, or its sample number stands still",
        must="safe",
        bound=LEASE_T,
        ways=(
            ByTests(
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
        number="4",
        fault="supervisor killed or frozen",
        must="safe by the lease alone",
        bound=LEASE_T,
        ways=(
            Live("SIGKILL, started again, watched", partial(killed, service="supervisor")),
            Live("SIGSTOP, SIGCONT, watched", partial(frozen, service="supervisor")),
        ),
    ),
    Row(
        number="5",
        fault="plant killed",
        must="the supervisor trips; nothing resumes when the plant returns",
        bound=LEASE_T,
        ways=(Live("SIGKILL, started again, watched", plant_killed),),
    ),
    Row(
        number="5b",
        fault="plant frozen, thawed",
        must="D/A to zero by its own watchdog; arming revoked on waking",
        bound="lease, of simulated time",
        ways=(
            Live("SIGSTOP, SIGCONT; judged by its first words", plant_frozen),
            ByTests(
                "the D/A's watchdog",
                (
                    "tests/plant/test_emulator.py::test_a_converter_that_is_not_written_goes_to_zero_by_itself_at_the_end_of_the_lease",
                ),
            ),
        ),
    ),
    Row(
        number="6",
        fault="recorder killed, frozen, its disk full, its viewer hung",
        must="nothing: the same control timing",
        bound="0",
        ways=(
            Live("SIGKILL while it records", partial(recorder_fault, how="killed")),
            Live("SIGSTOP while it records", partial(recorder_fault, how="frozen")),
            Live("its file may not grow", partial(recorder_fault, how="full")),
            ByTests(
                "a viewer that hangs",
                ("tests/recorder/test_live.py::test_a_viewer_that_hangs_costs_the_oldest_rows_and_no_waiting",),
            ),
        ),
    ),
    Row(
        number="7",
        fault="Zenoh router killed or frozen",
        must="a routed cell becomes safe; a mesh runs on",
        bound="lease + T / 0",
        ways=(
            Live("SIGKILL of a routed cell's router, which returns", partial(router_fault, how=SIGKILL), in_shared_cell=False),
            Live("SIGSTOP, SIGCONT", partial(router_fault, how=SIGSTOP), in_shared_cell=False),
            Live("SIGKILL of a router beside a mesh", mesh_runs_on, max_trials=1),  # no link connects them, so one trial suffices
        ),
    ),
)
