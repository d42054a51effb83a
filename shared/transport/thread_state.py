"""Python's state of the transport's threads, kept: made anew for each callback, as it is by default, it costs more than one."""

import ctypes
import threading

_thread = threading.local()


def keep_thread_state() -> None:
    """Keep the state of the calling thread, which Python did not start, as long as that thread lives."""
    if not hasattr(_thread, "kept"):
        _thread.kept = ctypes.pythonapi.PyGILState_Ensure()
