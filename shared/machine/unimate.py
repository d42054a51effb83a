"""The Unimate MKII-2000 of the thesis: every number that controller, supervisor and recorder need, with its source."""

from hydrohil.shared.machine.description import LINKS, Channel, Drive, Gauge, Geometry, MachineDescription, MotionBounds
from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG

_ZERO_CODE = 2048
_MIN_CODE, _MAX_CODE = 820, 3276  # what is left of 12 bits after the reduction
_A_PER_CODE = 600.0 * A_PER_MA / 2048.0  # full scale of the converter
_N_PER_FORCE_COUNT = 20.0 / 66.0 * 9.8 / 2.2  # the program's own scale; 4.4482 N/lb would give 1.348


def _encoder(name: str, unit: str, scale: float, offset: float, *, bits: int) -> Channel:
    """A counter: all of its codes may come."""
    return Channel(name=name, unit=unit, scale=scale, offset=offset, bits=bits, low=0, high=(1 << bits) - 1)


def _converter(link: str) -> Channel:
    """The D/A of a valve."""
    return Channel(
        name=link, unit="A", scale=_A_PER_CODE, offset=-_ZERO_CODE * _A_PER_CODE, bits=12, low=_MIN_CODE, high=_MAX_CODE
    )


UNIMATE = MachineDescription(
    name="unimate",
    title="Unimate MKII-2000",
    encoders=(  # Appendix F, `get_a_to_d`
        _encoder("rotate", "rad", 0.0281778 * RAD_PER_DEG, -113.5848 * RAD_PER_DEG, bits=13),
        _encoder("down_up", "rad", -0.0284006 * RAD_PER_DEG, 27.59 * RAD_PER_DEG, bits=11),
        _encoder("out_in", "m", 0.00105, -0.0052, bits=10),
        _encoder("roll", "count", 1.0, 0.0, bits=10),  # the program reads it and uses it nowhere
        _encoder("pitch", "rad", -0.113475 * RAD_PER_DEG, 3.797 * RAD_PER_DEG, bits=11),
    ),
    force=Channel(name="force", unit="N", scale=_N_PER_FORCE_COUNT, offset=0.0, bits=12, low=-2048, high=2047),
    converters=tuple(_converter(link) for link in LINKS),
    drive=Drive(  # Appendix F, `out_d_to_a`
        counts_per_a=2048.0 / (360.0 * A_PER_MA),  # scale of the program's u, from 7e4/rtd counts/deg = 215 mA/deg
        min_counts=-2048,
        max_counts=2047,
        numerator=3,  # "reduce response for amateur operator"
        denominator=5,
        zero_code=_ZERO_CODE,
        a_per_code=_A_PER_CODE,
    ),
    geometry=Geometry(  # Appendix F, `a2`, `a4`, `HighLimit`, `LowLimit`
        offset_m=0.13,
        hand_m=0.5,
        retracted_m=0.788,
        low_q=(-110 * RAD_PER_DEG, -30 * RAD_PER_DEG, 0.788 - 0.788),
        high_q=(110 * RAD_PER_DEG, 27 * RAD_PER_DEG, 1.828 - 0.788),
    ),
    gauge=Gauge(
        noise_n=10.0,  # "+-10 N of noise" (thesis 5.1.2), clipped there
        range_n=700.0,
        stiffness_n_per_m=46_000.0,  # Appendix E
        damping_ns_per_m=600.0,
        quiet_counts=1,  # 23 % of its neighbours; 16 in a row: once in 1e10
    ),
    motion=MotionBounds(
        # A quarter above 24 and 21 deg/s and 0.38 m/s at the converter's end (360 mA) without load: weight, null bias and a
        # supply of 7.5 MPa give 24.3 and 22.7 deg/s and 0.42 m/s. Pitch is not driven.
        full_speed=(30 * RAD_PER_DEG, 30 * RAD_PER_DEG, 0.5, 30 * RAD_PER_DEG),
        # Against break-away friction with the pressure left the wrong way round, weight, 334 N at full reach, a supply of
        # 6.5 MPa. Table 2 has 88 / 88..114 / 141..176 mA.
        moves_down_a=(140 * A_PER_MA, 150 * A_PER_MA, 190 * A_PER_MA),  # right, up, in
        moves_up_a=(140 * A_PER_MA, 140 * A_PER_MA, 160 * A_PER_MA),  # left, down, out
        moves_within_ns=200_000_000,
        brakes_q=(1.3 * RAD_PER_DEG, 0.6 * RAD_PER_DEG, 0.006),
        tip_count_m=1.5e-3,  # one count of link 3 (1.05 mm) and half of one of link 2 at 1.8 m
    ),
    supply_low_pa=6.5e6,  # 7000 +- 500 kPa
    supply_high_pa=7.5e6,
)

MACHINES = {UNIMATE.name: UNIMATE}  # by the name that an experiment gives
