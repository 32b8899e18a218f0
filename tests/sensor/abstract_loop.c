#include "abstract_loop.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SHOWN_EV  0.1
#define SENSOR_EV 0.25
/* This near to the end of the camera's range both answers are right. The noise moves the mean by up to 0.03 EV. */
#define EDGE_EV 0.1

const char *const abstract_verdict_name[ABSTRACT_VERDICTS] = {"right",       "no number",    "outside the limits",
                                                              "shown wrong", "sensor wrong", "limit not named"};

uint64_t abstract_frames;

/* The properties of camera `which`: delays, saturation, rest. */
static void parts_of(int which, uint32_t *delay, uint32_t *believed, double *saturation, int *rests)
{
    *delay = 1 + (uint32_t)which / 4 % 4;
    *believed = 1 + (uint32_t)which % 4;
    *saturation = which / 16 % 2 ? 0.98 : 1.0;
    *rests = which / 32 % 2;
}

const char *abstract_camera_name(int which)
{
    static char name[96];
    uint32_t delay, believed;
    double saturation;
    int rests;
    parts_of(which, &delay, &believed, &saturation, &rests);
    snprintf(name, sizeof name, "delay %u, believed %u, saturation %.2f, %s", delay, believed, saturation,
             rests ? "at rest" : "from the start");
    return name;
}

void abstract_loop_open(abstract_loop *loop, int which)
{
    pupil_sensor_config config;
    pupil_sensor_setting setting;
    uint32_t delay;
    double saturation;
    int rests;
    memset(loop, 0, sizeof *loop);
    parts_of(which, &delay, &loop->believed, &saturation, &rests);
    abstract_camera_config(&config, loop->believed);
    (void)pupil_sensor_init(&loop->sensor, &config); /* a loop without an object fails in its first frame */
    (void)pupil_sensor_get(&loop->sensor, &setting);
    loop->camera = abstract_camera_open(delay, saturation, setting.exposure_s, setting.gain);
    for (int i = 0; i < 60 && rests; i++)
        (void)abstract_loop_go(loop, ".");
}

static abstract_verdict one_frame(abstract_loop *loop)
{
    abstract_camera *camera = &loop->camera;
    const pupil_stats *stats;
    pupil_sensor_setting s;
    pupil_sensor_config config;
    pupil_frame_info info;
    const int is_there = abstract_camera_frame(camera, loop->next, &stats, &info);
    loop->next = ABSTRACT_FRAME_FINE;
    if (is_there) {
        abstract_frames++;
        if (pupil_sensor_frame(&loop->sensor, stats, &info) != PUPIL_OK)
            return ABSTRACT_NO_NUMBER;
    }
    if (pupil_sensor_get(&loop->sensor, &s) != PUPIL_OK)
        return ABSTRACT_NO_NUMBER;
    abstract_camera_write(camera, s.exposure_s, s.gain);
    const double numbers[] = {s.exposure_s, s.gain,     s.digital,   s.total_s, s.frame_digital, s.flicker_ev,
                              s.scene_ev,   s.error_ev, s.wanted_ev, s.dt_s,    s.slope};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!isfinite(numbers[i]))
            return ABSTRACT_NO_NUMBER;
    abstract_camera_config(&config, loop->believed);
    return abstract_camera_has(&config, s.exposure_s, s.gain) ? ABSTRACT_RIGHT : ABSTRACT_OUTSIDE_LIMITS;
}

static void apply(abstract_loop *loop, char letter)
{
    abstract_camera *camera = &loop->camera;
    static const char faults[] = "egamci"; /* in the order of their bits */
    const char *fault = letter ? strchr(faults, letter) : NULL;
    if (letter >= '0' && letter <= '9')
        camera->level = (uint32_t)(letter - '0');
    if (letter == 'n')
        abstract_camera_set_faults(camera, 0);
    if (letter == 'x' || letter == 'w' || letter == 'b')
        loop->next = letter == 'x' ? ABSTRACT_FRAME_LOST : letter == 'w' ? ABSTRACT_FRAME_WHITE : ABSTRACT_FRAME_BLACK;
    if (fault) {
        const uint32_t bit = 1u << (fault - faults), others = bit & ABSTRACT_INFO ? ABSTRACT_INFO & ~bit : 0;
        abstract_camera_set_faults(camera, (camera->faults & ~others) ^ bit);
    }
}

abstract_verdict abstract_loop_go(abstract_loop *loop, const char *text)
{
    abstract_verdict worst = ABSTRACT_RIGHT;
    for (; *text; text++) {
        if (*text != '.') {
            apply(loop, *text);
            continue;
        }
        const abstract_verdict verdict = one_frame(loop);
        worst = worst ? worst : verdict;
    }
    return worst;
}

/* Whether a limit of this side is named. IGNORED is right, too, where a control is dead, or info says so regardless of
 * the picture. */
