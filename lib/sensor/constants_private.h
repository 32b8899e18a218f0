/* lib/sensor/constants_private.h: every number of the loop that is not 0, 1, 2 or 0.5, with its source. A number that
 * was chosen by measuring names the command that shows what it does. */
#ifndef PUPIL_SENSOR_CONSTANTS_PRIVATE_H
#define PUPIL_SENSOR_CONSTANTS_PRIVATE_H

/* Delays that are distinguished, in frames. V4L2 and MIPI sensors have 1 to 4; libcamera's delayed controls allow 16.
 */
#define SENSOR_DELAYS 16
/* A guess is a delay of 1..16 frames, or what the metadata say (0). */
#define SENSOR_GUESSES (SENSOR_DELAYS + 1)
/* Settings that are remembered: twice the delays, so that frames may be lost. */
#define SENSOR_RING 32
/* Quantiles of a frame that are compared with those of the frame before. */
#define SENSOR_ORDERS       11 /* the first is the mean */
#define SENSOR_BRIGHT_ORDER 4  /* from the end: 0.9 */
#define SENSOR_ORDER_SHARES                                                                                            \
    {                                                                                                                  \
        0.5, 0.5, 0.35, 0.65, 0.2, 0.8, 0.1, 0.9, 0.05, 0.95, 0.02                                                     \
    }
/* Points of the camera's answer that a search remembers: both ends of it, and what it came from. */
#define SENSOR_POINTS 6
/* More stops than any light or setting. */
#define SENSOR_FAR_AWAY 1e3
/* The ends of a total's log2, so that 2^x is a normal number. */
#define SENSOR_TOTAL_END_EV 500.0

/* The first exposure, at gain 1: what a room needs at f/2, and a whole period of the light of lamps at 50 Hz. */
#define SENSOR_FIRST_EXPOSURE_S 0.01
#define SENSOR_NS               1e-9 /* s */

/* --- evidence --- */

/* Clipped and black pixels do not flicker, small lamps blink: this share of both ends is left out of the mean in which
 * flicker is looked for. */
#define SENSOR_FLICKER_TRIM 0.1
/* Nine stops below white the codes of 12 bits are coarser than the noise. */
#define SENSOR_DARK_EV 9.0
/* A quantile counts as clipped or black only so much beyond the share: bins split the pixels at an edge. */
#define SENSOR_ORDER_MARGIN 0.01
/* A mean is a number where at most this share is clipped or black: half a stop of it is 0.01 stops. Without a histogram
 * it has to do up to the second. */
#define SENSOR_MEAN_MARGIN 0.02
/* A spike in the top bin counts as clipped at once where it is no further below white: the bin below 1 begins at
 * 15/16. Sensors saturate at 0.95 to 0.9999 of the top code. */
#define SENSOR_WHITE_EV 0.1
/* A spike holds this share of the weight, and so many times that of the two bins below it: the upper tail of a scene
 * falls from bin to bin. */
#define SENSOR_SPIKE_SHARE 0.01
#define SENSOR_SPIKE_TIMES 2.0
/* No sensor is full so near above the key: a flat top below that is a flat scene. */
#define SENSOR_BRIGHT_EV 1.0
/* A level that stays within this while the setting has moved by a large step is the camera's white. */
#define SENSOR_STUCK_EV 0.02
/* Weight above the learned white that shows that it is none. */
#define SENSOR_ABOVE_WHITE 0.002
/* A frame with this share clipped, or half of it black, says only "too bright", "too dark". Six stops are the largest
 * step of light that is to settle with one look more. */
#define SENSOR_BLIND_CLIPPED 0.97
#define SENSOR_BLIND_EV      6.0
/* A quantile from bins of an eighth of a stop is off by half of one. */
#define SENSOR_KNOWN_EV 0.05
/* Shares and sizes between which a clipped scene's spread can be worked out; ordinary scenes have 1 to 2 stops. */
#define SENSOR_CLIPPED_MOST   0.99
#define SENSOR_CLIPPED_LEAST  1e-6
#define SENSOR_SPREAD_MOST_EV 3.0
#define SENSOR_LOST_ROUNDS    4 /* of a fixed point that halves its error */

/* A wrong black level shows from steps of so many stops on, in scenes whose median is so far above the darkest. Where
 * it is less than this share of the median, the picture is not half a stop off, and it is left alone. The ranks, and
 * two steps in a row, have to agree within 15 %. A 64th of it is left of a pixel at least. */
#define SENSOR_RANKS           3
#define SENSOR_BLACK_STEP_EV   0.5
#define SENSOR_BLACK_SPREAD_EV 0.1
#define SENSOR_BLACK_SHARE     0.25
#define SENSOR_BLACK_ALIKE     0.15
#define SENSOR_BLACK_FLOOR     0.015625
/* The darkest 2 % of a frame are no darker than this share of a black level: the rest is noise. */
#define SENSOR_BLACK_NOISE 0.75

/* Normal distribution: Abramowitz, Stegun, Handbook of Mathematical Functions, 1964, 26.2.23 (the quantile, error below
 * 4.5e-4) and 26.2.17 (the share above, error below 7.5e-8). */
