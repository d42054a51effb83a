"""What chapter 6 of the thesis says of each trial and of each pair of trials, as bands; its words are read once, here.

"A very high correlation" is 0.9 and more, the usual grading of a coefficient. "Very closely" is two encoder counts, the limit
of the positioning ability, and the force of two counts on k_eff: a fiftieth of the step, as in chapter 4, would be finer than
the encoder. "Approximate" levels are true to a twentieth of the step. Limit cycles are recognised as in chapter 7.
"""

from hydrohil.claims.bands import Measure, at_least, at_most, between
from hydrohil.claims.claims import Claim
from hydrohil.claims.pairs import PairClaim
from hydrohil.claims.signals import COUNT_Q
from hydrohil.shared.units import RAD_PER_DEG
from hydrohil.thesis import claims7
from hydrohil.thesis.chapter5 import SOFT_ESTIMATE_N_PER_M

STEP_S, STEP_N = 2.0, 100.0
END_S = 12.0
STEADY_S = 10.0
RISEN_S = 7.0  # three time constants after the step
TWENTIETH = 0.05
VERY_HIGH = 0.9
TWO_COUNTS_DEG = 2.0 * COUNT_Q[1] / RAD_PER_DEG
TWO_COUNTS_N = 2.0 * COUNT_Q[1] * SOFT_ESTIMATE_N_PER_M  # at a lever of 1 m

_LEVELS = (
    'thesis 6.3: "for model stiffnesses of 50, 500, and 5000N/m are 99N, 92N, and 55N, respectively. These are indeed the '
    'approximate steady-state levels attained in both impedance and force control trials."'
)
_SHARED = (
    'thesis 6.3: "As the model stiffness is increased, it will bear a greater fraction of the virtually-imposed set-point force."'
)
_CORRELATED = (
    'thesis 6.3: "The plots show a very high correlation between the response of the impedance controller and that of the '
    'proposed equivalent force controller."'
)
_CLOSE = 'thesis 6.3: "Force, position, and even control signal histories compare very closely."'
_ACTIONS = 'thesis 6.3: "both controllers take the same actions at the same times, showing their equivalence."'
_NOISY = (
    'thesis 6.3: "The impedance controller signal is relatively steady but moves in steps"; "the explicit force controller '
    'signal is noisy because the force signal is noisy."'
)
_SAME_SET_POINT = (
    'thesis 6.2.2: "Filling in the values for the model transfer functions M_x and M_F shows that the same expressions for F_d '
    'are obtained in both formulations."'
)
_NO_STEADY_STATE = (
    "thesis 6.2.2: \"the filter for the second formulation's equivalent controller has no finite steady-state. This has direct "
    'consequences for the stability of this formulation that differ considerably from those of the first formulation."; 9.3.3: '
    '"it is not known whether or not the constraint on target stiffness selection also applies to the alternate formulation."'
)
_STICTION = (
    'thesis 6.2.2: "the motion of the set-point is affected by the current position, as well as the current force. Thus, it is '
    'doubly susceptible to nonlinear effects such as stiction."'
)
_STIFF_IS_STABLE = (
    'thesis 7.3: "The only way to assure that these limit cycles will not occur is to set the target stiffness to be greater '
    'than double the effective environmental stiffness."'
)

FIGURES = {50.0: ("6-6", "6-7", 99.0), 500.0: ("6-8", "6-9", 92.0), 5000.0: ("6-10", "6-11", 55.0)}  # stated level in N


def _level(level_n: float, start_s: float, end_s: float, source: str) -> Claim:
    words, band_n = f"The force ends near {level_n:g} N", TWENTIETH * STEP_N
    return between(words, Measure("mean", "force", "N", start_s, end_s), level_n - band_n, level_n + band_n, source)


def _cycling(source: str) -> Claim:
    """More than one cycle in the second half."""
    return at_least("The link cycles", Measure("cycles", "q2", "counts", claims7.HALF_S, claims7.END_S), 2.0, source)


def _prolonged(stiffness_n_per_m: float) -> tuple[Claim, ...]:
    """The set-point keeps integrating: limit cycles at every stiffness, around the same force as by the first formulation."""
    level_n = round(STEP_N * SOFT_ESTIMATE_N_PER_M / (stiffness_n_per_m + SOFT_ESTIMATE_N_PER_M))
    return (_level(level_n, claims7.HALF_S, claims7.END_S, _SAME_SET_POINT), _cycling(_NO_STEADY_STATE))


_RESTS = at_most(
    "There is no limit cycle", Measure("cycles", "q2", "counts", claims7.RESPONSE_S, claims7.END_S), 0.0, _STIFF_IS_STABLE
)
CLAIMS: dict[str, tuple[Claim, ...]] = {
    **{
        f"fig-{figure}": (_level(level_n, STEADY_S, END_S, _LEVELS),)
        for *figures, level_n in FIGURES.values()
        for figure in figures
    },
    **{f"alternate-k{k:.0f}": _prolonged(k) for k in (50.0, 500.0, 5000.0, 50e3)},
    "alternate-free-space": (_cycling(_STICTION),),
    "proposed-k50000": (_RESTS, _RESTS._replace(statement="The link rests", metric="peak_to_peak_counts", high=2.0)),
}


def _alike(impedance: str, explicit: str) -> tuple[PairClaim, ...]:
    """The equivalent controller set against the impedance controller."""
    force = PairClaim(
        "The force follows the same course",
        of=f"fig-{explicit}",
        against=f"fig-{impedance}",
        measure="correlation",
        channel="force",
        comparison="above",
        start_s=0.0,
        end_s=END_S,
        unit="1",
        low=VERY_HIGH,
        source=_CORRELATED,
    )
    control = force._replace(
        statement="The control follows the same course", measure="control_correlation", channel="q2", source=_CLOSE
    )
    apart = force._replace(measure="rms_difference", comparison="below", low=0.0, source=_CLOSE)
    return (
        force,
        force._replace(statement="The link follows the same course", channel="q2"),
        control,
        control._replace(
            statement="While the force rises the controls act alike", start_s=STEP_S, end_s=RISEN_S, source=_ACTIONS
        ),
        apart._replace(statement="The forces lie within two counts of travel", unit="N", high=TWO_COUNTS_N),
        apart._replace(statement="The links lie within two counts", channel="q2", unit="deg", high=TWO_COUNTS_DEG),
        force._replace(
            statement="The explicit controller's signal is the noisier",
            measure="metric_ratio",
            metric="control_noise",
            channel="q2",
            low=1.0,
            source=_NOISY,
        ),
    )


def _less_force(of: str, against: str) -> PairClaim:
    """A stiffer model leaves less of the set-point to the environment."""
    return PairClaim(
        "The stiffer model bears more of the set-point",
        of=f"fig-{of}",
        against=f"fig-{against}",
        measure="metric_ratio",
        channel="force",
        comparison="below",
        start_s=STEADY_S,
        end_s=END_S,
        unit="1",
        metric="mean",
        high=1.0,
        source=_SHARED,
    )


PAIRS: tuple[PairClaim, ...] = (
    *(claim for impedance, explicit, _ in FIGURES.values() for claim in _alike(impedance, explicit)),
    _less_force("6-8", "6-6"),
    _less_force("6-10", "6-8"),
    _less_force("6-9", "6-7"),
    _less_force("6-11", "6-9"),
)
