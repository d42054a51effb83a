"""Two recordings of the same experiment, compared signal by signal.

    hydrohil run fig-5-5 --clock lockstep --seed 1 --rrd runs/a.rrd
    hydrohil run fig-5-5 --clock lockstep --seed 2 --rrd runs/b.rrd
    python examples/compare_recordings.py runs/a.rrd runs/b.rrd

In lockstep a recording depends on the experiment and the seed alone: with the same seed every difference is 0.
"""

import sys
from pathlib import Path

import numpy as np

import hydrohil as hh

COMPARED = {"plant/sample": ("encoder_counts", "force_counts"), "controller/state": ("q", "force_n", "current_a")}


def of_the_trial(record: hh.TopicRecord, field: str) -> np.ndarray:
    """The field's values from the start of the reference on: (n,) or (n, k)."""
    return record[field][record.trial_s >= 0.0]


def main(first: Path, second: Path) -> float:
    """Print the largest difference of each signal; returns the largest difference of the contact force in N."""
    a, b = hh.read_recording(first), hh.read_recording(second)
    force_n = 0.0
    for topic, fields in COMPARED.items():
        for field in fields:
            of_a, of_b = of_the_trial(a[topic], field), of_the_trial(b[topic], field)
            n = min(len(of_a), len(of_b))
            largest = float(np.max(np.abs(of_a[:n] - of_b[:n])))
            print(f"{topic:18} {field:16} {n} samples, largest difference {largest:.4g}")
            force_n = largest if field == "force_n" else force_n
    print(a.summary.splitlines()[0], b.summary.splitlines()[0], sep="\n")
    return force_n


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
