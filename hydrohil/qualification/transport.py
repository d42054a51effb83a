"""A ping-pong of bare payloads between two processes: the loop's topics with their own quality of service, without frames.

Each message is as large as a sample's frame. The main thread of both ends sleeps until the transport wakes it.
"""

import os
import subprocess
import time
from collections import deque

from hydrohil.cell.processes import Place
from hydrohil.shared.contract.codec import Header, encode
from hydrohil.shared.contract.messages import Sample
from hydrohil.shared.host.child import python_module
from hydrohil.shared.host.clock import sleep_until
from hydrohil.shared.host.process import draw_number
from hydrohil.shared.transport.bus import Bus

PING, PONG = "controller/command", "plant/sample"  # as a sample and the command that answers it go
WARM_UP = 50
_PATIENCE_S = 0.2  # for one answer
_JOIN_S = 20.0  # for the echo to be there
_NS_PER_US = 1000


def frame_bytes() -> int:
    """Size of a sample's frame."""
    header = Header(
        version=1,
        schema=1,
        cell="cell",
        run=1 << 47,
        experiment=bytes(32),
        sender="plant",
        epoch=1 << 61,
        arming_id=1 << 61,
        seq=1 << 20,
        echo_number=1 << 20,
        echo_time_ns=1 << 40,
    )
    sample = Sample(
        number=1 << 20,
        time_ns=1 << 40,
        tick=1000,
        trial_time_ns=1 << 40,
        encoder_counts=(4000,) * 5,
        force_counts=100,
        dac_counts=(2048,) * 3,
        gate=1,
        gate_cause=0,
        gate_open_samples=1000,
        recover_signs=(0, 0, 0),
        command_number=1 << 20,
        command_late_substeps=0,
        command_age_ns=1 << 22,
    )
    return len(encode("hydrohil/cell/plant/sample", header, sample))


def ping(place: Place, period_ns: int, count: int, echo: list[str]) -> tuple[list[float], int]:
    """Round trips in us to the process that the command line `echo` starts, once a period; and how many did not return.

    Raises BusError, or TimeoutError where that process does not answer at all.
    """
    echoing = subprocess.Popen(echo)
    payload, taken, lost = bytes(frame_bytes()), [], 0
    arrived: deque[int] = deque()
    try:
        with Bus("controller", place.cell, place.port, draw_number()) as bus:
            bus.listen(PONG, lambda _: arrived.append(time.monotonic_ns()))
            send = bus.sender(PING)
            _await_echo(bus, arrived, payload, echoing)
            due = time.monotonic_ns()
            for number in range(count + WARM_UP):
                due = max(due + period_ns, time.monotonic_ns())
                sleep_until(due)
                arrived.clear()
                sent = time.monotonic_ns()
                send(payload)
                _await(bus, arrived, _PATIENCE_S)
                if number < WARM_UP:
                    continue
                if arrived:
                    taken.append((arrived[0] - sent) / _NS_PER_US)
                else:
                    lost += 1
    finally:
        echoing.terminate()
        echoing.wait()
    return taken, lost


def _await_echo(bus: Bus, arrived: deque[int], payload: bytes, echoing: subprocess.Popen[bytes]) -> None:
    """Wait until the first answer has come; TimeoutError where none comes."""
    send, deadline = bus.sender(PING), time.monotonic() + _JOIN_S
    while not arrived:
        if echoing.poll() is not None or time.monotonic() > deadline:
            raise TimeoutError(f"the other end of the ping-pong does not answer within {_JOIN_S:g} s")
        send(payload)
        _await(bus, arrived, _PATIENCE_S)


def _await(bus: Bus, arrived: deque[int], patience_s: float) -> None:
    """Wait until something has arrived; an older wake-up does not end the wait."""
    deadline = time.monotonic() + patience_s
    while not arrived and (left_s := deadline - time.monotonic()) > 0:
        bus.wait(left_s)


def echo(place: Place) -> None:
    """The other process: wake, answer, sleep, as long as its parent lives."""
    frames: deque[bytes] = deque()
    parent = os.getppid()
    with Bus("plant", place.cell, place.port, draw_number()) as bus:
        bus.listen(PING, frames.append)
        send = bus.sender(PONG)
        while os.getppid() == parent:
            bus.wait(0.5)
            while frames:
                send(frames.popleft())


def echo_line(module: str, place: Place, options: list[str]) -> list[str]:
    """The command line of the other process."""
    return [*python_module(module), "echo", "--cell", place.cell, "--port", str(place.port), *options]
