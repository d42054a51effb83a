"""Who listens where and connects to whom, as the transport's configuration. Nothing here opens a socket.

Without a router a cell is a full mesh of peers: each service listens on its own host and connects to those before it; the
operator only connects. With a router every session is a client of it alone: peers around a router that does not gossip do
not hear each other. Scouting and gossip are off: a session reaches only the endpoints that it is given.
"""

import ipaddress
import json
import re
from typing import Any, NamedTuple

from hydrohil.shared.errors import AddressError

LISTENERS = ("plant", "controller", "supervisor", "recorder")  # offset from the cell's first port
DEFAULT_PORT = 7450  # a cell's first
LOOPBACK = "127.0.0.1"
ROUTER = f"tcp/{LOOPBACK}:7447"
CLIENT_TRIES_MS = 1000  # to reach a router; then a service tries again, and an operator gets an error
_NAME = re.compile(r"[A-Za-z0-9]([A-Za-z0-9-]*[A-Za-z0-9])?(\.[A-Za-z0-9]([A-Za-z0-9-]*[A-Za-z0-9])?)*")
_ENDPOINT = re.compile(r"tcp/([^:/]+):([0-9]{1,5})")
_MAX_PORT = 65_535
_PRIORITIES = ("control", "real_time", "interactive_high", "interactive_low", "data_high", "data", "data_low", "background")
_QUEUED_BATCHES = 16  # two, the default, lose messages when the processor is contended


class Network(NamedTuple):
    """Where the services of a cell are."""

    hosts: tuple[tuple[str, str], ...] = ()  # service and address; a service that is not named is on 127.0.0.1
    router: str = ""  # endpoint of the router that all are clients of; "" = a mesh of peers

    def host(self, service: str) -> str:
        """Address on which a service listens, in a mesh."""
        return dict(self.hosts).get(service, LOOPBACK)

    @property
    def words(self) -> list[str]:
        """The options that say the same on a command line."""
        if self.router:
            return ["--router", self.router]
        return ["--hosts", ",".join("=".join(entry) for entry in self.hosts)] if self.hosts else []


HERE = Network()  # a mesh on this host


def network(hosts: str = "", router: str = "") -> Network:
    """From the texts of `--hosts` and `--router`; raises AddressError with one line."""
    if hosts and router:
        raise AddressError("--hosts and --router exclude each other: with a router every service connects to it alone")
    if router:
        host, _ = address(router, "--router")
        if _unspecified(host):
            raise AddressError(
                f"--router is {router!r}: expected the address at which the router is reached, not the one for all"
            )
    return Network(_hosts(hosts), router)


def _hosts(text: str) -> tuple[tuple[str, str], ...]:
    found: dict[str, str] = {}
    for entry in text.split(",") if text else ():
        service, _, host = entry.strip().partition("=")
        if service not in LISTENERS:
            raise AddressError(f"--hosts has {entry!r}: expected SERVICE=ADDRESS, SERVICE one of {', '.join(LISTENERS)}")
        if service in found:
            raise AddressError(f"--hosts names the {service} twice: expected one address a service")
        if not _is_host(host) or _unspecified(host):
            raise AddressError(f"--hosts has {entry!r}: expected an IPv4 address or a name of the host the {service} runs on")
        found[service] = host
    return tuple(found.items())


def address(endpoint: str, option: str) -> tuple[str, int]:
    """Host and port of an endpoint; raises AddressError with one line that names the option."""
    found = _ENDPOINT.fullmatch(endpoint)
    if found is None or not _is_host(found[1]) or not 0 < int(found[2]) <= _MAX_PORT:
        raise AddressError(f"{option} is {endpoint!r}: expected tcp/ADDRESS:PORT, such as {ROUTER}")
    return found[1], int(found[2])


def _is_host(text: str) -> bool:
    """An IPv4 address or a name; what looks like an address but is none is no name."""
    if re.fullmatch(r"[0-9.]*", text):
        return _ipv4(text) is not None
    return _NAME.fullmatch(text) is not None


def _unspecified(host: str) -> bool:
    """0.0.0.0: one can listen there, but not connect to it."""
    found = _ipv4(host)
    return found is not None and found.is_unspecified


def _ipv4(text: str) -> ipaddress.IPv4Address | None:
    try:
        return ipaddress.IPv4Address(text)
    except ValueError:
        return None


def listener(service: str, port: int, where: Network) -> tuple[str, int] | None:
    """Host and port on which a service listens in a cell whose first port is `port`; None if it only connects."""
    if where.router or service not in LISTENERS:
        return None
    return where.host(service), port + LISTENERS.index(service)


def configuration(service: str, port: int, where: Network) -> str:
    """JSON of a service's session, or of the operator's, in a cell whose first port is `port`."""
    if where.router:
        return _json("client", [], _connect([where.router], CLIENT_TRIES_MS, gives_up=True))
    own = listener(service, port, where)
    before = LISTENERS[: LISTENERS.index(service)] if service in LISTENERS else LISTENERS
    peers = [_endpoint(found) for other in before if (found := listener(other, port, where)) is not None]
    return _json("peer", [] if own is None else [_endpoint(own)], _connect(peers, -1, gives_up=False))


def router_configuration(listen: str) -> str:
    """JSON of a router's session, which makes no connection of its own."""
    return _json("router", [listen], _connect([], -1, gives_up=False))


def _endpoint(found: tuple[str, int]) -> str:
    host, port = found
    return f"tcp/{host}:{port}"


def _connect(endpoints: list[str], timeout_ms: int, *, gives_up: bool) -> dict[str, Any]:
    retry = {"period_init_ms": 50, "period_max_ms": 200, "period_increase_factor": 1.5}
    return {"endpoints": endpoints, "timeout_ms": timeout_ms, "exit_on_failure": gives_up, "retry": retry}


def _json(mode: str, listen: list[str], connect: dict[str, Any]) -> str:
    queue = {"size": dict.fromkeys(_PRIORITIES, _QUEUED_BATCHES)}
    return json.dumps(
        {
            "mode": mode,
            "listen": {"endpoints": listen},
            "connect": connect,
            "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}},
            "timestamping": {"enabled": False},
            "queries_default_timeout": 1000,
            "transport": {
                "shared_memory": {"enabled": False},
                "link": {"tx": {"lease": 500, "keep_alive": 4, "queue": queue}},
            },
        }
    )
