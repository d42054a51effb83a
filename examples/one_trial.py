"""One trial, as in a notebook: load, change a value, simulate, look at the claims, plot.

    python examples/one_trial.py [PICTURE.png]

No processes, no waiting: the trial runs on the local clock, and the same seed gives the same numbers on every computer.
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

import hydrohil as hh


def main(picture: Path) -> None:
    """Static force control against a plate, with the thesis' law and with plain PI."""
    thesis = hh.load("fig-5-5")
    runs = {
        "as in the thesis": hh.simulate(thesis, seed=3),
        "PI": hh.simulate(thesis.with_values({"controller.law": "pi"}), seed=3),
    }
    for name, run in runs.items():
        print(f"{name}: {run.outcome}")
        for verdict in run.verdicts:
            claim, word = verdict.claim, "holds" if verdict.holds else "FAILS"
            print(f"  {word}: {claim.statement}, {verdict.measured:.3g} {claim.unit}")

    figure = Figure(figsize=(8, 4), layout="constrained")
    axes = figure.subplots()
    for name, run in runs.items():
        assert run.trace is not None  # only a live run can lose messages
        axes.plot(run.trace.t_s, run.trace.force_n, label=name, linewidth=0.8)
    axes.set(xlabel="time, s", ylabel="contact force, N", title=thesis.title)
    axes.legend()
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, dpi=120)
    print(f"see {picture}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/one_trial.png"))
