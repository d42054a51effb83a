"""A supervisor under fire: random samples, absence, links and requests; what its permits never say."""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from hydrohil.services.supervisor.modes import Event
from hydrohil.services.supervisor.observe import LinkHealth, SampleContext, observe_step
from hydrohil.services.supervisor.rules import first_broken
from hydrohil.services.supervisor.state import SupervisorMemory
from hydrohil.services.supervisor.step import supervisor_step
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL, GateCause, GateState, Mode, TripCause
from tests.support.supervisor_scene import BIAS, DURATION, LEVEL, LIMITS, PARAMS, asked, sample

PERMITTED = (Mode.ARMED, Mode.RUNNING, Mode.RECOVER)
QUIET = LinkHealth(0, 0, 0, 1)
BENT = (LEVEL[0], 20, *LEVEL[2:])  # link 2 past its limit
WRONG = st.sampled_from(
    [
        {"force_counts": 400},
        {"force_counts": 518},
        {"force_counts": -1},
        {"encoder_counts": BENT},
        {"gate": int(GateState.REVOKED), "gate_cause": int(GateCause.COMMAND_STALE)},
        {"gate": int(GateState.REVOKED), "gate_cause": int(GateCause.ESTOP)},
        {"command_number": 0},
    ]
)
LINKS = st.builds(LinkHealth, *[st.sampled_from([0, 1, 2, 8])] * 3, st.sampled_from([-40, 0, 1, 2, 40]))


class PermitUnderFire(RuleBasedStateMachine):
    """One step is one sample, or its absence."""

    @initialize()
    def boot(self):
        self.memory, self.before, self.permit = SupervisorMemory(), SupervisorMemory(), None
        self.number, self.drawn, self.used = 100, 1000, set()
        self.event, self.broken, self.unreleased = Event.NOTHING, 0, False

    def tick(self):
        """Tick of the sample in the trial that was announced."""
        row = self.number - self.memory.first_sample
        begun = self.memory.first_sample != NO_COMMAND and 0 <= row < BIAS + DURATION
        return row - BIAS if begun else NO_TRIAL

    def step(self, event=Event.NOTHING, *, steps=1, stale_ns=0, **changes):
        others = {name: changes.pop(name) for name in ("agreed", "controller_ready", "links") if name in changes}
        for _ in range(steps):
            self.number += not stale_ns
            self.drawn += 1
            current = sample(self.number, self.tick(), **changes)
            inputs = asked(event, new_arming_id=self.drawn, stale_ns=stale_ns, **others)
            running = self.memory.mode == Mode.RUNNING
            observed = observe_step(
                self.memory.observer,
                PARAMS.observer,
                current,
                SampleContext(running, stale_ns, inputs.controller_ready, inputs.links),
            )[1]
            self.broken, self.event, self.pressed = (
                first_broken(observed, LIMITS)[0],
                event,
                current.gate_cause == GateCause.ESTOP,
            )
            self.before = self.memory
            self.memory, self.permit = supervisor_step(self.memory, PARAMS, current, inputs)
            self.check()

    @rule(event=st.sampled_from(Event))
    def ask(self, event):
        self.step(event)

    @rule(steps=st.integers(1, 80))
    def samples_come(self, steps):
        self.step(steps=steps)

    @precondition(lambda self: self.memory.mode == Mode.DISARMED)
    @rule()
    def run(self):
        self.step(Event.ARM)
        self.step(Event.START)
        self.step(steps=PARAMS.lead_samples + BIAS + 3)

    @rule(event=st.sampled_from(Event), wrong=WRONG)
    def a_sample_says_what_must_not_be(self, event, wrong):
        self.step(event, **wrong)

    @rule(event=st.sampled_from(Event), links=LINKS)
    def links_show_faults(self, event, links):
        self.step(event, links=links)

    @rule(event=st.sampled_from(Event), agreed=st.booleans(), ready=st.booleans())
    def others_disagree(self, event, agreed, ready):
        self.step(event, agreed=agreed, controller_ready=ready)

    @rule(event=st.sampled_from(Event), stale_ns=st.sampled_from([1, LIMITS.lease_ns, LIMITS.lease_ns + 1]))
    def samples_stay_away(self, event, stale_ns):
        self.step(event, stale_ns=stale_ns)

    @rule(lost=st.sampled_from([1, 4, 5, 50, -60]))
    def samples_are_lost_or_go_back(self, lost):
        self.number = max(1, self.number + lost)
        self.step()

    def check(self):
        was, now = Mode(self.before.mode), Mode(self.memory.mode)
        if now in (Mode.ARMED, Mode.RUNNING):
            assert self.broken == 0
        if was == Mode.TRIPPED and now != Mode.TRIPPED:
            left = {Mode.DISARMED: Event.RESET, Mode.RECOVER: Event.HOLD_RECOVER}
            assert left[now] == self.event
            assert now != Mode.DISARMED or (self.broken == 0 and not self.pressed)
        if was == Mode.TRIPPED == now:
            latched = ("cause", "measured", "limit", "trip_number", "recover_signs")
            assert [getattr(self.memory, name) for name in latched] == [getattr(self.before, name) for name in latched]
        if self.event == Event.RESET:
            assert now not in PERMITTED or now == was != Mode.RECOVER  # a reset grants nothing
        if now == Mode.RUNNING:
            assert was in (Mode.ARMED, Mode.RUNNING) and self.memory.arming_id == self.before.arming_id
        if now == Mode.ARMED and was != Mode.ARMED:
            assert (was, self.event) == (Mode.DISARMED, Event.ARM)
        if self.memory.arming_id not in (0, self.before.arming_id):
            assert self.memory.arming_id not in self.used
            self.used.add(self.memory.arming_id)
        stopped = self.event == Event.ESTOP or self.pressed
        if stopped:
            assert now == Mode.TRIPPED
        assert not (now == Mode.RECOVER and self.unreleased)
        self.unreleased = stopped or (self.unreleased and self.event != Event.RESET)

    @invariant()
    def an_arming_exists_where_motion_may_be_permitted_and_nowhere_else(self):
        assert (self.memory.arming_id != 0) == (self.memory.mode in PERMITTED)

    @invariant()
    def the_permit_says_what_the_supervisor_holds(self):
        if self.permit is not None:
            assert self.permit[:5] == (
                self.memory.mode,
                self.memory.cause,
                self.memory.measured,
                self.memory.limit,
                self.memory.trip_number,
            )
            assert self.permit.recover_signs == (0, 0, 0) or self.memory.mode == Mode.RECOVER

    @invariant()
    def a_trip_has_a_cause_and_what_is_disarmed_has_none(self):
        mode = self.memory.mode
        if mode in (Mode.TRIPPED, Mode.RECOVER):
            assert self.memory.cause in set(TripCause) - {TripCause.NONE}
        else:
            assert self.memory.cause == 0
        assert mode == Mode.RUNNING or self.memory.first_sample == NO_COMMAND


PermitUnderFire.TestCase.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)
TestPermitUnderFire = PermitUnderFire.TestCase
