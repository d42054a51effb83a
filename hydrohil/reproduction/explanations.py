"""Why a claim does not hold: the best explanation that is known, a figure and a statement at a time.

A claim that fails without a row here is reported as unexplained.
"""

from typing import NamedTuple


class Deviation(NamedTuple):
    """Statements of figures that one cause explains."""

    of: tuple[tuple[str, str], ...]  # figure, statement
    why: str


DEVIATIONS: tuple[Deviation, ...] = (
    Deviation(
        (("fig-4-4", "The ramp's end is overshot"), ("fig-4-9", "The ramp's end is overshot")),
        "On this plant the link stops short of the small ramp's end instead of overshooting it: after the break-away it is "
        "still catching up when the set-point stops. The text states the overshoot of ramps without saying of which; the "
        "large ramp shows it.",
    ),
    Deviation(
        (("fig-4-6", "PI's error on the sine is five times as large"),),
        "PI's error cannot be much larger than the signal itself (99 %), so a factor of five asks the final law for less than "
        "22 %, which at 1 Hz is a lag of 35 ms. The final law follows the sine down to 0.2 deg, but about 60 ms late: valve, "
        "oil and the 43 ms by which the 20-point velocity lags. The ramps show the factor.",
    ),
    Deviation(
        (
            ("deadband-small-ramp", "The control bangs from side to side"),
            ("deadband-small-step", "The control bangs from side to side"),
            ("deadband-sine", "The control bangs from side to side"),
        ),
        "The control does bang, but seldom: a jump out of stiction ends inside the law's dead zone of two counts, which "
        "stops the exchange. The number of reversals that stands for 'rapid' is a reading; the text has no figure.",
    ),
    Deviation(
        (("fig-4-23", "The ramp's end is not overshot"), ("fig-4-23", "It rests within two counts")),
        "Motion at 0.25 deg/s is stick-slip; the last jump of about 0.1 deg happens to end 2.7 counts beyond the ramp's end, "
        "where the integral is too small to break the friction again. The text has 1 or 2 counts.",
    ),
    Deviation(
        (
            ("fig-5-9", "The control does not bang while the tool presses down"),
            ("fig-5-11", "The control does not bang while the tool presses down"),
        ),
        "A jump out of stiction of 1 to 2 mm is tens of newtons on a stiff plate. Friction strong enough for the limit cycles "
        "of chapter 7 makes this contact chatter; the text claims both.",
    ),
    Deviation(
        (("fig-5-9", "The circle is matched in free space"),),
        "On average 2.0 mm is the largest distance against a band of 2.4 mm, which is little more than two counts of link 3 (2.1 "
        "mm): in one seed of ten a single jump out of stiction goes beyond.",
    ),
    Deviation(
        (
            ("fig-6-7", "The force ends near 99 N"),
            ("fig-6-9", "The force ends near 92 N"),
            ("fig-6-11", "The force ends near 55 N"),
        ),
        "One jump out of stiction, 1.5 mm, is 9 N on 6.2 kN/m. Where within it the link comes to rest depends on the seed: mean "
        "103, 95 and 58 N, standard deviation 2 N, against levels of 99, 92 and 55 +- 5 N. The impedance controller, whose error "
        "is thresholded, rests nearer: 100, 93, 54 N.",
    ),
    Deviation(
        (
            ("fig-6-7", "The control follows the same course"),
            ("fig-6-9", "The control follows the same course"),
            ("fig-6-11", "The control follows the same course"),
        ),
        "Force and position agree (correlation 0.997 and more, within two counts), the controls only while the link moves: at "
        "rest the impedance controller's error is thresholded and its integral stands, while the explicit controller's goes on "
        "with the noise and the offset of the force.",
    ),
    Deviation(
        (
            ("fig-6-7", "While the force rises the controls act alike"),
            ("fig-6-9", "While the force rises the controls act alike"),
            ("fig-6-11", "While the force rises the controls act alike"),
        ),
        "0.90 to 0.93 on average: both act alike, but the explicit signal carries the noise of the gauge, five to eight times "
        "that of the other, and single jumps out of stiction come at other instants.",
    ),
    Deviation(
        (("fig-5-11", "It has died before the plate is struck again"),),
        "On the border: what is left is 1.0 mm (standard deviation 0.35 mm) against a band of two encoder counts, 0.99 mm. The "
        "chatter on the stiff plate leaves the target model moving a little longer.",
    ),
    Deviation(
        (("fig-5-13", "The mean force is 140 N"), ("fig-5-13", "The tool lags by about 3 cm")),
        "140 N does not slide 64 kg: the dry friction is mu m g = 0.29 x 64 kg x 9.81 m/s2 = 182 N, which is what is measured, "
        "and 182 N on 5 kN/m is the lag of 3.6 cm. The text's mass, friction and force do not agree with each other.",
    ),
    Deviation(
        (("fig-5-13", "The force oscillates for about 5 s"),),
        "Stick-slip of the crate: single events are chaotic, and how long they last depends on the seed (1.9 to 6.6 s).",
    ),
    Deviation(
        (("fig-5-13", "The tool backs up for another go"),),
        "The loose gripper's damping (600 N s/m, assumed), without which the oscillation of crate and gauge never dies, takes "
        "the energy of the first strike; no rebound is left that exceeds two counts.",
    ),
    Deviation(
        (("fig-5-14", "There is a single spike of force"),),
        "At 0.04 m/s some seeds add stick-slip to the one impact; at 0.05 m/s there is a single spike, but then the impedance "
        "controlled push oscillates for less than 5 s. The speed is not in the text, and one speed serves both.",
    ),
    Deviation(
        tuple(
            (f"fig-7-{n}", words)
            for n in (1, 2)
            for words in ("The cycles are of about 3 mm", "The cycles are of about 0.17 deg of up/down motion")
        ),
        "A cycle is one jump out of stiction each way: 1.7 mm, read as three encoder counts, 1.5 mm. A jump J sustains itself "
        "where (1 + k_eff / k) J exceeds the error that breaks the link loose, 1.4 mm, and the law's dead zone, 1.05 mm. A link "
        "that jumps by 3 mm would therefore cycle at 50 kN/m too, where the text saw none: both cannot be had of one link.",
    ),
    Deviation(
        (
            ("fig-7-1", "The link cycles"),
            ("fig-7-2", "The link cycles"),
            ("fig-7-2", "The set-point mostly moves away from where the link stands"),
            ("fig-7-3", "The link cycles"),
            ("fig-7-3", "The cycles become sporadic"),
        ),
        "A cycle ends for good where a jump lands so near the balance of forces that the set-point comes to rest inside the dead "
        "zone D = 1.05 mm, that is within D / (1 + k_eff / k): 1 % of a jump's range at 50 N/m, 9 % at 500, 55 % at 5 kN/m. So "
        "one seed in twenty rests at 50 and at 500 N/m, and six never cycle at 5 kN/m, where the text has it may or may not.",
    ),
    Deviation(
        (
            ("fig-7-1", "Cycles set in later at 50 than at 500 N/m"),
            ("fig-7-1", "Cycles set in later at 50 than at 5000 N/m"),
            ("fig-7-2", "Cycles are faster at 500 than at 50 N/m"),
            ("fig-7-3", "Cycles are faster at 5000 than at 500 N/m"),
            ("fig-7-5", "A hundred times the mass delays them"),
        ),
        "Between two jumps the link is stuck and the set-point creeps at (f_d - f) / c. The damper is the same at 50 and at "
        "500 N/m (18 kN s/m by xi_net = 5), so onset and period are as well; at 5 kN/m it is half of that (xi_net = 2), and "
        "the cycles are two and a half times as fast. The onset depends on how near to balance the response happens to end, and "
        "of a seed without cycles it has no value.",
    ),
    Deviation(
        (
            ("push-apparent", "The steady force is that of the soft target, to a tenth"),
            ("push-apparent", "The stiff target appears as soft as the soft one, to a tenth"),
        ),
        "Until the link has left stiction and the gauge confirms contact, one to two millimetres of the nominal way pass in "
        "full: 3 to 5 N too much of 79. The dead zone of 1.05 mm on the stiff target leaves another 4 N either way.",
    ),
    Deviation(
        (
            ("torque-dynamic-force-soft-plate", "The control no longer oscillates while moving up"),
            ("torque-dynamic-force-soft-plate", "Moving up, the control swings no more than moving down"),
        ),
        "From 14 swings in the whole rise 1 to 4 are left: one reversal at the top and in some seeds a single boost after it, "
        "before the integral has settled. The claim allows two.",
    ),
    Deviation(
        (("torque-dynamic-force-soft-plate", "The force is followed no worse"),),
        "Moving up, the final law runs ahead of its set-point, by as much as the target model lags behind the force's sine, and "
        "the two errors cancel. Fed forward, the link follows its set-point twice as well, and the model's lag of about 10 N "
        "(rms) shows: 14.4 N overall against 13.6 N.",
    ),
    Deviation(
        (
            ("torque-dynamic-force-stiff-plate", "The control no longer oscillates while moving up"),
            ("torque-dynamic-force-stiff-plate", "The control swings half as often, moving up"),
            ("torque-dynamic-force-stiff-plate", "The control swings half as often, moving up again"),
            ("torque-dynamic-force-stiff-plate", "The force is followed no worse"),
        ),
        "On the stiff plate a rise is four or five jumps out of stiction of some 40 N each. By the second sine they have come "
        "apart from seed to seed: where the final law happens to rise in two large jumps it hardly swings, and there is "
        "nothing to halve. Over eight seeds the force error falls from 19.7 to 19.1 N.",
    ),
    Deviation(
        (("largest-gain", "and hardly more is: the same within a tenth"),),
        "The linear model goes unstable at 242 mA/deg with the port as wide as saturation opens it, 12 % above Table 2's 215: "
        "dry friction and resolution are not in it, and a gain found by hand is found in steps.",
    ),
    Deviation(
        (("linear-stability", "k = 50 N/m is unstable: real part of the rightmost pole"),),
        "The text argues from the gain at rest, 1/k. With the damping that xi_net = 3 asks for, the filter's corner k/c falls "
        "with k as fast as its gain rises, so the loop at its crossover hardly changes: linearly every k is stable, with less "
        "margin at small k. The cycles of chapter 7 come from dry friction and resolution, as its section 7.1 says.",
    ),
    Deviation(
        (
            ("rest-50kg", "The control does not go from side to side"),
            ("rest-50kg", "The link rests within two counts"),
            ("rest-10kg-filtered", "The control does not go from side to side"),
            ("rest-10kg-filtered", "The link rests within two counts"),
        ),
        "The law's dead zone holds while the set-point is slower than 0.03 deg/s, 0.5 mm/s at the tip. The noise makes it 0.75 "
        "(50 kg) and 0.49 mm/s rms (10 kg, filtered), so now and then the law corrects, with a jump of a few counts.",
    ),
    Deviation(
        (
            ("circle-soft-10kg", "The plate is struck once, without bouncing"),
            ("circle-soft-10kg-filtered", "The plate is struck once, without bouncing"),
            ("circle-stiff-20kg-filtered", "The plate is struck once, without bouncing"),
            ("circle-stiff-10kg-filtered", "The plate is struck once, without bouncing"),
        ),
        "The filter removes the noise, not the 60 ms by which the position controller lags. On its plate a target of 10 kg turns "
        "at 27 (soft) and 51 rad/s (stiff), so that lag alone takes 90 deg and more, filtered or not. Single strikes need 20 kg "
        "on the soft plate and 45 kg on the stiff one.",
    ),
    Deviation(
        (
            ("circle-soft-20kg-filtered", "The plate is struck once, without bouncing"),
            ("circle-soft-20kg-filtered", "The transient is smaller than with 50 kg"),
        ),
        "20 kg is the border on the soft plate: in one seed of ten the tool bounces once, and departs as far as with 50 kg.",
    ),
    Deviation(
        (("circle-soft-10kg", "The circle is matched in free space"),),
        "This trial has no filter: it shows the noise of which 9.3.1 complains.",
    ),
    Deviation(
        (
            ("circle-stiff-50kg-filtered", "It has died before the plate is struck again"),
            ("adaptive-limit-switch", "It has died before the plate is struck again"),
        ),
        "As in figure 5-11, whose target this is: about two encoder counts are left, and two is the band.",
    ),
    Deviation(
        (
            ("static-stiff-10kg", "The steady force is off by no more than 10.5 %"),
            ("static-stiff-10kg", "The link rests"),
            ("static-stiff-10kg", "The control does not swing"),
            ("static-stiff-10kg", "The control stays below the break-away of 88 mA"),
        ),
        "This trial has no filter: the noise moves the valve across its overlap again and again.",
    ),
    Deviation(
        (
            ("static-stiff-10kg-filtered", "The steady force is off by no more than 10.5 %"),
            ("static-stiff-10kg-filtered", "The control stays below the break-away of 88 mA"),
        ),
        "The target settles in a tenth of a second, the arm in one jump. After it the set-point, without noise, stands still, "
        "and so the law's dead zone is in force wherever the jump ended: 1 mm, which is 26 N here, and an integral that stays. "
        "On the soft plate it is 6 N.",
    ),
    Deviation(
        (
            ("adaptive-stiffness", "The transient is less than 5 cm"),
            ("adaptive-stiffness", "It has died before the plate is struck again"),
            ("adaptive-stiffness", "It departs no farther from the circle"),
            ("adaptive-stiffness", "It is back on the circle as soon"),
            ("adaptive-offset", "The transient is less than 5 cm"),
            ("adaptive-offset", "It has died before the plate is struck again"),
            ("adaptive-offset", "It departs no farther from the circle"),
            ("adaptive-offset", "It is back on the circle as soon"),
        ),
        "The price of memory: where the circle comes back to the surface, spring or set-point have not come back yet.",
    ),
    Deviation(
        (
            ("adaptive-stiffness", "Contact is not lost more often"),
            ("adaptive-offset", "Contact is not lost more often"),
            ("adaptive-limit-switch", "Contact is not lost more often"),
            ("adaptive-limit-switch", "The control reverses no more often in contact"),
        ),
        "A lower mean force under jumps of the same size takes the tool off the plate between two of them.",
    ),
)
_WHY = {key: deviation.why for deviation in DEVIATIONS for key in deviation.of}


def explanation(figure: str, statement: str) -> str:
    """Why the claim fails, or "" where no explanation is known."""
    return _WHY.get((figure, statement), "")
