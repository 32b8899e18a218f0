/* drivers/file/pan/pan_path.c: where the camera of a pan looks at a time. */
#include "pan_path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "number.h"
#include "refuse.h"

enum { YAW, PITCH, FOV };

const char *pupil_pan_number(const char *text, const char *ends, double *value)
{
    char *end;
    *value = pupil_parse_double(text, &end);
    if (end == text || !isfinite(*value) || (*end && !strchr(ends, *end)))
        return NULL;
    return end;
}

/* One keyframe, up to its ':' or the end; NULL where it is not one. */
static const char *read_key(pupil_pan_path *p, const char *text, int *has_time)
{
    size_t k = p->count;
    *has_time = 0;
    text = pupil_pan_number(text, "/", &p->values[YAW][k]);
    if (!text || *text != '/')
        return NULL;
    text = pupil_pan_number(text + 1, "/@:", &p->values[PITCH][k]);
    if (text && *text == '/')
        text = pupil_pan_number(text + 1, "@:", &p->values[FOV][k]);
    if (text && *text == '@') {
        text = pupil_pan_number(text + 1, ":", &p->times[k]);
        *has_time = 1;
    }
    return text;
}

/* What is wrong with the keyframe that was just read, or NULL. */
static const char *refuse_key(const pupil_pan_path *p, int has_time)
{
    size_t k = p->count;
    if (fabs(p->values[YAW][k]) > 36000)
        return "a yaw of -36000 to 36000 degrees was expected";
    if (fabs(p->values[PITCH][k]) > 90)
        return "a pitch of -90 to 90 degrees was expected";
    if (p->values[FOV][k] < PUPIL_PAN_MIN_FOV || p->values[FOV][k] > PUPIL_PAN_MAX_FOV)
        return "a field of view of 5 to 150 degrees was expected";
    if (k && has_time != p->has_times)
        return "@seconds was expected for all keyframes or for none";
    if (has_time && (p->times[k] < 0 || p->times[k] > 86400 || (k && p->times[k] <= p->times[k - 1])))
        return "seconds that rise from keyframe to keyframe, 0 to 86400, were expected";
    return NULL;
}

int pupil_pan_path_read(pupil_pan_path *p, const char *text, double fov, pupil_why *why)
{
    memset(p, 0, sizeof *p);
    for (const char *at = text;; at++) {
        int has_time, length = (int)strcspn(at, ":");
        const char *key = at, *wrong;
        if (p->count == PUPIL_PAN_MAX_KEYS)
            return pupil_refuse(why, "more than %d keyframes", PUPIL_PAN_MAX_KEYS);
        p->values[FOV][p->count] = fov;
        at = read_key(p, at, &has_time);
        wrong = at ? refuse_key(p, has_time) : "yaw/pitch, yaw/pitch/fov, and either with @seconds was expected";
        if (wrong)
            return pupil_refuse(why, "keyframe \"%.*s\": %s", length > 60 ? 60 : length, key, wrong);
        p->has_times = has_time;
        p->count++;
        if (!*at)
            return 0;
    }
}

/* SplitMix64 (Steele, Lea, Flood 2014), in [0, 1). */
static double draw(uint64_t *state)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void add(pupil_pan_path *p, double yaw, double pitch, double fov)
{
    p->values[YAW][p->count] = yaw;
    p->values[PITCH][p->count] = pitch;
    p->values[FOV][p->count++] = fov;
}

void pupil_pan_path_draw(pupil_pan_path *p, uint64_t seed, pupil_view brightest, pupil_view darkest, double fov)
{
    pupil_view first = darkest, second = brightest;
    memset(p, 0, sizeof *p);
    if (draw(&seed) < 0.5) {
        first = brightest;
        second = darkest;
    }
    for (int i = 0; i < 2; i++) { /* somewhere, first, second, somewhere, second, first */
        double yaw = draw(&seed) * 360 - 180, pitch = draw(&seed) * 40 - 20;
        add(p, yaw, pitch, fov);
        add(p, i ? second.yaw : first.yaw, i ? second.pitch : first.pitch, fov);
        add(p, i ? first.yaw : second.yaw, i ? first.pitch : second.pitch, fov);
    }
}

/* From one yaw to the next. Two yaws within -180..180 are directions, joined the short way; a yaw beyond that range
 * says how far to turn. */
static double turn(double from, double to)
{
    double step = to - from;
    return fabs(from) <= 180 && fabs(to) <= 180 ? step - 360 * round(step / 360) : step;
}

void pupil_pan_path_finish(pupil_pan_path *p, double duration_s)
{
    size_t n = p->count;
    double given = p->values[YAW][0];
    for (size_t k = 0; k < n && !p->has_times; k++)
        p->times[k] = n > 1 ? duration_s * (double)k / (double)(n - 1) : 0;
    for (size_t k = 1; k < n; k++) {
        double here = p->values[YAW][k];
        p->values[YAW][k] = p->values[YAW][k - 1] + turn(given, here);
        given = here;
    }
    for (int v = 0; v < 3; v++) {
        const double *y = p->values[v], *t = p->times;
        for (size_t k = 0; k < n && n > 1; k++) {
            size_t left = k ? k - 1 : 0, right = k + 1 < n ? k : n - 2;
            double h0 = t[left + 1] - t[left], h1 = t[right + 1] - t[right];
            double d0 = (y[left + 1] - y[left]) / h0, d1 = (y[right + 1] - y[right]) / h1;
            double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
            p->slopes[v][k] = d0 * d1 > 0 ? (w0 + w1) / (w0 / d0 + w1 / d1) : 0;
        }
    }
}

pupil_view pupil_pan_path_at(const pupil_pan_path *p, double time_s)
{
    double at[3];
    size_t k = 0;
    while (k + 1 < p->count && time_s >= p->times[k + 1])
        k++;
    double h = k + 1 < p->count ? p->times[k + 1] - p->times[k] : 1, s = (time_s - p->times[k]) / h;
    for (int v = 0; v < 3; v++) {
        const double *y = p->values[v] + k, *m = p->slopes[v] + k;
        if (k + 1 == p->count || s <= 0)
            at[v] = y[0];
        else /* Hermite's basis */
            at[v] = y[0] * (1 + 2 * s) * (1 - s) * (1 - s) + h * m[0] * s * (1 - s) * (1 - s) +
                    y[1] * s * s * (3 - 2 * s) - h * m[1] * s * s * (1 - s);
    }
    pupil_view view = {remainder(at[YAW], 360), at[PITCH], at[FOV]};
    return view;
}
