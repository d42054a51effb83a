"""What the supervisor says of a trip, for those who may not import the supervisor."""

from typing import Protocol

from hydrohil.services.supervisor.rules import trip_words
from hydrohil.shared.contract.messages import TripCause


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
    """What no longer held, the number against its limit, and the sample at which it was found."""
    return trip_words(TripCause(trip.cause), trip.measured, trip.limit, trip.trip_number)
