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
/* More stops than any light or setting has: "none", "unbounded". */
#define SENSOR_FAR_AWAY 1e3
/* The ends of a total's log2, so that 2^x is a normal number. */
#define SENSOR_TOTAL_END_EV 500.0

/* The first exposure, at gain 1: what a room needs at f/2, and one flicker period of lamps at 50 Hz. */
#define SENSOR_FIRST_EXPOSURE_S 0.01
#define SENSOR_NS               1e-9 /* s */

/* --- evidence --- */

/* Flicker is looked for in a mean without this share at both ends: clipped and black pixels do not flicker, and small
 * lamps blink. */
#define SENSOR_FLICKER_TRIM 0.1
/* Nine stops below white the codes of 12 bits are coarser than the noise. */
#define SENSOR_DARK_EV 9.0
/* A quantile counts as clipped or black only if the clipped or black share exceeds it by this: bins split pixels at an
 * edge. */
#define SENSOR_ORDER_MARGIN 0.01
/* A mean counts as exact where at most this share is clipped or black: half a stop of this share is 0.01 stops. */
#define SENSOR_MEAN_MARGIN 0.02
/* A spike in the top bin counts as clipped at once if it is at most this far below white: the bin below 1 begins at
 * 15/16. Sensors saturate at 0.95 to 0.9999 of the top code. */
#define SENSOR_WHITE_EV 0.1
/* A spike has more than this share of the weight, and so many times the weight of the two bins below it: the upper tail
 * of a scene falls from bin to bin. */
#define SENSOR_SPIKE_SHARE 0.01
#define SENSOR_SPIKE_TIMES 2.0
/* No sensor saturates so little above the key: a flat top below that is a flat scene. */
#define SENSOR_BRIGHT_EV 1.0
/* A level that stays within this while the setting has moved by a large step is the camera's white. */
#define SENSOR_STUCK_EV 0.02
/* More than this share of the weight above the learned white shows that it is not white. */
#define SENSOR_ABOVE_WHITE 0.002
/* A frame with this share clipped, or half of it black, says only "too bright", "too dark". Six stops are the largest
 * step of light that should settle with one more frame to look at. */
#define SENSOR_BLIND_CLIPPED 0.97
#define SENSOR_BLIND_EV      6.0
/* A quantile comes from bins of an eighth of a stop, and may be off by half a bin. */
#define SENSOR_KNOWN_EV 0.05
/* Limits of the clipped share, and of the spread, with which a clipped scene's spread is estimated; ordinary scenes
 * have a spread of 1 to 2 stops. */
#define SENSOR_CLIPPED_MOST   0.99
#define SENSOR_CLIPPED_LEAST  1e-6
#define SENSOR_SPREAD_MOST_EV 3.0
#define SENSOR_LOST_ROUNDS    4 /* of a fixed point that halves its error */

/* A wrong black level shows in steps of at least STEP, in scenes whose median is SPREAD above the darkest. Below this
 * SHARE of the median the picture is not half a stop off, and the level is ignored. The ranks, and two steps in a row,
 * have to agree within 15 % (ALIKE). At least a 64th of the level is left of a pixel (FLOOR). */
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

/* The quantile that should stay below white comes from peak bins of a quarter of a stop. The aim is this far below
 * white. */
#define SENSOR_HIGHLIGHT_AIM_EV 0.20
/* A quantile from bins moves when pixels change bins: it is followed by a filter of this WEIGHT, and by at most SLOW a
 * frame, so that a stop takes two seconds at 30 frames a second. In so many FRAMES after a large step the picture
 * changes anyway, and highlights are followed as fast as all else. */
#define SENSOR_HIGHLIGHT_WEIGHT  0.1
#define SENSOR_HIGHLIGHT_SLOW_EV 0.025
#define SENSOR_HIGHLIGHT_FRAMES  60
/* At rest, an error below a quarter of a bin of the brightest channel's histogram is ignored. With less, a tenth of the
 * picture at 3 EV swings by up to 0.13 EV (test_sensor_scenes); with half a bin, a third more of random cameras rest
 * beyond 0.1 EV (pupil sim --random). */
#define SENSOR_HIGHLIGHT_REST_EV 0.0625
/* A level that highlights hold is known only to half of that bin. */
#define SENSOR_HIGHLIGHT_DOUBT_EV 0.125

