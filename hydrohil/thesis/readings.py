"""How words and numbers of a source become bands, the same for every study; `hydrohil.thesis.claims4` does it for trials."""

from hydrohil.claims.claims import Unit, Verdict, verdict
from hydrohil.claims.study import Statement

TENTH = 0.1  # "good", "closely", "large", "appreciable", "much", "near zero" begin, or end, at a tenth
HALF = 0.5  # "clearly visible", "greatly": at least half


def about(words: str, unit: Unit, number: float, share: float, measured: float, source: str) -> Verdict:
    """`measured` within `share` of a stated number."""
    reach = abs(number) * share
    return verdict(
        Statement(words, comparison="within", unit=unit, low=number - reach, high=number + reach, source=source), measured
    )


def printed(words: str, unit: Unit, number: float, digit: float, measured: float, source: str) -> Verdict:
    """`measured` rounds to the printed number, whose last digit is worth `digit`."""
    return verdict(
        Statement(words, comparison="within", unit=unit, low=number - digit / 2.0, high=number + digit / 2.0, source=source),
        measured,
    )


def above(words: str, unit: Unit, low: float, measured: float, source: str) -> Verdict:
    """`measured` is `low` or more."""
    return verdict(Statement(words, "above", unit, low=low, source=source), measured)


def below(words: str, unit: Unit, high: float, measured: float, source: str) -> Verdict:
    """`measured` is `high` or less."""
    return verdict(Statement(words, "below", unit, high=high, source=source), measured)
