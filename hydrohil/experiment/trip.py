"""The words of a trip from whatever holds one."""

from typing import Protocol

from hydrohil.shared.trips.causes import trip_words


class Trip(Protocol):
    """What a permit and the supervisor's memory both hold of a trip."""

    @property
    def cause(self) -> int: ...  # noqa: D102
    @property
    def measured(self) -> float: ...  # noqa: D102
    @property
    def limit(self) -> float: ...  # noqa: D102
    @property
    def trip_number(self) -> int: ...  # noqa: D102


def trip_line(trip: Trip) -> str:
    """What happened with its numbers and units, and the sample."""
    return trip_words(trip.cause, trip.measured, trip.limit, trip.trip_number)
