"""All rules, most severe first; the first broken decides."""

from collections.abc import Callable

from hydrohil.services.supervisor.force_rules import FORCE_RULES
from hydrohil.services.supervisor.link_rules import LINK_RULES
from hydrohil.services.supervisor.motion_rules import MOTION_RULES
from hydrohil.services.supervisor.rule import Limits, Number, Observed, Rule, Verdict
from hydrohil.services.supervisor.transport_rules import TRANSPORT_RULES
from hydrohil.shared.compiled.kernel import kernel

Broken = tuple[int, float, float]  # cause, measured, limit; all zero if nothing is

RULES = tuple(sorted((*FORCE_RULES, *MOTION_RULES, *TRANSPORT_RULES, *LINK_RULES), key=lambda rule: rule.cause))


def fold(rules: tuple[Rule, ...]) -> Callable[[Observed, Limits], Broken]:
    """One kernel of all rows: (cause, measured, limit) of the first that does not hold, (0, 0, 0) if all do."""
    chain: Callable[[Observed, Limits], Broken] = _nothing_broken
    for rule in reversed(rules):
        chain = _before(rule.holds, int(rule.cause), kernel(rule.measured), kernel(rule.limit), chain)
    return chain


@kernel
def _nothing_broken(observed: Observed, limits: Limits) -> Broken:
    return 0, 0.0, 0.0


def _before(
    holds: Verdict, cause: int, measured: Number, limit: Number, rest: Callable[[Observed, Limits], Broken]
) -> Callable[[Observed, Limits], Broken]:
    @kernel
    def first_broken(observed: Observed, limits: Limits) -> Broken:
        if not holds(observed, limits):
            return cause, measured(observed, limits), limit(observed, limits)
        return rest(observed, limits)

    return first_broken


first_broken = fold(RULES)
