"""Formulas of one value: arithmetic, and nothing else."""

import pytest

from hydrohil.campaign.formula import evaluate


@pytest.mark.parametrize(
    ("text", "value", "result"),
    [
        ("2 * value + 1", 3.0, 7.0),
        ("-(value - 1) / 4", 3, -0.5),
        ("value ** 2", 3.0, 9.0),
        ("value * 46e3 / (value + 46e3)", 46e3, 23e3),
        ("1", 9.0, 1.0),
    ],
)
def test_arithmetic_is_done(text: str, value: float, result: float):
    assert evaluate(text, value) == result


def test_value_alone_passes_anything():
    assert evaluate("value", "pi") == "pi"


@pytest.mark.parametrize(
    "text", ["__import__('os')", "value.real", "[value]", "value if value else 1", "other", "value +", "", "'a'"]
)
def test_anything_else_is_refused(text: str):
    with pytest.raises(ValueError, match="value"):
        evaluate(text, 1.0)


@pytest.mark.parametrize(
    ("text", "value"), [("1 / value", 0.0), ("value ** 0.5", -1.0), ("10.0 ** value", 400.0), ("2 * value", "pi")]
)
def test_what_is_no_finite_number_is_refused(text: str, value: object):
    with pytest.raises(ValueError, match=r"pi|0|-1|400"):
        evaluate(text, value)