#define SENSOR_NORMAL_DENSITY 0.3989422804014327 /* 1 / sqrt(2 pi) */
#define SENSOR_NORMAL_END     37.0               /* beyond it the density is below 2^-980 */
#define SENSOR_LN2            0.6931471805599453
#define SENSOR_LOG2_E         1.4426950408889634
#define SENSOR_QUANTILE_UP                                                                                             \
    {                                                                                                                  \
        2.515517, 0.802853, 0.010328                                                                                   \
    }
#define SENSOR_QUANTILE_DOWN                                                                                           \
    {                                                                                                                  \
        1.432788, 0.189269, 0.001308                                                                                   \
    }
#define SENSOR_ABOVE_SCALE 0.2316419
#define SENSOR_ABOVE                                                                                                   \
    {                                                                                                                  \
        0.319381530, -0.356563782, 1.781477937, -1.821255978, 1.330274429                                              \
    }

/* The quantile that is to stay below white comes from peak bins of a quarter of a stop. It is aimed at this far below
 * white. */
#define SENSOR_HIGHLIGHT_AIM_EV 0.20
/* A quantile from bins moves with pixels that change from one to the next: it is followed by a filter, and no faster
 * than this in a frame, so that a stop takes two seconds at 30 frames a second. In so many frames after a large step
 * the picture changes anyway, and what is left is followed as fast as all else. */
#define SENSOR_HIGHLIGHT_WEIGHT  0.1
#define SENSOR_HIGHLIGHT_SLOW_EV 0.025
#define SENSOR_HIGHLIGHT_FRAMES  60
/* At rest, a quarter of a bin of the brightest channel's histogram is nothing. With less, a tenth of the picture at
 * 3 EV swings by up to 0.13 EV (test_sensor_scenes); with half a bin, a third more of random cameras rest beyond 0.1 EV
 * (pupil sim --random). */
#define SENSOR_HIGHLIGHT_REST_EV 0.0625
/* A level that highlights hold is not known better than by half of that bin. */
#define SENSOR_HIGHLIGHT_DOUBT_EV 0.125

/* --- estimate --- */

/* Exposures and gains of metadata are numbers between this and its inverse. */
#define SENSOR_POSITIVE 0x1p-64

/* A cost is a log-likelihood in bits, of Student's distribution with three degrees of freedom: a cut of the scene does
 * not decide alone. A guess is alive within ALIVE of the best. One frame says at most FRAME, and three of them undo
 * what all before them said: MOST. */
#define SENSOR_COST_ALIVE  6.0
#define SENSOR_COST_PRIOR  7.0
#define SENSOR_COST_FRAME  8.0
#define SENSOR_COST_MOST   24.0
#define SENSOR_COST_DEGREE 3.0
/* The least noise of a comparison: what a quantile from bins is off by. */
#define SENSOR_QUANTILE_NOISE_EV 0.03
/* The least noise of the mean of a frame of still light. */
#define SENSOR_MEAN_NOISE_EV 0.003
/* Of a normal deviate the mean size is 0.8 sigma. */
#define SENSOR_SIGMA_OF_SIZE 1.25
/* A frame counts as at most so many sigma: what moves a frame is more noise only where it moves many. */
#define SENSOR_NOISE_FRAME  2.5
#define SENSOR_NOISE_WEIGHT 0.1
/* Of the difference of two differences of white noise, over that of a difference: sqrt(6 / 2). */
#define SENSOR_SECOND_DIFFERENCE 1.7320508075688772
/* How strongly a picture may answer before anything was seen of it (gamma 2.2, and as steep), and afterwards. */
#define SENSOR_STEEP_LEAST 0.45
#define SENSOR_STEEP_MOST  2.2
#define SENSOR_KNOWN_LEAST 0.8
#define SENSOR_KNOWN_MOST  1.25
/* The longest queue of buffers that a slow program lets grow old: V4L2 programs take 4 to 8. */
#define SENSOR_STILL_FRAMES 8
/* Settings are the same within this; guesses differ from this on. */
#define SENSOR_SAME_EV   0.05
#define SENSOR_DIFFER_EV 0.01
/* What a change of the setting leaves unexplained is the camera's from here on, or from so many times the noise. */
#define SENSOR_UNEXPLAINED_EV    0.05
#define SENSOR_MISMATCH_EV       0.15 /* ... that starts a search */
#define SENSOR_ALIKE             0.25 /* two jumps of the picture are the same one */
#define SENSOR_UNEXPLAINED_NOISE 3.0
/* Exposures of a camera that rounds them, which are kept: 16 stops of powers of two. */
#define SENSOR_TOLD_RANGES 16
/* The coarsest step of exposures that is sold: webcams have powers of two. */
#define SENSOR_COARSE_STEP_EV 1.0
/* An answer of a step teaches from here on; less is in the noise. */
#define SENSOR_STEP_EV 0.3
/* A change of the setting from here on is waited for. */
#define SENSOR_LARGE_EV 0.15
/* Less of what was asked for than this share is no answer. */
#define SENSOR_ANSWER_SHARE 0.3
/* An answer below this share of what was expected has to be seen twice: a scene may move at the same time. */
#define SENSOR_WEAK 0.7
/* Answers within 10 % of the expected are the expected: shot noise, rounding of codes. */
#define SENSOR_STRAIGHT 0.1
/* Stops of the picture for one of a control. A dead control is believed to do a tenth, so that it is asked again. */
#define SENSOR_RESPONSE_LEAST 0.1
#define SENSOR_RESPONSE_MOST  4.0

