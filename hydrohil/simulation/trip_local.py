"""The report of a trip on the local clock, from the rollout's rows: the same function, with what the rows hold."""

from typing import Any

from hydrohil.experiment.experiment import Experiment
from hydrohil.services.plant.config import GateLimits
from hydrohil.services.plant.plant_description import describe
from hydrohil.shared.contract.converters import ZERO_CODE
from hydrohil.shared.contract.messages import Mode
from hydrohil.shared.trips.report import Document, Origin, trip_report
from hydrohil.shared.trips.ring import KEPT_NS
from hydrohil.shared.trips.tables import COMMAND, GROUND_TRUTH, PERMIT, SAMPLE, STATE, Table
from hydrohil.shared.trips.watcher import utc_now
from hydrohil.simulation.rollout import Outcome

_OF_STATE = ("q", "q_set", "qd", "qd_set", "x_m", "x_set_m", "x_nominal_m", "force_n", "force_set_n")
_OF_STATE_TOO = ("current_a", "clamped", "boosted")
_OF_GROUND_TRUTH = ("pressure_a_pa", "pressure_b_pa", "contact_force_n")


def local_report(experiment: Experiment, outcome: Outcome) -> Document | None:
    """The trip that ended a rollout, None if it reached its end. The rows end with the trip: what came after is not known."""
    watch, rows = outcome.supervisor, outcome.rows
    if watch.mode != Mode.TRIPPED:
        return None
    first = int((rows.time_ns < rows.time_ns[-1] - KEPT_NS).sum())
    count = len(rows.tick) - first
    numbers = [first + i for i in range(count)]
    stamps = {"number": numbers, "tick": _column(rows.tick, first)}
    sample: Table = {**stamps, "trial_time_ns": _column(rows.time_ns, first)}
    sample |= _columns(rows, ("encoder_counts", "force_counts"), first)
    commanded = _columns(rows, ("dac_counts",), first)
    sample |= {name: _accepted(column, sample["tick"]) for name, column in commanded.items()}
    sample["command_number"] = [number - 1 for number in numbers]
    sample["command_age_ns"] = [outcome.latch_ns] * count
    signals = {
        SAMPLE: _ended(sample, outcome),
        COMMAND: {"echo_number": numbers} | commanded,
        STATE: stamps | _columns(rows, (*_OF_STATE, *_OF_STATE_TOO), first),
        GROUND_TRUTH: stamps | _columns(rows, _OF_GROUND_TRUTH, first) | _columns(rows, ("true_q",), first),
        PERMIT: _permits(outcome, numbers, _column(rows.mode, first)),
    }
    described = describe(experiment.plant, GateLimits())
    return trip_report(signals, Origin(utc_now(), "local", "no", 0, experiment.name), described, {})


def _column(values: Any, first: int) -> list[Any]:
    column: list[Any] = values[first:].tolist()
    return column


def _columns(rows: Any, names: tuple[str, ...], first: int) -> Table:
    """Columns of the rows by the names that the wire has."""
    table: Table = {}
    for name in names:
        values = getattr(rows, name)[first:]
        if values.ndim == 1:
            table[name] = values.tolist()
        else:
            table |= {f"{name}[{k}]": values[:, k].tolist() for k in range(values.shape[1])}
    return table


def _accepted(commanded: list[int], ticks: list[int]) -> list[int]:
    """What is in force at each sample: the answer to the one before, from tick 0 on; until then the gate is shut."""
    before = zip(commanded[:-1], ticks[:-1], strict=True)
    return [ZERO_CODE, *(code if tick >= 0 else ZERO_CODE for code, tick in before)]


def _ended(sample: Table, outcome: Outcome) -> Table:
    """With the sample that would follow, as far as it is known: what the gate left at the D/A."""
    following: dict[str, Any] = {name: None for name in sample}
    following |= {f"dac_counts[{k}]": outcome.gate.codes[k] for k in range(3)}
    following |= {"number": sample["number"][-1] + 1, "tick": sample["tick"][-1] + 1}
    return {name: [*column, following[name]] for name, column in sample.items()}


def _permits(outcome: Outcome, numbers: list[int], modes: list[int]) -> Table:
    """The permits of the rows; only the last one states a cause."""
    watch, quiet = outcome.supervisor, len(numbers) - 1
    return {
        "echo_number": numbers,
        "mode": modes,
        "cause": [0] * quiet + [watch.cause],
        "measured": [0.0] * quiet + [watch.measured],
        "limit": [0.0] * quiet + [watch.limit],
        "trip_number": [-1] * quiet + [watch.trip_number],
    }
