"""A sweep: how much does the proportional gain of link 2 matter?

    python examples/sweep_a_gain.py

Each trial is a new experiment with one value changed. A value out of its bounds is refused with one line, as `--set` does.
For thousands of trials on many processors see `hydrohil campaign`.
"""

import numpy as np

import hydrohil as hh

GAIN = "controller.gains.down_up.kp_a_per_rad"
DOWN_UP = 1  # the second link


def rms_error_deg(experiment: hh.Experiment) -> float:
    """Root mean square error of the link's position in deg; NaN if the rig tripped."""
    run = hh.simulate(experiment)
    if run.trip or run.trace is None:
        return float("nan")
    error_rad = run.trace.q_set[:, DOWN_UP] - run.trace.q[:, DOWN_UP]
    return float(np.degrees(np.sqrt(np.mean(error_rad**2))))


def main() -> None:
    """Half to twice the gain of Table 2, on the sine of Figure 4-25."""
    experiment = hh.load("fig-4-25")
    tuned = experiment.controller.gains.down_up.kp_a_per_q
    for factor in (0.5, 0.7, 1.0, 1.4, 2.0):
        changed = experiment.with_values({GAIN: factor * tuned})
        print(f"{factor:4.1f} x {tuned:.2f} A/rad: rms error {rms_error_deg(changed):.3f} deg")
    try:
        experiment.with_values({GAIN: -1.0})
    except hh.ExperimentError as refused:
        print(refused)


if __name__ == "__main__":
    main()
