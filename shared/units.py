"""Unit factors and the rig's time base. Inside the rig everything is SI; these turn a printed number into SI.

Two suffixes name the unit of a joint, which depends on the link. `q` is the joint coordinate: rad where the joint turns, m where
it slides. `tau` is the generalised force on it: N m where the joint turns, N where it slides. So `kp_a_per_q` is in A/rad for the
links 1 and 2 and in A/m for link 3, `viscous_tau_s_per_q` in N m s/rad and N s/m. `q` and `qd` alone are position and velocity.
"""

import math

RAD_PER_DEG = math.pi / 180.0
A_PER_MA = 1e-3
A_PER_RAD_PER_MA_PER_DEG = A_PER_MA / RAD_PER_DEG  # gains of the thesis are printed in mA/deg

SUBSTEP_S = 50e-6  # 20 kHz: amplitudes and forces agree from 10 to 200 us, 1 ms diverges
SUBSTEP_NS = 50_000
NS_PER_S = 1_000_000_000
GRAVITY_M_PER_S2 = 9.81
