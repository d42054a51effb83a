"""Bode data of the linearised model, and their plot."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from hydrohil.claims.trace import Reals
from hydrohil.linear.blocks import Complexes, blocks, responses
from hydrohil.linear.linear import LinearModel

POINTS = 600


class Bode(NamedTuple):
    """Gain and phase of one frequency response, (n,) each."""

    label: str
    frequency_hz: Reals
    gain_db: Reals
    phase_deg: Reals


def bode(label: str, response: Complexes, frequency_hz: Reals) -> Bode:
    """Gain in dB and unwrapped phase in deg."""
    return Bode(label, frequency_hz, 20.0 * np.log10(np.abs(response)), np.degrees(np.unwrap(np.angle(response))))


def bode_data(model: LinearModel, low_hz: float, high_hz: float) -> tuple[Bode, ...]:
    """Both loops, and of X/X_d, X/F_d (m/N), F/X_d (N/m), F/F_d those that are not zero."""
    frequency_hz = np.geomspace(low_hz, high_hz, POINTS)
    response = responses(blocks(model), 2.0 * np.pi * frequency_hz)
    named = {
        "R_F A C M_F + R_X A (C + Q_v)": response.loop,
        "loop at the valve": response.valve_loop,
        "X/X_d": response.x_per_x_d,
        "F/F_d": response.f_per_f_d,
        "X/F_d, m/N": response.x_per_f_d,
        "F/X_d, N/m": response.f_per_x_d,
    }
    return tuple(bode(label, response, frequency_hz) for label, response in named.items() if np.all(response != 0.0))


def save_bode(model: LinearModel, path: Path, title: str, shown_hz: tuple[float, float]) -> None:
    """Write gain over phase to `path`: the loops on the left, the closed loop on the right."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 2, sharex=True)
    for number, line in enumerate(bode_data(model, *shown_hz)):
        column = 0 if number < 2 else 1
        axes[0, column].semilogx(line.frequency_hz, line.gain_db, label=line.label)
        axes[1, column].semilogx(line.frequency_hz, line.phase_deg, label=line.label)
    for column, words in enumerate(("loops", "closed loop")):
        axes[0, column].set(title=words, ylabel="gain, dB")
        axes[1, column].set(xlabel="frequency, Hz", ylabel="phase, deg")
        axes[0, column].legend()
    for axis in axes.flat:
        axis.grid(which="both", alpha=0.3)
    figure.suptitle(title)
    figure.savefig(path, dpi=120)
