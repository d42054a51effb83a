"""A live cell as an object: run experiments in it, break it, stop it."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self

from hydrohil.cell import injection, operate
from hydrohil.cell.connection import attached_cell, found_or_own_cell, own_cell, service_options
from hydrohil.cell.processes import LOOP, CellError, Place, RefusedError, statuses
from hydrohil.cell.run import run_in_cell
from hydrohil.experiment.errors import ExperimentError
from hydrohil.experiment.experiment import Experiment, checked_seed, validate
from hydrohil.experiment.fault_lines import fault_of
from hydrohil.experiment.run import Run
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.host.process import DEFAULT_CELL
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.transport.endpoints import DEFAULT_PORT, network

Clock = Literal["lockstep", "real"]
CLOCKS: tuple[Clock, ...] = ("lockstep", "real")


def _ignore(_: object) -> None:
    """Ignore progress and notes: the default of both callbacks."""


class Cell:
    """Plant, controller, supervisor and recorder as processes, with an operator's place on their network.

    `Cell()` brings up processes of its own, `Cell.attach()` uses a cell that is up, `Cell.open()` does whichever is possible.
    Use it in a `with`, or call `close()`: processes of its own end then, and in any case with this process.
    Every method raises a CellError that says what to do where the cell does not answer.
    """

    def __init__(
        self,
        name: str = DEFAULT_CELL,
        port: int = DEFAULT_PORT,
        *,
        lease_ms: float | None = None,
        realtime: bool = True,
        recorder: bool = True,
    ) -> None:
        """Bring up a cell on this host and wait until it is ready, some four seconds; it uses four ports from `port` on.

        `lease_ms` is the longest age of a command or permit, chosen from this host's lateness if None; `realtime` asks for
        real-time scheduling. Raises CellError where a cell of that name is up already, or a port is taken.
        """
        services = SERVICES if recorder else LOOP
        self._enter(own_cell(Place(name, port), service_options(lease_ms, realtime=realtime), services))

    @classmethod
    def attach(cls, name: str = DEFAULT_CELL, port: int = DEFAULT_PORT, *, hosts: str = "", router: str = "") -> Self:
        """A cell that is up, whichever program started it; `hosts` and `router` are those of `hydrohil run`.

        `close()` leaves its processes alone. Raises ValueError where `hosts` or `router` cannot be read; whether anybody
        answers shows with the first request.
        """
        return cls._of(attached_cell(Place(name, port, network(hosts, router))))

    @classmethod
    def open(
        cls,
        name: str = DEFAULT_CELL,
        port: int = DEFAULT_PORT,
        *,
        hosts: str = "",
        router: str = "",
        lease_ms: float | None = None,
        realtime: bool = True,
        recorder: bool = True,
    ) -> Self:
        """The cell that is up, otherwise processes of its own: what `hydrohil run` does. Raises CellError, ValueError."""
        place, options = Place(name, port, network(hosts, router)), service_options(lease_ms, realtime=realtime)
        return cls._of(found_or_own_cell(place, options, SERVICES if recorder else LOOP))

    @classmethod
    def _of(cls, connection: AbstractContextManager[Bus]) -> Self:
        cell = cls.__new__(cls)
        cell._enter(connection)
        return cell

    def _enter(self, connection: AbstractContextManager[Bus]) -> None:
        self._stack = ExitStack()
        self._bus: Bus | None = self._stack.enter_context(connection)

    @property
    def bus(self) -> Bus:
        """The operator's place on the cell's network. Raises CellError once the cell is closed."""
        if self._bus is None:
            raise CellError("the cell is closed: bring up or attach to another")
        return self._bus

    def __enter__(self) -> Self:
        """The cell."""
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Leave the network; processes of its own are stopped, the valves go to zero first. Closing twice is allowed."""
        self._bus = None
        self._stack.close()

    def run(
        self,
        experiment: Experiment,
        seed: int = 0,
        *,
        clock: Clock = "lockstep",
        record: str | Path | None = None,
        unqualified: bool = False,
        progress: Callable[[float], object] = _ignore,
        note: Callable[[str], object] = _ignore,
    ) -> Run:
        """Run an experiment to its end and judge its claims. A trip is a result: `run.trip` says why, `run.trip_report` how.

        In lockstep the services wait for each other and the trace is that of `simulate`; on the real clock they must be in time,
        and a rate above the one that `hydrohil qualify` found is refused unless `unqualified`. `record` is the `.rrd` file of
        a recording. `progress` is called with the trial's time in s, from -bias_s on, about 20 times a second; `note` with lines
        for an operator, such as what the controller warns of. Either may call `inject`, `set_parameters` or `estop`; an
        exception that it raises disarms the cell and goes on to the caller.

        Raises ExperimentError; TrippedError where the cell had tripped before; UnqualifiedError; RefusedError where a service
        refuses the experiment; CellError where the run has no end, with `trip_report` if a trip was the reason.
        """
        experiment, seed = validate(experiment), checked_seed(seed)
        if clock not in CLOCKS:
            raise ExperimentError([f"clock is {clock!r}: expected {' or '.join(CLOCKS)}; `simulate` has the local clock"])
        if unplayable := injection.unplayable(experiment.faults, clock):
            raise ExperimentError(unplayable)
        return run_in_cell(
            self.bus,
            experiment,
            seed,
            clock,
            record=None if record is None else Path(record),
            unqualified=unqualified,
            progress=progress,
            note=note,
        )

    def status(self) -> dict[str, dict[str, Any]]:
        """Status of every service that answers, by service: what `hydrohil status --json` prints."""
        return statuses(self.bus)

    def inject(self, fault: Fault | str) -> str:
        """Break something from the next sample on, until its time is over or `clear`; returns what was done, in words.

        `fault` is a Fault or a line such as `stuck force for=2`; times count from now. Raises ExperimentError where the line
        cannot be read, RefusedError where the fault cannot be injected, CellError.
        """
        broken = fault_of(fault, "inject") if isinstance(fault, str) else fault
        if problem := injection.refused(broken):
            raise RefusedError(problem)
        return injection.inject(self.bus, broken)

    def clear(self) -> None:
        """End everything that was injected."""
        injection.clear(self.bus)

    def set_parameters(self, values: Mapping[str, Any] | Sequence[str]) -> dict[str, Any]:
        """Change parameters of the controller while a trial runs, several as one change: `{"controller.law": "pi"}`.

        Lines are taken too, as `hydrohil set` has them: `["controller.law=pi"]`.

        Returns `number`, the sample from which they act; `ramp_samples`, over how many they move; `changed`, a list of `path`,
        `old` and `new`; `warnings`. The run then has no verdict. Raises RefusedError where a name, a value or the moment is
        refused.
        """
        return operate.set_parameters(self.bus, operate.assignments_of(values) if isinstance(values, Mapping) else list(values))

    def estop(self) -> str:
        """Emergency stop at gate and supervisor; either alone suffices. Returns what the plant confirms.

        Raises NotConfirmedError unless the plant reports zero current, and reads it back at the D/A where that is possible:
        cut the hydraulic supply then.
        """
        return operate.estop(self.bus)

    def stop(self) -> None:
        """End the trial and disarm."""
        operate.stop(self.bus)

    def reset(self) -> None:
        """Leave TRIPPED; no valve moves. Raises RefusedError while the cause stands."""
        operate.reset(self.bus)

    def recover(self, seconds: float = 2.0) -> str:
        """Move slowly in the direction that unloads what tripped, for `seconds`; returns the supervisor's words afterwards.

        An exception in between, such as Ctrl-C, releases at once. Raises RefusedError where nothing is to be unloaded.
        """
        return operate.recover(self.bus, seconds)
