"""The mark for functions that run plain in a service and compiled in the plant's sub-steps and in a rollout.

Marking costs nothing and imports nothing: a service that computes once per sample stays plain Python and starts
fast. `compiled` turns a marked function, and every marked function it calls, into machine code.

Plain and compiled agree bit for bit as long as kernels write x * x rather than x ** 2, avoid math.hypot, start
floats as floats and check their domain before sqrt, exp, log and int.
"""

import hashlib
import os
import platform
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import hydrohil
from hydrohil.shared import cache

Function = TypeVar("Function", bound=Callable[..., Any])

_marked: list[Callable[..., Any]] = []
_registered = 0
_PACKAGE = Path(hydrohil.__file__).parent
RECURSION = 10_000  # inference descends some twenty frames a nested call, and the supervisor's rules nest thirty deep
KERNEL_FOLDERS = ("shared", "services/plant", "services/controller", "services/supervisor", "simulation")  # where kernels may be


def kernel(function: Function) -> Function:
    """Mark a pure function as compilable; it is returned as it is."""
    _marked.append(function)
    return function


def source_version() -> str:
    """SHA-256 (16 hex digits) over every source file: names the code that produced a result."""
    return _hash_of(("",))


def kernel_version() -> str:
    """The same over every file that a kernel may be in or take a constant from: names the machine code."""
    return _hash_of(KERNEL_FOLDERS)


def _hash_of(folders: tuple[str, ...]) -> str:
    digest = hashlib.sha256()
    for folder in folders:
        for path in sources(folder):
            digest.update(str(path.relative_to(_PACKAGE)).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def sources(folder: str = "") -> list[Path]:
    """Every source file of the package, or of one of its folders; in a clone two of them are links."""
    found = (Path(top) / name for top, _, names in os.walk(_PACKAGE / folder, followlinks=True) for name in names)
    return sorted(path for path in found if path.suffix == ".py")


def point_cache_at_sources() -> None:
    """Key numba's cache folder by every source of a kernel: its own key misses a callee that changed in another file."""
    machine = hashlib.sha256(f"{platform.machine()}{platform.processor()}{platform.python_version()}".encode())
    os.environ["NUMBA_CACHE_DIR"] = str(cache.folder() / "kernels" / f"{kernel_version()}-{machine.hexdigest()[:8]}")


def compiled(function: Function) -> Function:
    """`function` as machine code. Call it after every module whose kernels it uses has been imported.

    What it calls is inlined: passed on to a function of its own, the tuples of state and parameters are up to a hundred numbers
    that go over the stack at every call.
    """
    global _registered
    if not _registered:
        point_cache_at_sources()
    import numba  # here, so that a service that compiles nothing starts without it
    from numba.extending import register_jitable

    for marked in _marked[_registered:]:
        register_jitable(forceinline=True, no_cfunc_wrapper=True)(marked)
    sys.setrecursionlimit(max(sys.getrecursionlimit(), RECURSION))
    _registered = len(_marked)
    machine_code: Function = numba.njit(cache=True, error_model="python")(function)
    return machine_code
