"""Start-up of the plant: the emulator is compiled before the transport opens; the gate's limits come from here alone.

The host is measured from the first moment on, so modules that take long to import are imported meanwhile.
"""

import math
import sys
from collections.abc import Callable

from hydrohil.services.plant.config import GateLimits
from hydrohil.shared.exit_status import EXIT_TRANSPORT
from hydrohil.shared.host.lease import MAX_LEASE_NS, MEASURED_S, LeaseChoice
from hydrohil.shared.host.process import Options, options_of, parser, serve
from hydrohil.shared.host.wakeups import Probe
from hydrohil.shared.machine.unimate import UNIMATE
from hydrohil.shared.transport.bus import Bus
from hydrohil.shared.units import SUBSTEP_NS

_NS_PER_MS = 1_000_000
GAUGE_RANGE_N = UNIMATE.gauge.range_n


def main(arguments: list[str] | None = None) -> int:
    """Run until a signal; returns the exit status."""
    line = parser("plant", __doc__)
    line.add_argument(
        "--permit-ttl-ms", type=float, help="lease of permits and commands; default: chosen from this host's lateness"
    )
    line.add_argument("--gate-force-limit-n", type=float, default=420.0, help="raw force at which the gate cuts by itself (420)")
    line.add_argument("--no-warmup", action="store_true", help="send none before a sample: less work, later answers")
    given = line.parse_args(arguments)
    options = options_of(line, given)
    limits = GateLimits(force_limit_n=given.gate_force_limit_n)
    if given.permit_ttl_ms is not None and math.isfinite(given.permit_ttl_ms):
        lease_ns = int(given.permit_ttl_ms * _NS_PER_MS)
        limits = limits._replace(permit_ttl_ns=lease_ns, command_ttl_ns=lease_ns)
    lease_ms = 1.0 if given.permit_ttl_ms is None else given.permit_ttl_ms
    if (
        not (math.isfinite(lease_ms) and 0 < limits.permit_ttl_ns <= MAX_LEASE_NS)
        or not 0.0 < limits.force_limit_n <= GAUGE_RANGE_N
    ):
        line.error(
            f"the lease must be in 0..{MAX_LEASE_NS // _NS_PER_MS} ms and the gate's force limit in 0..{GAUGE_RANGE_N:g} N"
        )
    fixed = given.permit_ttl_ms is not None
    probe = None if fixed else Probe(MEASURED_S, realtime=options.realtime)
    return _serve(options, limits, LeaseChoice(probe, fixed=fixed), warmups=not given.no_warmup)


def _serve(options: Options, limits: GateLimits, lease: LeaseChoice, *, warmups: bool) -> int:
    """Compile, open the transport, and run; returns the exit status."""
    from hydrohil.services.plant.device import Timeline
    from hydrohil.services.plant.emulator import Emulator
    from hydrohil.services.plant.service import PeerSilentError, Plant

    timeline = Timeline()
    emulator = Emulator(timeline, limits.permit_ttl_ns // SUBSTEP_NS)
    silent: list[str] = []

    def run(bus: Bus, stopped: Callable[[], bool]) -> None:
        plant = Plant(bus, emulator, timeline, limits, stopped, lease, warmups=warmups)
        try:
            plant.run()
        except PeerSilentError as error:
            silent.append(str(error))

    status = serve("plant", options, run)
    if silent:
        print(f"plant: {silent[0]}", file=sys.stderr)
        return EXIT_TRANSPORT
    return status
