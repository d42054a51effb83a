"""Rows 8 to 16: what happens to messages, and to whoever shares the host."""

from functools import partial

from hydrohil.faulttest.loads import hogged, strangers
from hydrohil.faulttest.lockstep import T_S, borne, burst, delayed, lease_and_period, live, lossy, on, stopped, unheard
from hydrohil.faulttest.processes import frozen
from hydrohil.faulttest.trial import Lived, Proved, Row, Untried
from hydrohil.shared.contract.faults import CUTS, PATHS

STEPPED = "lockstep: "
LEASE_T = "lease + T"
UNTIL_100_S = 100 * T_S
UNHEARD = ("controller>supervisor", "controller-supervisor")  # permit and command still come: only the supervisor acts


def _partition(target: str) -> Lived:
    bound = unheard if target in UNHEARD else lease_and_period
    return Lived(f"{STEPPED}{target}", partial(stopped, faults=on("partition", target), bound=bound), letter="L", most=2)


def _live(target: str) -> Lived:
    return Lived(f"{target}, on the wall clock", partial(live, target=target))


def _lossy(share: float) -> Lived:
    words = f"{STEPPED}{100 * share:g} % of the commands"
    return Lived(words, partial(lossy, share=share), letter="L", most=5)


WIRE = (
    Row(
        "8",
        "partition, one way and both",
        "safe without command or permit; nothing resumes",
        "lease + T; lease + 3 T where only the supervisor misses the controller",
        (
            *map(_partition, (*PATHS, *CUTS)),
            *map(_live, ("controller>plant", "supervisor>plant", "plant-controller")),
            Proved(
                "a link cut for real, its packets dropped by the kernel",
                (
                    "tests/live/test_namespaces.py::test_a_link_that_is_cut_for_real_leaves_the_valves_at_zero_and_nothing_resumes",
                    "tests/live/test_namespaces.py::test_a_plant_whose_links_to_all_services_are_cut_still_answers_its_operator",
                ),
                letter="W",
            ),
            Proved(
                "services on hosts of their own (network namespaces), a cable pulled",
                ("tests/live/test_hosts.py::test_a_host_whose_cable_is_pulled_leaves_the_valves_at_zero_and_nothing_resumes",),
                letter="W",
            ),
        ),
    ),
    Row(
        "9",
        "random loss of 1, 5, 20 %",
        "runs on until a run of losses that the lease does not bear, or too few of the last 100 answered in time",
        "exact",
        (*map(_lossy, (0.01, 0.05, 0.2)),),
    ),
    Row(
        "10",
        "burst loss",
        "up to the lease the last command holds; one more is safe",
        "exact",
        (
            Lived(f"{STEPPED}as many as the lease bears", partial(borne, faults=burst(0)), letter="L", most=3),
            Lived(
                f"{STEPPED}one more", partial(stopped, faults=burst(1), bound=lambda lease_s: lease_s + T_S), letter="L", most=3
            ),
        ),
    ),
    Row(
        "11",
        "duplicate, replayed, reordered, of an older epoch",
        "discarded and counted",
        "0 effect",
        (
            Lived(
                f"{STEPPED}one duplicate",
                partial(borne, faults=on("duplicate", "controller>plant", 1.0, T_S)),
                letter="L",
                most=2,
            ),
            Proved(
                "only what is newer is taken; an epoch once left never returns",
                (
                    "tests/shared/transport/test_acceptance.py::test_what_is_taken_is_increasing_within_an_epoch_and_no_epoch_returns",
                    "tests/shared/transport/test_acceptance.py::test_a_sender_that_starts_anew_is_taken_and_its_old_epoch_never_again",
                ),
            ),
        ),
    ),
    Row(
        "12",
        "corrupted bits",
        "discarded and counted; more than one a second of a bound sender: safe",
        "T after the second that still names its sender; at most lease + T",
        (
            Lived(
                f"{STEPPED}every command corrupt",
                partial(stopped, faults=on("corrupt", "controller>plant", 1.0), bound=lease_and_period),
                letter="L",
                most=2,
            ),
            Proved(
                "every flipped bit is found; one a second is survived, a second one cuts and revokes",
                (
                    "tests/shared/contract/test_codec.py::test_every_flipped_bit_of_a_frame_is_a_checksum_error",
                    "tests/plant/test_gatekeeper.py::test_one_corrupt_frame_a_second_is_survived_and_a_second_one_cuts_and_burns",
                ),
            ),
        ),
    ),
    Row(
        "13",
        "foreign, malformed, oversized, random, 10,000 a second; two publishers",
        "discarded and counted, never stops a cell; a second sender under a bound identity: safe",
        "0 / T",
        (
            Lived("foreign commands, as many as one process can send, up to 10,000 a second", strangers),
            Proved(
                "no bytes raise, strangers stop nobody, two senders shut the gate",
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
        "14",
        "delay and jitter",
        "what is older than the lease is unusable",
        "lease",
        (
            Lived(f"{STEPPED}a delay that is over before the latch", partial(borne, faults=delayed(0.1)), letter="L", most=2),
            Lived(
                f"{STEPPED}half a lease: too few answers in time",
                partial(stopped, faults=delayed(0.5), bound=lambda _lease_s: UNTIL_100_S),
                letter="L",
                most=2,
            ),
            Lived(
                f"{STEPPED}a delay of more than a lease",
                partial(stopped, faults=delayed(1.1), bound=lease_and_period),
                letter="L",
                most=2,
            ),
        ),
    ),
    Row(
        "15",
        "wall clock stepped; process suspended",
        "no effect; safe on waking",
        "0 / T after waking",
        (
            Proved(
                "no service of the loop reads the wall clock", ("tests/test_architecture.py::test_the_loop_reads_no_wall_clock",)
            ),
            Untried("the clock of this machine is not set: others live by it"),
            Lived(
                "a process suspended and woken (the controller; others in rows 4 and 5b)",
                partial(frozen, service="controller"),
                most=5,
            ),
        ),
    ),
    Row(
        "16",
        "overruns, CPU hogs, memory pressure",
        "counted; the lease decides; true time is used",
        "lease",
        (
            Lived("twice as many hogs as processors", hogged),
            Proved(
                "a gap is integrated with its true time",
                ("tests/controller/test_step.py::test_a_gap_while_running_is_integrated_with_the_true_time_between_samples",),
            ),
            Untried(
                "memory pressure: a shared machine is not driven out of memory; services lock theirs where the host grants it"
            ),
        ),
    ),
)
