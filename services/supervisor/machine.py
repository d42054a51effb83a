"""What the supervisor knows of the machine besides its channel tables: physical bounds that no experiment changes."""

from hydrohil.shared.contract.pose import UNIMATE_GEOMETRY, Triple
from hydrohil.shared.units import A_PER_MA, RAD_PER_DEG

NOISE_N = 10.0  # "+-10 N of noise" (thesis 5.1.2), clipped there
GAUGE_RANGE_N = 700.0
GAUGE_N_PER_M = 46_000.0  # Appendix E: in series with whatever it touches, so no environment pushes back stiffer
GAUGE_NS_PER_M = 600.0  # its damping, beside the spring
TOUCH_N = 15.0  # the thesis' trials begin with the tool resting on the plate at 12 N while the bias is taken
LOOSE_M_PER_S = 0.03  # a crate that breaks loose runs ahead: (232 - 182 N) / sqrt(46 kN/m 64 kg)  (thesis 5.5)
COUNT_M = 1.5e-3  # of the tip, along one axis: one count of link 3 (1.05 mm) and half of one of link 2 at 1.8 m

FULL_SPEED = (30 * RAD_PER_DEG, 30 * RAD_PER_DEG, 0.5, 30 * RAD_PER_DEG)  # rotate, down/up, out/in (m/s), pitch
# A quarter above 24 and 21 deg/s and 0.38 m/s at the converter's end (360 mA) without load: weight, null bias and a supply
# of 7.5 MPa give 24.3 and 22.7 deg/s and 0.42 m/s. Pitch is not driven.

# Current that moves a link by one count within 200 ms whatever stands against it: break-away friction with the pressure
# left the wrong way round, weight, 334 N at full reach, a supply of 6.5 MPa. Table 2 has 88 / 88..114 / 141..176 mA.
MOVES_DOWN_A = (140 * A_PER_MA, 150 * A_PER_MA, 190 * A_PER_MA)  # towards smaller q: right, up, in
MOVES_UP_A = (140 * A_PER_MA, 140 * A_PER_MA, 160 * A_PER_MA)  # towards greater q: left, down, out
MOVES_WITHIN_NS = 200_000_000
BRAKES = (1.3 * RAD_PER_DEG, 0.6 * RAD_PER_DEG, 0.006)  # way on from full speed once such a current stands against it
AT_STOP_COUNTS = 2.0
TRAVEL_LOW: Triple = UNIMATE_GEOMETRY.low_q
TRAVEL_HIGH: Triple = UNIMATE_GEOMETRY.high_q

QUIET_NS = 100_000_000  # a gauge without its noise is found within this
QUIET_COUNTS, FEWEST_QUIET = 1, 16  # readings that differ by one count: 23 % of its neighbours; 16 in a row: once in 1e10
