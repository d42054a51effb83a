"""Random loss against the lease: how many trials end safe is what the closed formula says, without a process."""

import math

import pytest

from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.gate import GateInput, GateMemory, gate_step
from hydrohil.services.plant.ledger import Ledger
from hydrohil.services.plant.mailbox import Mailbox
from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import Command, GateState
from hydrohil.shared.contract.topics import BY_KEY
from hydrohil.shared.transport.bus import Run
from hydrohil.shared.transport.impairment import on_path, outcome, route_of
from tests.support.wire_scene import ZERO, header, permit_body

PERIOD_NS, LATCH_NS, LEASE_NS = 4_500_000, 3_600_000, 20_000_000
BRIDGED = (LEASE_NS - LATCH_NS) // PERIOD_NS  # losses in a row for which the last command is fresh: 3
TICKS = 100
TRIALS = 150


def survives(probability: float, trial: int) -> bool:
    """A trial of mailbox and gate in which each command is lost by the fault's own draws."""
    lossy = on_path("controller>plant", (Fault("loss", "controller>plant", value=probability),), PERIOD_NS)
    route = route_of(BY_KEY["controller/command"], "plant", trial, 90, {"controller>plant": lossy})
    ledger = Ledger()
    mailbox, gate = Mailbox(ledger), GateMemory()
    limits = GateLimits(permit_ttl_ns=LEASE_NS, command_ttl_ns=LEASE_NS)
    for tick in range(-1, TICKS):  # the command of tick -1 is there: before tick 0 no fault acts
        time_ns = (tick + 1) * PERIOD_NS
        ledger.issue(tick + 1, time_ns, time_ns)
        head = header("controller/command", tick + 1, echo_number=tick + 1, echo_time_ns=time_ns)
        mailbox.take_permit(Received(0, "", header("supervisor/permit", **_echo(head)), permit_body()), Run())
        if not outcome(route, tick).lost:
            mailbox.take_command(Received(0, "", head, Command(ZERO)), Run())
        now_ns = time_ns + LATCH_NS
        observed = GateInput(
            permit=mailbox.observe_permit(now_ns),
            command=mailbox.observe_command(now_ns),
            force_counts=10,
            force_n=13.0,
            tick=max(0, tick),
            estop=False,
            overrun=False,
            link_faults=0,
            epoch_conflicts=0,
        )
        gate = gate_step(gate, limits, observed, True)
    return gate.state == GateState.OPEN


def _echo(head):
    return {"echo_number": head.echo_number, "echo_time_ns": head.echo_time_ns}


def predicted(probability: float, messages: int) -> float:
    """P(no run of k = BRIDGED + 1 losses in n messages):  s(n) = s(n-1) - (1-p) p^k s(n-k-1),  s(k) = 1 - p^k,  s(<k) = 1."""
    run, lost = BRIDGED + 1, probability ** (BRIDGED + 1)
    stays = [1.0] * run + [1.0 - lost]
    while len(stays) <= messages:
        stays.append(stays[-1] - (1.0 - probability) * lost * stays[-1 - run])
    return stays[messages]


def test_the_formula_counts_every_pattern_of_a_short_trial():
    probability, run = 0.3, BRIDGED + 1
    total = sum(
        probability ** bits.bit_count() * (1 - probability) ** (8 - bits.bit_count())
        for bits in range(256)
        if "1" * run not in f"{bits:08b}"
    )
    assert math.isclose(predicted(probability, 8), total)


@pytest.mark.parametrize("probability", [0.01, 0.05, 0.2, 0.4])
def test_as_many_trials_survive_a_random_loss_as_runs_of_losses_predict(probability):
    expected = predicted(probability, TICKS)
    share = sum(survives(probability, trial) for trial in range(TRIALS)) / TRIALS
    assert abs(share - expected) <= 4.0 * math.sqrt(expected * (1.0 - expected) / TRIALS) + 1.0 / TRIALS