static int is_named(const pupil_sensor_setting *s, uint32_t faults, int too_dark)
{
    const int is_upper = s->reason == PUPIL_SENSOR_AT_EXPOSURE_MAX || s->reason == PUPIL_SENSOR_AT_FRAME_PERIOD ||
                         s->reason == PUPIL_SENSOR_AT_GAIN_MAX;
    const int is_lower = s->reason == PUPIL_SENSOR_AT_EXPOSURE_MIN || s->reason == PUPIL_SENSOR_AT_GAIN_MIN;
    const uint32_t dead = ABSTRACT_EXPOSURE_DEAD | ABSTRACT_GAIN_DEAD | ABSTRACT_INFO_CONSTANT;
    if (s->state != PUPIL_SENSOR_LIMITED)
        return 0;
    return (too_dark ? is_upper : is_lower) || (s->reason == PUPIL_SENSOR_IGNORED && faults & dead);
}

abstract_verdict abstract_loop_judge(const abstract_loop *loop)
{
    pupil_sensor_config config;
    pupil_sensor_setting s;
    abstract_camera_config(&config, loop->believed);
    if (pupil_sensor_get(&loop->sensor, &s) != PUPIL_OK)
        return ABSTRACT_NO_NUMBER;
    const abstract_reach reach = abstract_camera_reach(&loop->camera, &config);
    const int too_dark = !(reach.above_ev >= 0.0), too_bright = !(reach.below_ev <= 0.0);
    const double sensor_ev = abstract_camera_off_ev(&loop->camera), shown_ev = sensor_ev + log2(s.frame_digital);
    const double best_ev = too_dark                           ? reach.below_ev
                           : too_bright                       ? reach.above_ev
                           : reach.above_ev < -reach.below_ev ? reach.above_ev
                                                              : reach.below_ev;
    const double step_ev = too_dark || too_bright ? 0.0 : reach.above_ev - reach.below_ev;
    const int is_beyond = (too_dark && best_ev < -EDGE_EV) || (too_bright && best_ev > EDGE_EV);
    const int near_edge = (too_dark || too_bright) && !is_beyond;
    if (fabs(sensor_ev - best_ev) > fmax(SENSOR_EV, 0.5 * step_ev) + 1e-9)
        return ABSTRACT_SENSOR_WRONG;
    const int is_shown = fabs(shown_ev) <= SHOWN_EV;
    /* the sensor may be this far off anyway, if the shown frame is right */
    if (is_beyond && !(is_shown && fabs(best_ev) <= SENSOR_EV))
        return is_named(&s, loop->camera.faults, too_dark) ? ABSTRACT_RIGHT : ABSTRACT_LIMIT_NOT_NAMED;
    return is_shown || near_edge ? ABSTRACT_RIGHT : ABSTRACT_SHOWN_WRONG;
}

void abstract_loop_print(const abstract_loop *loop)
{
    const abstract_camera *camera = &loop->camera;
    pupil_sensor_setting s;
    if (pupil_sensor_get(&loop->sensor, &s) != PUPIL_OK)
        return;
    const double off_ev = abstract_camera_off_ev(camera);
    pupil_sensor_config config;
    abstract_camera_config(&config, loop->believed);
    const abstract_reach reach = abstract_camera_reach(camera, &config);
    printf("%4u  level %u  faults %2x  has %8.3f ms x %6.3f, %+7.3f EV, shown %+7.3f  asked %8.3f ms x %6.3f  "
           "error %+7.3f  state %u reason %2u  possible %+.3f %+.3f  %s\n",
           camera->frame, camera->level, camera->faults, 1e3 * camera->in_force[0], camera->in_force[1], off_ev,
           off_ev + log2(s.frame_digital), 1e3 * s.exposure_s, s.gain, s.error_ev, s.state, s.reason, reach.below_ev,
           reach.above_ev, abstract_verdict_name[abstract_loop_judge(loop)]);
}

/* The object's contents are not known here. A word that reads as a double of ordinary size is assumed to be one and
 * rounded. Counts, masks, pairs of small integers, bytes and stamps read as tiny or huge numbers or NaN, and count bit
 * for bit. A pair of integers that reads as an ordinary double loses its low bits: that merges too many states, but
 * reports no false failure. */
static uint64_t rounded(uint64_t word)
{
    const int exponent = (int)(word >> 52 & 0x7ff) - 1023;
    if (exponent < -40 || exponent > 40)
        return word;
    const int kept = exponent > 0 ? 6 + exponent : 6;
    return kept < 52 ? word >> (52 - kept) << (52 - kept) : word;
}

static uint64_t mix(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * UINT64_C(0x9fb21c651e98df25);
    return hash ^ hash >> 32;
}

uint64_t abstract_loop_hash(const abstract_loop *loop)
{
    uint64_t hash = UINT64_C(0x9e3779b97f4a7c15);
    for (size_t i = 0; i < sizeof loop->sensor / 8; i++) {
        const uint64_t word = loop->sensor.private_words[i];
        hash = word ? mix(hash + i, rounded(word)) : hash;
    }
    const unsigned char *bytes = (const unsigned char *)&loop->camera;
    for (size_t i = 0; i + 8 <= sizeof loop->camera; i += 8) {
        uint64_t word;
        memcpy(&word, bytes + i, 8);
        hash = mix(hash + i, rounded(word));
    }
    return mix(hash, loop->next);
}
