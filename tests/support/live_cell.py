"""Real cells for the live tests: each on ports of its own, each dead when its test is over."""

import os
import random
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hydrohil.cell import processes as cells
from hydrohil.claims.claims import Claim
from hydrohil.experiment.experiment import Experiment, to_toml
from hydrohil.services.controller.config import ControllerConfig, Segment
from hydrohil.services.plant.config import PlantConfig
from hydrohil.shared.contract.topics import SERVICES
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.transport.bus import Bus

LEASE_MS = "200"  # the longest: a busy machine does not decide these tests
LEASE = {"plant": ["--permit-ttl-ms", LEASE_MS]}
ZERO = [2048, 2048, 2048]
PATIENCE_S = 60.0
COMMAND_S = 300.0  # the first command after a change compiles
PARTS = ("hydrohil.services.", "hydrohil.qualification.")
FOLLOWS = Claim(
    statement="It follows", metric="peak_to_peak", channel="q2", comparison="above", start_s=0.0, end_s=1.5, unit="deg", low=5.0
)


def experiment(duration_s: float) -> Experiment:
    """Up/down swings by 10 deg and back with the final law for as long as it lasts."""
    return Experiment(
        name="swing",
        alias="swing",
        title="Swinging",
        source="these tests",
        duration_s=duration_s,
        plant=PlantConfig(jitter_substeps=10, bias_s=0.5),
        controller=ControllerConfig(target="joint"),
        reference=(Segment("q2", "sine", 0.0, duration_s, 0.1, frequency_hz=0.5),),
        claims=(FOLLOWS,),
    )


def swing(folder: Path, duration_s: float = 1.5) -> str:
    """The path of that experiment as a file."""
    path = folder / "swing.toml"
    path.write_text(to_toml(experiment(duration_s)))
    return str(path)


def own_place() -> cells.Place:
    """A cell of its own; its ports lie below those that the kernel assigns."""
    return cells.Place(f"live-{os.getpid()}-{random.randrange(1 << 30)}", random.randrange(20_000, 30_000, 4))


def line(place: cells.Place, *arguments: str) -> list[str]:
    """The command line in that cell; the qualification of this machine does not decide these tests."""
    unqualified = ["--unqualified"] * (arguments[0] == "run")
    return [*python_module("hydrohil"), *arguments, *place.words, *unqualified]


def hydrohil(place: cells.Place, *arguments: str) -> subprocess.CompletedProcess[str]:
    """One command to its end."""
    command = line(place, *arguments)
    return subprocess.run(command, env=environment(), capture_output=True, text=True, check=False, timeout=COMMAND_S)


def begun(place: cells.Place, *arguments: str) -> subprocess.Popen[str]:
    """One command that goes on."""
    return subprocess.Popen(line(place, *arguments), env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def until(condition: Callable[[], Any], what: str) -> Any:
    """The first true value of `condition`; fails after half a minute."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"never: {what}")


def processes(place: cells.Place) -> list[int]:
    """Services and probes of that cell which live."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdecimal():
            continue
        try:
            words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
        except OSError:
            continue
        if place.cell in words and any(word.startswith(PARTS) and word != "hydrohil" for word in words):
            found.append(int(entry.name))
    return found


class Cell:
    """A cell that runs until it is closed, and the operator's place in it."""

    def __init__(self) -> None:
        self.place = own_place()
        self.processes = cells.start(self.place, SERVICES, with_parent=True, extra=LEASE)
        self._operator = cells.operator_bus(self.place)
        try:
            self.bus: Bus = self._operator.__enter__()
            cells.await_ready(self.place, self.bus, self.processes)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        cells.stop(process.pid for process in self.processes.values())
        self._operator.__exit__(None, None, None)

    def run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        return hydrohil(self.place, *arguments)

    def status(self, service: str) -> dict[str, Any]:
        return cells.statuses(self.bus, (service,)).get(service, {})

    def kill(self, service: str) -> None:
        self.processes[service].kill()
        self.processes[service].wait()

    def revive(self, service: str) -> None:
        """Start what was killed and wait until the cell is whole again."""
        self.processes |= cells.start(self.place, (service,), with_parent=True, extra=LEASE)
        cells.await_ready(self.place, self.bus, self.processes)

    def moves(self) -> bool:
        """A trial runs and a valve is off zero."""
        status = self.status("plant")
        return bool(status) and status["tick"] is not None and status["tick"] > 20 and status["dac_counts"] != ZERO

    def at_rest(self) -> bool:
        return self.status("plant")["dac_counts"] == ZERO

    def begun_run(self, folder: Path, *arguments: str, duration_s: float = 20.0) -> subprocess.Popen[str]:
        """A long run whose valves are moving."""
        run = begun(self.place, "run", swing(folder, duration_s), *arguments)
        try:
            until(self.moves, "the valves move")
        except AssertionError:
            run.kill()
            raise AssertionError(run.communicate()) from None
        return run

    def calm(self) -> None:
        """Disarm and reset, from any state."""
        until(lambda: hydrohil(self.place, "reset").returncode == 0, "reset is accepted")


def end(process: subprocess.Popen[str], number: int = signal.SIGINT) -> tuple[int, str]:
    """Send a signal; exit status and everything that was printed."""
    process.send_signal(number)
    return ended(process)


def ended(process: subprocess.Popen[str]) -> tuple[int, str]:
    """Exit status and everything that was printed."""
    out, err = process.communicate(timeout=60)
    return process.returncode, out + err