/* --- estimate --- */

/* Exposures and gains of metadata are valid between this and its inverse. */
#define SENSOR_POSITIVE 0x1p-64

/* A cost is a log-likelihood in bits, of Student's distribution with three degrees of freedom, so that one cut of the
 * scene does not decide alone. A guess within ALIVE of the best is not ruled out. Guesses beyond delay_frames begin
 * with PRIOR. One frame adds at most FRAME, and three undo all that came before: MOST. */
#define SENSOR_COST_ALIVE  6.0
#define SENSOR_COST_PRIOR  7.0
#define SENSOR_COST_FRAME  8.0
#define SENSOR_COST_MOST   24.0
#define SENSOR_COST_DEGREE 3.0
/* The least noise of a comparison: what a quantile from bins is off by. */
#define SENSOR_QUANTILE_NOISE_EV 0.03
/* The least noise of the mean of a frame of still light. */
#define SENSOR_MEAN_NOISE_EV 0.003
/* The mean size of a normal deviate is 0.8 sigma. */
#define SENSOR_SIGMA_OF_SIZE 1.25
/* In the estimate of noise a frame counts as at most so many sigma, with this weight: an outlier is not noise. */
#define SENSOR_NOISE_FRAME  2.5
#define SENSOR_NOISE_WEIGHT 0.1
/* Sigma of a second difference of white noise, divided by that of a first difference: sqrt(6 / 2). */
#define SENSOR_SECOND_DIFFERENCE 1.7320508075688772
/* Limits of the response before any was seen (gamma 2.2, and its inverse), and afterwards. */
#define SENSOR_STEEP_LEAST 0.45
#define SENSOR_STEEP_MOST  2.2
#define SENSOR_KNOWN_LEAST 0.8
#define SENSOR_KNOWN_MOST  1.25
/* Frames that may have waited in a slow program's buffers: V4L2 programs take 4 to 8. */
#define SENSOR_STILL_FRAMES 8
/* A program that loses frames before each of so many in a row is slower than the camera. With one frame in five lost at
 * random, that happens once in 400,000. */
#define SENSOR_SLOW_FRAMES 8
/* Settings are the same within SAME; guesses differ from DIFFER on. */
#define SENSOR_SAME_EV   0.05
#define SENSOR_DIFFER_EV 0.01
/* What a change of the setting leaves unexplained is the camera's above this, and above so many times the noise. */
#define SENSOR_UNEXPLAINED_EV    0.05
#define SENSOR_MISMATCH_EV       0.15 /* ... that starts a search */
#define SENSOR_UNEXPLAINED_NOISE 3.0
/* Exposures that are remembered of a camera that rounds them: 16 stops of powers of two. */
#define SENSOR_TOLD_RANGES 16
/* The coarsest exposure step on the market: webcams have powers of two. */
#define SENSOR_COARSE_STEP_EV 1.0
/* Responses are learned from steps of at least this; smaller ones are in the noise. */
#define SENSOR_STEP_EV 0.3
/* A larger change of the setting is waited for and evaluated. */
#define SENSOR_LARGE_EV 0.15
/* Less than this share of what was asked for is no response. */
#define SENSOR_ANSWER_SHARE 0.3
/* An answer below this share of what was expected has to be seen twice: a scene may move at the same time. */
#define SENSOR_WEAK 0.7
/* A response within 10 % of 1 is taken as 1: shot noise, rounding of codes. */
#define SENSOR_STRAIGHT 0.1
/* Stops of the picture for one of a control. A dead control is believed to do a tenth, so that it is asked again. */
#define SENSOR_RESPONSE_LEAST 0.1
#define SENSOR_RESPONSE_MOST  4.0

/* --- plan --- */

/* The longest that a change of light may be announced ahead: half a minute at 30 frames a second. */
#define SENSOR_ANNOUNCED_FRAMES 1000

/* An error above this is corrected in one step, a smaller one by at most GLIDE_EV a frame. */
#define SENSOR_FAR_TIMES 4.5 /* of far_ev */
#define SENSOR_GLIDE_EV  0.05
/* A filter of weight w lets sqrt(w / 2) of the noise through. At rest the weight is at most (CALM_EV / noise)^2, which
 * lets 0.014 EV through, but at least CALM_SHARE of the usual weight, because moving light may look like noise
 * (test_sensor_random_loops). */