/* --- plan --- */

/* The longest that a change of light may be announced ahead: half a minute at 30 frames a second. */
#define SENSOR_ANNOUNCED_FRAMES 1000

/* Further off than this light is followed in one step, nearer than this in a glide of at most GLIDE_EV a frame. */
#define SENSOR_FAR_TIMES 4.5 /* of far_ev */
#define SENSOR_GLIDE_EV  0.05
/* A filter of weight w lets sqrt(w / 2) of the noise through. At rest the weight is at most (CALM_EV / noise)^2, which
 * lets 0.014 EV. But it is this share of the usual one at least, for light that moves may look like noise
 * (test_sensor_random_loops). */
#define SENSOR_CALM_EV    0.02
#define SENSOR_CALM_SHARE 0.25
/* The share of the way that the filter goes in a frame while light moves to one side, where the delays are known; and
 * over the delay where they are not (largest k without overshoot of x' = x - k x[D - 1 before]: (D-1)^(D-1) / D^D). */
#define SENSOR_TRACK_WEIGHT 0.35
#define SENSOR_DELAY_WEIGHT 0.39
/* Light that moved to one side in each of so many frames, by more than so many times the noise, goes on to do so. A
 * light that blinks moves in one frame only. */
#define SENSOR_RAMP_FRAMES 3
#define SENSOR_RAMP_NOISE  2.0
/* While the first setting is looked for, all that is more than this is done at once. */
#define SENSOR_LOOK_EV 0.02
/* Frames after which a delay that is longer than believed is no longer waited for. */
#define SENSOR_LATE_FRAMES 4
/* The last thousandths to a limit are not seen, and then all of it is used. */
#define SENSOR_LAST_EV 0.005
/* A search narrows what it has to look at to this share at least, from both ends; and ends where it is this narrow. */
#define SENSOR_NARROW   0.2
#define SENSOR_GAP_EV   0.06
#define SENSOR_OFF_EV   0.1  /* the promise for what is shown */
#define SENSOR_WRONG_EV 0.25 /* the promise for the sensor */
/* The error has not shrunk where it is not this share smaller. */
#define SENSOR_SHRINK 0.7
/* Frames, beyond the wait, after which an error that does not shrink shows that what was learned is wrong;
 * doubled each time, at most so often, while the light is the same. */
#define SENSOR_WRONG_FRAMES 28
#define SENSOR_REST_FRAMES  8 /* ... where a search has ended so */
#define SENSOR_WRONG_TIMES  6
/* Unanswered steps in a row that are counted: each doubles the next one. */
#define SENSOR_UNANSWERED_MOST 4
/* A pinned control is free again at the next large change of light after so many frames. */
#define SENSOR_PINNED_FRAMES 300
/* A search changes the control that moves at most so often. */
#define SENSOR_SWAPS 3
/* Nothing settles further off than this: a pinned control is let go. */
#define SENSOR_UNPIN_EV 1.0
/* A part of an exchange of exposure for gain: from one half period of the mains to two, which digital_ev covers. */
#define SENSOR_EXCHANGE_EV 1.0
/* ... while it is not known which frames have the one and not yet the other: what is hardly seen. */
#define SENSOR_BLIND_EXCHANGE_EV 0.1
/* Steps of a bisection of the path of settings: 2^-48 of 40 stops is less than SENSOR_ROUND. */
#define SENSOR_BISECT 48

/* --- split --- */

/* A total that came from its logarithm is off by a few 2^-52 of these. */
#define SENSOR_ROUND 1e-9
/* A millionth of a step is forgiven, so that a multiple stays itself; beyond 10^15 steps a double has no room for them.
 */
#define SENSOR_STEP_SHARE 1e-6
#define SENSOR_STEPS_MOST 1e15
#define SENSOR_LOG2_DB    0.16609640474436813 /* log2(10) / 20 */
/* Of a half mains period: bands of an exposure so near to a multiple have at most 5 % of the lamps' modulation. */
#define SENSOR_NEAR_MULTIPLE 0.05
/* What rounding down leaves is not left to the digital factor from here on: half of what the sensor may be off. */
#define SENSOR_COARSE_EV 0.125
/* Half a period of the mains that most of the world has, in s: exposures rest there while the mains are not known. */
#define SENSOR_USUAL_MAINS_HZ 50

/* --- report --- */

/* pupil.h, too, calls a level settled within 0.05. */
#define SENSOR_SETTLED_EV 0.05
/* Just below half a period of the mains is half a period. */
#define SENSOR_HALF_PERIOD 0.99
/* A setting that the camera did not take is written again so often. */
#define SENSOR_REWRITE_S 1.0

#endif
