"""Values kept in the form that compiled code reads: a plain tuple is converted again at each call, 0.1 us a number."""

from typing import Any

from hydrohil.shared.compiled.kernel import point_cache_at_sources

point_cache_at_sources()  # before numba is imported, which looks only then

import numba  # noqa: E402
from numba.experimental import structref  # noqa: E402


@structref.register
class _Type(numba.types.StructRef):  # type: ignore[misc]
    """Its type in compiled code."""


class CompiledValue(structref.StructRefProxy):  # type: ignore[misc]
    """One value, such as a tuple of parameters; compiled code reads it as `value`."""


structref.define_proxy(CompiledValue, _Type, ["value"])


@numba.njit(cache=True)  # type: ignore[untyped-decorator]
def compiled_value(value: Any) -> Any:
    """Convert `value` once."""
    return CompiledValue(value)
