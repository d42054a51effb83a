"""The loop's figures from what the samples and the services tell, and the trial that is made for a rate."""

import math

import pytest

from hydrohil.experiment.experiment import to_plain
from hydrohil.experiment.overrides import with_overrides
from hydrohil.qualification.grading import Figures, judge
from hydrohil.qualification.loop import EXPERIMENT, loop_figures, settings, trial_of
from hydrohil.qualification.measure import baseline_figures
from hydrohil.qualification.samples import Timing
from hydrohil.qualification.spread import Spread
from hydrohil.services.plant.config import latch_substeps
from hydrohil.thesis.library import find

PERIOD_NS = 4_500_000
OBSERVED = Timing((True,) * 150 + (False,) * 3 + (True,) * 97, (800.0,) * 247, 2)
STATUS = {
    "plant": {
        "counters": {
            "samples": 694,
            "unanswered": 3,
            "late_permits": 1,
            "grid_shifts": 2,
            "lateness_us": {"p50": 40.0, "p99": 150.0, "max": 400.0},
            "worst_lateness_us": 2300.0,
        },
        "link_stats": {"controller/command": {"accepted": 700, "lost": 1}, "supervisor/permit": {"accepted": 700}},
    },
    "controller": {"link_stats": {"plant/sample": {"accepted": 700, "lost": 4}}},
    "supervisor": {"link_stats": {"plant/sample": {"accepted": 700}}},
}


def test_counts_are_the_plants_own_and_losses_those_of_every_receiver():
    made = loop_figures(Figures(PERIOD_NS), "", OBSERVED, STATUS)
    assert (made.samples, made.unanswered, made.shifts, made.late_permits) == (694, 3.0, 2.0, 1.0)
    assert made.lost == 1 + 4 + OBSERVED.missing
    assert made.worst_window == 0.97
    assert made.accepted_us == Spread(800.0, 800.0, 800.0, 800.0)
    assert (made.grid_us.p50, made.grid_us.p99, made.grid_us.max) == (40.0, 150.0, 2300.0)


@pytest.mark.parametrize("silent", ["plant", "controller", "supervisor"])
def test_a_service_that_does_not_answer_leaves_a_number_missing_and_the_rate_unsigned(silent: str):
    status = {service: told for service, told in STATUS.items() if service != silent}
    made = loop_figures(Figures(PERIOD_NS), "", OBSERVED, status)
    assert math.isnan(made.lost)
    assert not judge(made).qualified


def test_before_the_loop_wake_ups_are_counted_by_what_they_would_do_to_the_grid():
    made = baseline_figures(PERIOD_NS, [500.0, 500.1, 4500.0, 4500.1], {"us": [1.0] * 4, "by": "x"}, {"us": [2.0], "lost": 3})
    assert (made.wake_ups_shifting, made.wake_ups_skipping, made.ping_lost) == (3.0, 1.0, 3.0)
    assert made.limit_us == Spread(1.0, 1.0, 1.0, 1.0) and made.limit_by == "x"
    assert not judge(made).qualified


@pytest.mark.parametrize("period_substeps", [20, 40, 90, 200])
def test_the_trial_is_the_sine_at_the_wanted_rate_for_the_wanted_time(period_substeps: int):
    made = trial_of(7.0, period_substeps)
    assert (made.duration_s, made.reference[0].duration_s) == (7.0, 7.0)
    assert (made.plant.sample_period_substeps, made.plant.jitter_substeps, made.claims) == (period_substeps, 0, ())
    assert latch_substeps(made.plant) == min(80, period_substeps * 4 // 5)
    assert made.plant.environment == find(EXPERIMENT).plant.environment
    assert to_plain(with_overrides(find(EXPERIMENT), settings(7.0, period_substeps))) == to_plain(made)
