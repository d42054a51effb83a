"""Every figure of the thesis that is computed rather than tried, in the order of the thesis.

What computes them loads when it runs: python-control and scipy take seconds, a list of names does not.
"""

from collections.abc import Callable, Sequence
from importlib import import_module

from hydrohil.claims.study import Studied, Study
from hydrohil.claims.trace import Trace


def later(module: str, function: str) -> Callable[[Sequence[Trace]], Studied]:
    """`hydrohil.<module>.<function>`, imported at its first call."""

    def run(traces: Sequence[Trace]) -> Studied:
        studied: Studied = getattr(import_module(f"hydrohil.{module}"), function)(traces)
        return studied

    return run


STUDIES: tuple[Study, ...] = (
    Study(
        "fig-4-12",
        "deadband-characteristic",
        "Deadband compensation",
        "thesis figure 4-12, 4.5.1",
        later("thesis.deadband", "plain"),
    ),
    Study(
        "fig-4-13",
        "hysteresis-characteristic",
        "Deadband compensation with hysteresis",
        "thesis figure 4-13, 4.5.2",
        later("thesis.deadband", "hysteretic"),
    ),
    Study(
        "fig-4-14",
        "stiction-signals",
        "Error signals in stiction",
        "thesis figure 4-14, 4.5.3",
        later("thesis.stiction", "signals_study"),
        ("fig-4-9",),
    ),
    Study(
        "fig-4-15",
        "stiction-plane",
        "Stiction error over the velocity plane",
        "thesis figure 4-15, 4.5.3",
        later("thesis.stiction", "plane_study"),
    ),
    Study(
        "fig-6-4",
        "force-filter",
        "Equivalent explicit force controller filter",
        "thesis figure 6-4, 6.2.1",
        later("thesis.explicit_force", "force_filter"),
    ),
    Study(
        "largest-gain",
        "loop-gain",
        "Largest stable proportional gain",
        "thesis Appendix C, step 1",
        later("linear.loop_studies", "largest_gain_study"),
    ),
    Study(
        "linear-response",
        "linear-against-rig",
        "The linearised model against the rig",
        "thesis 5.2 and 5.3, by the model of 3.2",
        later("linear.loop_studies", "response_study"),
        ("fig-5-2", "fig-5-5"),
    ),
    Study(
        "linear-stability",
        "stability-over-stiffness",
        "Stability of the linearised model over the target stiffness",
        "thesis 6.2.1, by the model of 3.2",
        later("linear.loop_studies", "stability_study"),
    ),
    Study(
        "fig-9-1",
        "plate-stiffness",
        "Stiffness of the test plate",
        "thesis figure 9-1, Appendix D",
        later("thesis.plate", "plate_study"),
    ),
    Study(
        "fig-9-2",
        "gauge-regression",
        "Stiffness of the force gauge",
        "thesis figure 9-2, Appendix E",
        later("thesis.gauge", "gauge_study"),
        ("gauge-staircase",),
    ),
    Study(
        "fig-9-7",
        "regression-profile",
        "Test position profile",
        "thesis figure 9-7, Appendix B",
        later("thesis.velocity", "position_study"),
        also=("fig-9-3",),  # so in the thesis' list of figures
    ),
    Study(
        "fig-9-8",
        "regression-points",
        "Velocity by 2 to 100 points",
        "thesis figure 9-8, Appendix B",
        later("thesis.velocity", "velocity_study"),
        also=("fig-9-4",),
    ),
)
