from hydrohil.claims.pairs import PairClaim
from hydrohil.thesis import beyond_position, chapter4
from hydrohil.thesis.library import find


def test_every_pattern_is_there_for_the_robust_law_and_differs_in_the_law_only():
    for pattern in chapter4.PATTERNS:
        robust, final = find(f"robust-{pattern}"), find(f"final-{pattern}")
        assert robust.controller.law == "robust"
        assert robust.controller._replace(law="final") == final.controller
        assert (robust.plant, robust.reference, robust.duration_s) == (final.plant, final.reference, final.duration_s)


def test_the_force_trials_are_there_for_the_torque_law_and_differ_in_the_law_only():
    for figure in ("fig-5-5", "fig-5-6", "fig-5-7", "fig-5-8"):
        final = find(figure)
        aware = find(f"torque-{final.alias}")
        assert aware.controller.law == "torque"
        assert aware.controller._replace(law="final") == final.controller
        assert (aware.plant, aware.reference, aware.duration_s) == (final.plant, final.reference, final.duration_s)


def test_a_new_law_is_set_against_the_final_law_in_the_same_trial():
    for pair in beyond_position.PAIRS:
        assert isinstance(pair, PairClaim)
        new, final = find(pair.of), find(pair.against)
        assert (new.plant, new.reference) == (final.plant, final.reference)
        assert (new.controller.law in ("robust", "torque"), final.controller.law) == (True, "final")


def test_what_is_stated_of_the_final_law_is_asked_of_the_robust_law_but_for_its_difficulty():
    for pattern in chapter4.PATTERNS:
        stated = {claim.statement for claim in find(f"final-{pattern}").claims}
        claimed = {claim.statement for claim in find(f"robust-{pattern}").claims}
        assert stated - claimed <= {"Below 0.2 deg peak to peak it has difficulty"}
