"""The loop's figures from samples and counters, and the trial of a rate."""

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
    figures = loop_figures(Figures(PERIOD_NS), "", OBSERVED, STATUS)
    assert (figures.samples, figures.unanswered, figures.shifts, figures.late_permits) == (694, 3.0, 2.0, 1.0)
    assert figures.lost == 1 + 4 + OBSERVED.missing
    assert figures.worst_window == 0.97
    assert figures.accepted_us == Spread(800.0, 800.0, 800.0, 800.0)
    assert (figures.grid_us.p50, figures.grid_us.p99, figures.grid_us.max) == (40.0, 150.0, 2300.0)


@pytest.mark.parametrize("silent", ["plant", "controller", "supervisor"])
def test_a_service_that_does_not_answer_leaves_a_number_missing_and_the_rate_unqualified(silent: str):
    status = {service: answer for service, answer in STATUS.items() if service != silent}
    figures = loop_figures(Figures(PERIOD_NS), "", OBSERVED, status)
    assert math.isnan(figures.lost)
    assert not judge(figures).qualified


def test_before_the_loop_wake_ups_are_counted_by_what_they_would_do_to_the_grid():
    figures = baseline_figures(PERIOD_NS, [500.0, 500.1, 4500.0, 4500.1], {"us": [1.0] * 4, "by": "x"}, {"us": [2.0], "lost": 3})
    assert (figures.wake_ups_shifting, figures.wake_ups_skipping, figures.ping_lost) == (3.0, 1.0, 3.0)
    assert figures.limit_us == Spread(1.0, 1.0, 1.0, 1.0) and figures.limit_by == "x"
    assert not judge(figures).qualified


@pytest.mark.parametrize("period_substeps", [20, 40, 90, 200])
def test_the_trial_is_the_sine_at_the_requested_rate_for_the_requested_time(period_substeps: int):
    figures = trial_of(7.0, period_substeps)
    assert (figures.duration_s, figures.reference[0].duration_s) == (7.0, 7.0)
    assert (figures.plant.sample_period_substeps, figures.plant.jitter_substeps, figures.claims) == (period_substeps, 0, ())
    assert latch_substeps(figures.plant) == min(80, period_substeps * 4 // 5)
    assert figures.plant.environment == find(EXPERIMENT).plant.environment
    assert to_plain(with_overrides(find(EXPERIMENT), settings(7.0, period_substeps))) == to_plain(figures)
