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
from hydrohil.shared.errors import HydrohilError

MATRIX: tuple[Row, ...] = (*PROCESSES, *WIRE, *MACHINE, *OPERATOR)


class UnknownRowError(HydrohilError, LookupError):
    """A number that no row of the matrix has; the message lists those that there are."""


def find_rows(numbers: Iterable[str]) -> tuple[Row, ...]:
    """Rows of these numbers in the order of the matrix; without numbers all of them. Raises UnknownRowError."""
    requested, known = set(numbers), [row.number for row in MATRIX]
    if unknown := sorted(requested - set(known)):
        raise UnknownRowError(f"{', '.join(unknown)}: no row of the fault test: expected one of {', '.join(known)}")
    return tuple(row for row in MATRIX if not requested or row.number in requested)
