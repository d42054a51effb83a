"""Keep Python's state of the transport's threads: by default it is created anew for each callback, which costs 14 us a frame."""

import ctypes
import threading

_thread = threading.local()


def keep_thread_state() -> None:
    """Keep the Python state of the calling thread, which Python did not start, as long as the thread lives."""
    if not hasattr(_thread, "kept"):
        _thread.kept = ctypes.pythonapi.PyGILState_Ensure()
