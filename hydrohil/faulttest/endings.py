"""Ends of processes (row 32): `hydrohil run` or the whole terminal ends while the valves move."""

import os
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from random import Random

from hydrohil.cell import processes as cells
from hydrohil.experiment.experiment import to_toml
from hydrohil.faulttest.motions import SWING
from hydrohil.faulttest.observer import Observer, moved, zero_at
from hydrohil.faulttest.rig import Rig
from hydrohil.faulttest.trial import Trial
from hydrohil.recording.reading import chunks_of
from hydrohil.shared.contract.messages import NO_TRIAL
from hydrohil.shared.host.child import environment, python_module
from hydrohil.shared.units import NS_PER_S

BOUND_S = 0.2
PATIENCE_S = 30.0
PORTS = 8  # beside the fault test's own cell and that of the start orders


def run_ended(rig: Rig, rng: Random, number: int, how: signal.Signals, everything: bool) -> Trial:
    """A signal to `hydrohil run`, which brought its cell up, or, as a closed terminal does, to all that it started."""
    place = rig.place._replace(cell=f"{rig.place.cell}-ending", port=rig.place.port + PORTS)
    with tempfile.TemporaryDirectory() as folder:
        experiment, recording = Path(folder) / "swing.toml", Path(folder) / "run.rrd"
        experiment.write_text(to_toml(SWING))
        line = [*python_module("hydrohil"), "run", str(experiment), "--rrd", str(recording), "--unqualified"]
        line += [*place.words, *rig.extra.get("plant", [])]
        quiet = subprocess.DEVNULL
        # a shell starts background processes with SIGINT ignored, and children inherit that
        signal.signal(signal.SIGINT, signal.default_int_handler)
        run = subprocess.Popen(line, cwd=folder, env=environment(), stdout=quiet, stderr=quiet, start_new_session=True)
        try:
            with cells.operator_bus(place) as bus:
                trial = _signal_run(Observer(bus), run, rng, how, everything)
        finally:
            run.kill()
            run.wait()
        return _recorded(trial, recording)


def _signal_run(observer: Observer, run: "subprocess.Popen[bytes]", rng: Random, how: signal.Signals, everything: bool) -> Trial:
    deadline = time.monotonic() + PATIENCE_S
    while not (samples := observer.listen().samples) or samples[-1].body.tick in (NO_TRIAL, *range(-10_000, 0)):
        if time.monotonic() > deadline or run.poll() is not None:
            return Trial(False, f"no trial began within {PATIENCE_S:g} s")
        time.sleep(0.01)
    observer.listen_for(0.3 + rng.uniform(0.0, 0.6))
    fault_ns = time.monotonic_ns()
    if everything:
        os.killpg(run.pid, how)
    else:
        run.send_signal(how)
    observed = observer.listen_for(BOUND_S + 0.3)
    at_ns = zero_at(observed, fault_ns)
    last_ns = observed.samples[-1].arrival_ns
    try:
        run.wait(PATIENCE_S)
    except subprocess.TimeoutExpired:
        return Trial(False, f"it still runs {PATIENCE_S:g} s after the signal", bound_s=BOUND_S)
    moved_mm, force_n = moved(observed, fault_ns)
    at_ns = at_ns or last_ns  # without a sample of zero the plant itself has ended; its last act is to write zero
    reaction_s = max(0, at_ns - fault_ns) / NS_PER_S
    return Trial(
        held=reaction_s <= BOUND_S,
        words=f"ended with status {run.returncode}",
        reaction_s=reaction_s,
        bound_s=BOUND_S,
        stalled_s=0.0,
        moved_mm=moved_mm,
        force_n=force_n,
    )


def _recorded(trial: Trial, recording: Path) -> Trial:
    """`trial`, if its recording is closed and can be read."""
    deadline, words = time.monotonic() + 5.0, "no recording"
    while time.monotonic() < deadline:
        try:
            return trial._replace(words=f"{trial.words}; recording closed, {chunks_of(recording)} chunks")
        except ValueError as error:
            words = str(error)
            time.sleep(0.1)
    return trial._replace(held=False, words=f"{trial.words}; {words}")
