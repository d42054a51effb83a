"""The matrix: what can break, what must happen, within which bound, and how each row is tried.

T is the sample period, the lease the longest age of a command or permit. Safe: D/A at zero current, arming revoked, the permit
withdrawn and latched.
"""

from collections.abc import Iterable

from hydrohil.faulttest.matrix_machine import MACHINE
from hydrohil.faulttest.matrix_operator import OPERATOR
from hydrohil.faulttest.matrix_processes import PROCESSES
from hydrohil.faulttest.matrix_wire import WIRE
from hydrohil.faulttest.trial import Row

MATRIX: tuple[Row, ...] = (*PROCESSES, *WIRE, *MACHINE, *OPERATOR)


def find_rows(numbers: Iterable[str]) -> tuple[Row, ...]:
    """Rows of these numbers in the order of the matrix; all, if none is asked for. Raises LookupError with one line."""
    wanted, known = set(numbers), [row.number for row in MATRIX]
    if unknown := sorted(wanted - set(known)):
        raise LookupError(f"{', '.join(unknown)}: no fault of the battery: expected one of {', '.join(known)}")
    return tuple(row for row in MATRIX if not wanted or row.number in wanted)
