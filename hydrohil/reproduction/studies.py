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
        name="fig-4-12",
        alias="deadband-characteristic",
        title="Deadband compensation",
        source="thesis figure 4-12, 4.5.1",
        run=later("thesis.deadband", "plain"),
    ),
    Study(
        name="fig-4-13",
        alias="hysteresis-characteristic",
        title="Deadband compensation with hysteresis",
        source="thesis figure 4-13, 4.5.2",
        run=later("thesis.deadband", "hysteretic"),
    ),
    Study(
        name="fig-4-14",
        alias="stiction-signals",
        title="Error signals in stiction",
        source="thesis figure 4-14, 4.5.3",
        run=later("thesis.stiction", "signals_study"),
        trials=("fig-4-9",),
    ),
    Study(
        name="fig-4-15",
        alias="stiction-plane",
        title="Stiction error over the velocity plane",
        source="thesis figure 4-15, 4.5.3",
        run=later("thesis.stiction", "plane_study"),
    ),
    Study(
        name="fig-6-4",
        alias="force-filter",
        title="Equivalent explicit force controller filter",
        source="thesis figure 6-4, 6.2.1",
        run=later("thesis.explicit_force", "force_filter"),
    ),
    Study(
        name="largest-gain",
        alias="loop-gain",
        title="Largest stable proportional gain",
        source="thesis Appendix C, step 1",
        run=later("linear.loop_studies", "largest_gain_study"),
    ),
    Study(
        name="linear-response",
        alias="linear-against-rig",
        title="The linearised model against the rig",
        source="thesis 5.2 and 5.3, by the model of 3.2",
        run=later("linear.loop_studies", "response_study"),
        trials=("fig-5-2", "fig-5-5"),
    ),
    Study(
        name="linear-stability",
        alias="stability-over-stiffness",
        title="Stability of the linearised model over the target stiffness",
        source="thesis 6.2.1, by the model of 3.2",
        run=later("linear.loop_studies", "stability_study"),
    ),
    Study(
        name="fig-9-1",
        alias="plate-stiffness",
        title="Stiffness of the test plate",
        source="thesis figure 9-1, Appendix D",
        run=later("thesis.plate", "plate_study"),
    ),
    Study(
        name="fig-9-2",
        alias="gauge-regression",
        title="Stiffness of the force gauge",
        source="thesis figure 9-2, Appendix E",
        run=later("thesis.gauge", "gauge_study"),
        trials=("gauge-staircase",),
    ),
    Study(
        name="fig-9-7",
        alias="regression-profile",
        title="Test position profile",
        source="thesis figure 9-7, Appendix B",
        run=later("thesis.velocity", "position_study"),
        also=("fig-9-3",),  # so in the thesis' list of figures
    ),
    Study(
        name="fig-9-8",
        alias="regression-points",
        title="Velocity by 2 to 100 points",
        source="thesis figure 9-8, Appendix B",
        run=later("thesis.velocity", "velocity_study"),
        also=("fig-9-4",),
    ),
)
