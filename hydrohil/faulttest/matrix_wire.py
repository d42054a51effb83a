"""Rows 8 to 16: faults of messages, and other load on the host."""

from functools import partial

from hydrohil.faulttest.loads import foreign_frames, hogged
from hydrohil.faulttest.lockstep import (
    T_S,
    burst,
    delayed,
    lease_and_period,
    live,
    lossy,
    on,
    stopped,
    tolerated,
    without_the_controller,
)
from hydrohil.faulttest.processes import frozen
from hydrohil.faulttest.trial import ByTests, Live, NotTried, Row
from hydrohil.shared.contract.faults import CUTS, PATHS

STEPPED = "lockstep: "
LEASE_T = "lease + T"
UNTIL_100_S = 100 * T_S
# permit and command still arrive: only the supervisor acts
WITHOUT_CONTROLLER = ("controller>supervisor", "controller-supervisor")


def _partition(target: str) -> Live:
    bound = without_the_controller if target in WITHOUT_CONTROLLER else lease_and_period
    return Live(f"{STEPPED}{target}", partial(stopped, faults=on("partition", target), bound=bound), letter="L", max_trials=2)


def _live(target: str) -> Live:
    return Live(f"{target}, on the wall clock", partial(live, target=target))


def _lossy(share: float) -> Live:
    words = f"{STEPPED}{100 * share:g} % of the commands"
    return Live(words, partial(lossy, share=share), letter="L", max_trials=5)


WIRE = (
    Row(
        number="8",
        fault="partition, one way and both",
        must="safe without command or permit; nothing resumes",
        bound="lease + T; lease + 3 T where only the supervisor misses the controller",
        ways=(
            *map(_partition, (*PATHS, *CUTS)),
            *map(_live, ("controller>plant", "supervisor>plant", "plant-controller")),
            ByTests(
                "a link cut for real, its packets dropped by the kernel",
                (
                    "tests/live/test_namespaces.py::test_a_link_that_is_cut_for_real_leaves_the_valves_at_zero_and_nothing_resumes",
                    "tests/live/test_namespaces.py::test_a_plant_whose_links_to_all_services_are_cut_still_answers_its_operator",
                ),
                letter="W",
            ),
            ByTests(
                "services on hosts of their own (network namespaces), a cable pulled",
                ("tests/live/test_hosts.py::test_a_host_whose_cable_is_pulled_leaves_the_valves_at_zero_and_nothing_resumes",),
                letter="W",
            ),
        ),
    ),
    Row(
        number="9",
        fault="random loss of 1, 5, 20 %",
        must="runs on until a run of losses that is longer than the lease, or too few of the last 100 answered in time",
        bound="exact",
        ways=(*map(_lossy, (0.01, 0.05, 0.2)),),
    ),
    Row(
        number="10",
        fault="burst loss",
        must="up to the lease the last command holds; one more is safe",
        bound="exact",
        ways=(
            Live(f"{STEPPED}as many as the lease allows", partial(tolerated, faults=burst(0)), letter="L", max_trials=3),
            Live(
                f"{STEPPED}one more",
                partial(stopped, faults=burst(1), bound=lambda lease_s: lease_s + T_S),
                letter="L",
                max_trials=3,
            ),
        ),
    ),
    Row(
        number="11",
        fault="duplicate, replayed, reordered, of an older epoch",
        must="discarded and counted",
        bound="0 effect",
        ways=(
            Live(
                f"{STEPPED}one duplicate",
                partial(tolerated, faults=on("duplicate", "controller>plant", 1.0, T_S)),
                letter="L",
                max_trials=2,
            ),
            ByTests(
                "only what is newer is taken; an epoch once left never returns",
                (
                    "tests/shared/transport/test_acceptance.py::test_what_is_taken_is_increasing_within_an_epoch_and_no_epoch_returns",
                    "tests/shared/transport/test_acceptance.py::test_a_sender_that_starts_anew_is_taken_and_its_old_epoch_never_again",
                ),
            ),
        ),
    ),
    Row(
        number="12",
        fault="corrupted bits",
        must="discarded and counted; more than one a second of a bound sender: safe",
        bound="T after the second that still names its sender; at most lease + T",
        ways=(
            Live(
                f"{STEPPED}every command corrupt",
                partial(stopped, faults=on("corrupt", "controller>plant", 1.0), bound=lease_and_period),
                letter="L",
                max_trials=2,
            ),
            ByTests(
                "every flipped bit is found; one a second is survived, a second one cuts and revokes",
                (
                    "tests/shared/contract/test_codec.py::test_every_flipped_bit_of_a_frame_is_a_checksum_error",
                    "tests/plant/test_gatekeeper.py::test_one_corrupt_frame_a_second_is_survived_and_a_second_one_cuts_and_revokes",
                ),
            ),
        ),
    ),
    Row(
        number="13",
        fault="foreign, malformed, oversized, random, 10,000 a second; two publishers",
        must="discarded and counted, never stops a cell; a second sender under a bound identity: safe",
        bound="0 / T",
        ways=(
            Live("foreign commands, as many as one process can send, up to 10,000 a second", foreign_frames),
            ByTests(
                "no bytes raise, foreign frames stop no cell, two senders shut the gate",
                (
                    "tests/shared/contract/test_codec.py::test_no_bytes_make_the_decoder_raise",
                    "tests/shared/contract/test_codec.py::test_no_array_makes_the_decoder_raise",
                    "tests/shared/contract/test_codec.py::test_deep_nesting_and_false_lengths_are_rejected_without_an_exception",
                    "tests/plant/test_gatekeeper.py::test_strangers_never_stop_a_cell",
                    "tests/plant/test_gatekeeper.py::test_two_controllers_shut_the_gate_before_it_was_ever_open",
                ),
            ),
        ),
    ),
    Row(
        number="14",
        fault="delay and jitter",
        must="what is older than the lease is unusable",
        bound="lease",
        ways=(
            Live(
                f"{STEPPED}a delay shorter than the time to the latch",
                partial(tolerated, faults=delayed(0.1)),
                letter="L",
                max_trials=2,
            ),
            Live(
                f"{STEPPED}half a lease: too few answers in time",
                partial(stopped, faults=delayed(0.5), bound=lambda _lease_s: UNTIL_100_S),
                letter="L",
                max_trials=2,
            ),
            Live(
                f"{STEPPED}a delay of more than a lease",
                partial(stopped, faults=delayed(1.1), bound=lease_and_period),
                letter="L",
                max_trials=2,
            ),
        ),
    ),
    Row(
        number="15",
        fault="wall clock stepped; process suspended",
        must="no effect; safe on waking",
        bound="0 / T after waking",
        ways=(
            ByTests(
                "no service of the loop reads the wall clock", ("tests/test_architecture.py::test_the_loop_reads_no_wall_clock",)
            ),
            NotTried("the clock of this machine is not set: other programs depend on it"),
            Live(
                "a process suspended and woken (the controller; others in rows 4 and 5b)",
                partial(frozen, service="controller"),
                max_trials=5,
            ),
        ),
    ),
    Row(
        number="16",
        fault="overruns, CPU hogs, memory pressure",
        must="counted; the lease decides; true time is used",
        bound="lease",
        ways=(
            Live("twice as many hogs as processors", hogged),
            ByTests(
                "a gap is integrated with its true time",
                ("tests/controller/test_step.py::test_a_gap_while_running_is_integrated_with_the_true_time_between_samples",),
            ),
            NotTried(
                "memory pressure: a shared machine is not driven out of memory; services lock theirs where the host grants it"
            ),
        ),
    ),
)
