"""How late this host wakes a process: a child that only sleeps measures it, while its parent still loads and compiles."""

import os
import time

from hydrohil.shared.host.clock import sleep_until
from hydrohil.shared.host.realtime import die_with_parent, request_realtime
from hydrohil.shared.units import NS_PER_S

_PERIOD_NS = 4_500_000  # the sampling period of the thesis


def worst_lateness_ns(seconds: float) -> int:
    """Worst wake-up of an absolute grid, in ns."""
    worst_ns, due = 0, time.monotonic_ns()
    end = due + int(seconds * NS_PER_S)
    while due < end:
        due += _PERIOD_NS
        worst_ns = max(worst_ns, sleep_until(due))
        due = max(due, time.monotonic_ns() - _PERIOD_NS)
    return worst_ns


class Probe:
    """A child process that measures for a while and reports its worst lateness."""

    def __init__(self, seconds: float, *, realtime: bool) -> None:
        """Fork; call it before anything starts a thread that the child would need."""
        parent = os.getpid()
        self._pipe, report = os.pipe()
        os.set_blocking(self._pipe, False)
        self._child = os.fork()
        if self._child == 0:
            try:
                if die_with_parent(parent):
                    request_realtime(realtime=realtime)
                    os.write(report, str(worst_lateness_ns(seconds)).encode())
            finally:
                os._exit(0)
        os.close(report)

    def result(self) -> int | None:
        """The worst lateness in ns; None while the child still measures, 0 if it died."""
        try:
            text = os.read(self._pipe, 32)
        except BlockingIOError:
            return None
        os.close(self._pipe)
        os.waitpid(self._child, 0)
        return int(text) if text else 0
