"""Arithmetic in one swept value: how a quantity with a name of its own reaches the fields that it decides."""

import ast
import math
import operator
from collections.abc import Callable
from functools import lru_cache
from typing import Any

VALUE = "value"
_TWO: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_ONE: dict[type, Callable[[Any], Any]] = {ast.UAdd: operator.pos, ast.USub: operator.neg}


@lru_cache(maxsize=256)
def parsed(text: str) -> ast.expr:
    """The formula as a tree of + - * / ** ( ), numbers and `value`. Raises ValueError for anything else."""
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except SyntaxError:
        raise ValueError(f"{text!r} is no formula: write arithmetic such as 0.15 / {VALUE} + 0.2") from None
    _check(tree, text)
    return tree


def _check(node: ast.expr, text: str) -> None:
    if isinstance(node, ast.BinOp) and type(node.op) in _TWO:
        _check(node.left, text)
        _check(node.right, text)
    elif isinstance(node, ast.UnaryOp) and type(node.op) in _ONE:
        _check(node.operand, text)
    elif not (isinstance(node, ast.Name) and node.id == VALUE) and not (
        isinstance(node, ast.Constant) and type(node.value) in (int, float)
    ):
        raise ValueError(f"{text!r}: {ast.unparse(node)} is not allowed; use numbers, {VALUE}, + - * / ** and parentheses")


def evaluate(text: str, value: Any) -> Any:
    """The formula at `value`; `value` alone passes anything. Raises ValueError where the result is no finite number."""
    tree = parsed(text)
    if isinstance(tree, ast.Name):
        return value
    try:
        result = _of(tree, value)
    except (ArithmeticError, TypeError) as reason:
        raise ValueError(f"{text!r} at {value!r}: {reason}") from None
    if not isinstance(result, int | float) or not math.isfinite(result):
        raise ValueError(f"{text!r} at {value!r} gives {result}: expected a finite number")
    return float(result)


def _of(node: ast.expr, value: Any) -> Any:
    if isinstance(node, ast.BinOp):
        return _TWO[type(node.op)](_of(node.left, value), _of(node.right, value))
    if isinstance(node, ast.UnaryOp):
        return _ONE[type(node.op)](_of(node.operand, value))
    return node.value if isinstance(node, ast.Constant) else value
