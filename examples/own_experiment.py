"""The smallest experiment of one's own: a reference, a claim about it, a trial.

    python examples/own_experiment.py [FILE.toml]

Whatever is not written here keeps its default: machine, gains and limits are those of the thesis' Unimate.
"""

import math
import sys
from pathlib import Path

import hydrohil as hh

EXPERIMENT = hh.Experiment(
    name="nod",
    alias="my-nod",
    title="Link 2 goes up by two degrees and comes back",
    source="examples/own_experiment.py",
    duration_s=6.0,
    controller=hh.ControllerConfig(target="joint"),
    reference=(
        hh.Segment("q2", "ramp", start_s=0.5, duration_s=1.0, amount=math.radians(2.0), blend_s=0.2),
        hh.Segment("q2", "ramp", start_s=3.5, duration_s=1.0, amount=math.radians(-2.0), blend_s=0.2),
    ),
    claims=(
        hh.Claim(
            statement="It stays within half a degree of where it shall be",
            metric="max_error",
            channel="q2",
            comparison="below",
            start_s=2.5,
            end_s=3.4,
            unit="deg",
            high=0.5,
        ),
    ),
)


def main(file: Path) -> hh.Run:
    """Simulate it, then write the file that `hydrohil run` takes."""
    run = hh.simulate(EXPERIMENT)
    print(run)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(EXPERIMENT.to_toml())
    print(f"hydrohil run {file} --clock local")
    return run


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "runs/nod.toml"))