#define SENSOR_CALM_EV    0.02
#define SENSOR_CALM_SHARE 0.25
/* The largest weight of the filter in a frame, if the delays are known; and if not, divided by the delay (largest k
 * without overshoot of x' = x - k x[D - 1 before]: (D-1)^(D-1) / D^D). */
#define SENSOR_TRACK_WEIGHT 0.35
#define SENSOR_DELAY_WEIGHT 0.39
/* Light that moved to one side in each of so many frames, by more than so many times the noise, is expected to
 * continue. Blinking light moves in one frame only. */
#define SENSOR_RAMP_FRAMES 3
#define SENSOR_RAMP_NOISE  2.0
/* While the first setting is looked for, an error above this is corrected at once. */
#define SENSOR_LOOK_EV 0.02
/* A delay may be longer than delay_frames: so many frames more are waited for. */
#define SENSOR_LATE_FRAMES 4
/* An error below this is not seen: near a limit the setting goes to the limit. */
#define SENSOR_LAST_EV 0.005
/* A search tries a setting at least NARROW of the gap away from both of its ends, and ends when the gap is below
 * GAP_EV. */
#define SENSOR_NARROW   0.2
#define SENSOR_GAP_EV   0.06
#define SENSOR_OFF_EV   0.1  /* the promise for what is shown */
#define SENSOR_WRONG_EV 0.25 /* the promise for the sensor */
/* The error has shrunk when it is below this share of what it was. */
#define SENSOR_SHRINK 0.7
/* Frames, beyond the wait, after which an error that does not shrink shows that what was learned is wrong;
 * doubled each time, at most so often, while the light is the same. */
#define SENSOR_WRONG_FRAMES 28
#define SENSOR_REST_FRAMES  8 /* ... where a search has ended so */
#define SENSOR_WRONG_TIMES  6
/* The most steps without a response in a row that are counted: each doubles the next step. */
#define SENSOR_UNANSWERED_MOST 4
/* So many large steps in a row that the metadata do not show are written again; then the control is taken to be dead.
 */
#define SENSOR_LOST_TIMES 3
/* A noisy setting far from the profile is kept for so many frames. */
#define SENSOR_NOISY_FRAMES 300
/* How often a search may change the control that moves. */
#define SENSOR_SWAPS 3
/* At a larger change of the wanted effect no control stays pinned: no search settles further off than this. */
#define SENSOR_UNPIN_EV 1.0
/* A part of an exchange of exposure for gain: from one half period of the mains to two, which digital_ev covers. */
#define SENSOR_EXCHANGE_EV 1.0
/* ... while the delays are not known, so that a frame may have one and not yet the other: hardly visible. */
#define SENSOR_BLIND_EXCHANGE_EV 0.1
/* Steps of a bisection of the path of settings: 2^-48 of 40 stops is less than SENSOR_ROUND. */
#define SENSOR_BISECT 48

/* --- split --- */

/* Relative tolerance: a total that came from its logarithm is off by a few 2^-52 of the logarithm. */
#define SENSOR_ROUND 1e-9
/* A millionth of a step is forgiven, so that a multiple stays itself; beyond 10^15 steps a double has no room for them.
 */
#define SENSOR_STEP_SHARE 1e-6
#define SENSOR_STEPS_MOST 1e15
#define SENSOR_LOG2_DB    0.16609640474436813 /* log2(10) / 20 */
/* In half mains periods: bands of an exposure so near to a multiple have at most 5 % of the lamps' modulation. */
#define SENSOR_NEAR_MULTIPLE 0.05
/* If rounding down loses more than this, the nearest setting is taken: half of what the sensor may be off. */
#define SENSOR_COARSE_EV 0.125
/* The mains frequency of most of the world: exposures rest at multiples of its half period until the mains are
 * known. */
#define SENSOR_USUAL_MAINS_HZ 50

/* --- report --- */

/* pupil.h, too, calls a level settled within 0.05. */
#define SENSOR_SETTLED_EV 0.05
/* Just below half a period of the mains is half a period. */
#define SENSOR_HALF_PERIOD 0.99
/* A setting that the camera did not take is written again after this time. */
#define SENSOR_REWRITE_S 1.0

#endif
