"""The record of this host that `hydrohil qualify` has written, for arming, recordings and reports.

A record counts for the host, boot, kernel, processor and scheduling class that it was measured with, and for no other: a boot may
bring another kernel, other firmware settings or other isolated processors.
"""

import hashlib
import json
import os
import platform
from functools import cache as cache_once
from pathlib import Path
from typing import Any, NamedTuple

from hydrohil.shared import cache
from hydrohil.shared.contract.envelope import checked
from hydrohil.shared.units import NS_PER_S

NOT_QUALIFIED = "not qualified: `hydrohil qualify` measures what this host bears"
_BOOT_ID = Path("/proc/sys/kernel/random/boot_id")
_CPU_INFO = Path("/proc/cpuinfo")


class Host(NamedTuple):
    """What a record is bound to."""

    hostname: str
    boot_id: str
    kernel: str
    processor: str
    cores: int


class Qualified(NamedTuple):
    """A record in short: the rate that is qualified, and the key figures of the trial that decided it."""

    qualified_period_ns: int  # shortest sampling period that is qualified; 0 = none
    grade: str
    measured_at: str  # date and time
    period_ns: int  # of the trial that decided
    samples: int
    late_share: float | None  # of them, taken or answered late; None = not measured, as below
    accepted_p999_us: float | None  # sample -> accepted command
    wake_up_max_us: float | None
    lease_ms: float | None  # that this host needs


class Standing(NamedTuple):
    """What is known of this host, and in words."""

    qualified: Qualified | None
    words: str


UNKNOWN = Standing(None, NOT_QUALIFIED)


@cache_once
def this_host() -> Host:
    """The host that this process runs on."""
    lines = _read(_CPU_INFO).splitlines()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    processor = names[0] if names else platform.processor() or platform.machine()
    return Host(platform.node(), _read(_BOOT_ID).strip(), platform.release(), processor, os.cpu_count() or 0)


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:
        return ""


def record_file(host: Host, *, fifo: bool) -> Path:
    """Where the record of a host and scheduling class is."""
    key = hashlib.sha256(json.dumps([*host, fifo]).encode()).hexdigest()[:16]
    return cache.folder() / "qualifications" / f"{key}.json"


def standing(*, fifo: bool) -> Standing:
    """What is on record of this host, by whether it grants real-time scheduling."""
    host = this_host()
    path = record_file(host, fifo=fifo)
    try:
        return of_plain(_summary(path, host))
    except FileNotFoundError:
        return UNKNOWN
    except (OSError, ValueError, RecursionError) as error:
        return Standing(None, f"not qualified: {path} cannot be used ({error}); `hydrohil qualify` writes it anew")


def _summary(path: Path, host: Host) -> Any:
    """The summary of a record. Raises FileNotFoundError, OSError, or ValueError where it is none, or another host's."""
    record = json.loads(path.read_text())
    if not isinstance(record, dict) or record.get("host") != host._asdict() or not isinstance(record.get("summary"), dict):
        raise ValueError("it is no record of this host")
    return record["summary"]


def plain(known: Standing) -> dict[str, Any] | None:
    """The same for a status, a request or a report; None is a host that is not qualified."""
    return None if known.qualified is None else known.qualified._asdict()


def of_plain(values: Any) -> Standing:
    """What a record, a status or a request says; None is a host that is not qualified. Raises ValueError naming the field."""
    if values is None:
        return UNKNOWN
    found: Qualified = checked(values, "qualification", Qualified)
    if found.qualified_period_ns < 0 or found.period_ns <= 0:
        raise ValueError(f"qualification: {found.qualified_period_ns} and {found.period_ns} ns are no sampling periods")
    return Standing(found, words(found))


def hertz(period_ns: int) -> str:
    """A rate for people."""
    return f"{NS_PER_S / period_ns:.4g} Hz"


def words(found: Qualified) -> str:
    """Grade, qualified rate, key figures and date in a line."""
    qualified = f"qualified for {hertz(found.qualified_period_ns)}" if found.qualified_period_ns else "no rate is qualified"
    late = f"{_amount(found.late_share, '%', 100.0)} of {found.samples} samples late at {hertz(found.period_ns)}"
    p999 = _amount(found.accepted_p999_us, " ms", 1e-3)
    worst, lease = _amount(found.wake_up_max_us, " ms", 1e-3), _amount(found.lease_ms, " ms", 1.0)
    figures = f"{late}, sample to command p99.9 {p999}, worst wake-up {worst}, lease {lease}"
    return f"{qualified}, grade {found.grade} ({found.measured_at}): {figures}"


def _amount(value: float | None, unit: str, factor: float) -> str:
    return "-" if value is None else f"{value * factor:.3g}{unit}"


def beyond(found: Qualified | None, period_ns: int) -> str:
    """Why a rate may not be armed on this host: it is above the one qualified. "" where it may, or nothing is on record."""
    if found is None or 0 < found.qualified_period_ns <= period_ns:
        return ""
    qualified, lower = "qualified for no rate", ""
    if found.qualified_period_ns:
        qualified, lower = f"qualified for at most {hertz(found.qualified_period_ns)}", ", a lower rate,"
    return (
        f"plant.sample_period_substeps asks for {hertz(period_ns)}, and this host is {qualified} ({found.measured_at}): "
        f"`hydrohil qualify` again{lower} or `--unqualified`"
    )
