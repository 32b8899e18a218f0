/* What the loop does with cameras of every fault that docs/camera-answers.md has a rule for, in lights that change: a
 * line for each camera and light, compared with loops.txt. Lines that differ show the effect of a change of the loop;
 * where it is intended, --write stores them, and the commit says why they are better.
 *
 *     off       frames in which the sensor is over 0.25 EV off
 *     asked     settings that were asked for
 *     sensor, shown, scene  how far these are off on average, in 1/1000 EV: the setting, what is shown, scene_ev
 *     ms, gain  the last setting; then the delays and the slope that were found, the mask of all limits that it was
 *               at, and how often day and night changed
 *     state     and for how many frames: Empty, Searching, Converged, Limited, cLipped (X), Flicker, locKed; and why at
 *               last */
#include <stdio.h>

#include "expected_lines.h"
#include "scripted_loop.h"

enum { FRAMES = 150, LINE_BYTES = 240 };

static const scripted_camera cameras[] = {
    {.name = "plain"},
    {.name = "delay 1", .delay = {1, 1}, .believed = 1},
    {.name = "delay 4, believed 2", .delay = {4, 4}},
    {.name = "delay 1, believed 4", .delay = {1, 1}, .believed = 4, .told = TOLD_NOTHING},
    {.name = "delays 3 and 1", .delay = {3, 1}, .believed = 3, .told = TOLD_NOTHING},
    {.name = "delays 1 and 2, told asked", .delay = {1, 2}, .believed = 4, .told = TOLD_ASKED},
    {.name = "tells nothing", .told = TOLD_NOTHING},
    {.name = "tells what was first", .told = TOLD_FIRST},
    {.name = "tells half", .told = TOLD_HALF},
    {.name = "tells late", .told = TOLD_LATE},
    {.name = "powers of two", .exposures = POWERS_OF_TWO},
    {.name = "powers of two, untold", .exposures = POWERS_OF_TWO, .told = TOLD_NOTHING},
    {.name = "powers of two, no gain", .exposures = POWERS_OF_TWO, .gain_max = 1.0},
    {.name = "the same, untold", .exposures = POWERS_OF_TWO, .gain_max = 1.0, .told = TOLD_NOTHING, .slope = 0.7},
    {.name = "three exposures", .exposures = THREE_EXPOSURES},
    {.name = "half stops, 50 Hz", .exposures = HALF_STOPS, .mains_hz = 50},
    {.name = "four gains", .gains = FOUR_GAINS},
    {.name = "two gains", .gains = TWO_GAINS, .mains_hz = 50},
    {.name = "decibels", .gains = DECIBELS, .mains_hz = 60},
    {.name = "reciprocal", .gains = RECIPROCAL, .told = TOLD_NOTHING},
    {.name = "gamma", .slope = 0.5, .is_curved = 1},
    {.name = "gamma, taken for linear", .slope = 0.5, .told = TOLD_NOTHING},
    {.name = "steep", .slope = 1.8, .is_curved = 1, .delay = {3, 3}, .believed = 4},
    {.name = "gain jumps", .jump_gain = 3.0, .jump = 1.5, .told = TOLD_NOTHING},
    {.name = "gain falls", .jump_gain = 4.0, .jump = 0.7, .is_curved = 1},
    {.name = "weak gain", .weak = {0.0, 0.5}, .told = TOLD_NOTHING},
    {.name = "strong exposure", .weak = {1.6, 0.0}, .told = TOLD_NOTHING, .is_curved = 1},
    {.name = "dead exposure", .weak = {-1.0, 0.0}, .told = TOLD_NOTHING},
    {.name = "dead exposure, believed", .weak = {-1.0, 0.0}},
    {.name = "dead gain", .weak = {0.0, -1.0}},
    {.name = "all dead", .weak = {-1.0, -1.0}, .told = TOLD_NOTHING},
    {.name = "coarse, gain jumps", .gains = FOUR_GAINS, .jump_gain = 2.0, .jump = 1.4, .told = TOLD_NOTHING},
    {.name = "coarse, gain falls", .gains = FOUR_GAINS, .jump_gain = 4.0, .jump = 0.7, .weak = {1.3, 0.0}},
    {.name = "all coarse, gain jumps",
     .exposures = THREE_EXPOSURES,
     .gains = FOUR_GAINS,
     .jump_gain = 4.0,
     .jump = 1.5},
    {.name = "all coarse, curved", .exposures = POWERS_OF_TWO, .gains = FOUR_GAINS, .slope = 0.6, .told = TOLD_NOTHING},
    {.name = "all coarse, weak",
     .exposures = POWERS_OF_TWO,
     .gains = TWO_GAINS,
     .weak = {0.7, 0.6},
     .told = TOLD_FIRST},
    {.name = "rounded, weak gain",
     .exposures = POWERS_OF_TWO,
     .weak = {0.0, 0.6},
     .is_curved = 1,
     .told = TOLD_NOTHING},
    {.name = "knee", .knee = 0.1, .is_curved = 1, .told = TOLD_NOTHING},
    {.name = "black level", .black = 0.07},
    {.name = "full at 0.8", .white = 0.8},
    {.name = "full at 0.6", .white = 0.6},
    {.name = "lamp", .lamp = 0.1},
    {.name = "lamp, not held back", .lamp = 0.1, .highlight_ev = -1.0},
    {.name = "its own auto", .own_auto_from = 20, .own_auto_to = 90, .told = TOLD_NOTHING},
    {.name = "its own auto, told", .own_auto_from = 40, .own_auto_to = 70},
    {.name = "loses a third", .loses = 3},
    {.name = "loses a seventh, untold", .loses = 7, .told = TOLD_NOTHING, .delay = {4, 4}, .believed = 4},
    {.name = "night", .key_at_night = 0.06, .day_night_s = 0.5},
    {.name = "lamps", .lamp_hz = 100.05, .fps = 32.0, .delay = {3, 3}, .believed = 3},
    {.name = "lamps, mains unknown",
     .lamp_hz = 120.1,
     .lamp = 0.1,
     .fps = 32.5,
     .mains_hz = PUPIL_SENSOR_MAINS_AUTO,
     .told = TOLD_NOTHING},
    {.name = "no clock", .has_no_clock = 1},
    {.name = "stages", .stages = 1, .mains_hz = 50},
};
enum { CAMERAS = sizeof cameras / sizeof cameras[0] };

static const script lights[] = {
    {"room, sun, room", {{0, LIGHT, 4.0}, {50, LIGHT, 8.5}, {100, LIGHT, 4.6}}},
    {"dark, less, dim", {{0, LIGHT, -0.5}, {60, LIGHT, -2.3}, {105, LIGHT, 1.3}}},
    {"ramps", {{0, LIGHT, 3.0}, {30, RAMP, 0.03}, {60, RAMP, -0.06}, {110, RAMP, 0.0}}},
    {"flashes, cover", {{0, LIGHT, 2.0}, {25, FLASH, 4.0}, {45, FLASH, -3.0}, {70, COVERED, 12}, {110, LIGHT, 11.0}}},
    {"announced", {{0, LIGHT, 5.0}, {30, ANNOUNCED, -2.5}, {60, FILTER, 3.0}, {90, FILTER, -2.0}, {120, LIGHT, 4.0}}},
    {"modes",
     {{0, LIGHT, 1.0},
      {30, GAIN_MODE, PUPIL_SENSOR_MANUAL},
      {50, EXPOSURE_MODE, PUPIL_SENSOR_HELD},
      {60, LIGHT, 2.5},
      {70, GAIN_MODE, PUPIL_SENSOR_AUTO},
      {90, LOCK, 1},
      {100, LIGHT, 1.7},
      {110, LOCK, 0}}},
    {"limits",
     {{0, LIGHT, -4.0}, {40, GAIN_MAX, 4.0}, {70, FRAME_PERIOD, 2.0}, {90, LIGHT, 13.0}, {120, EXPOSURE_MODE, 1}}},
    {"steps",
     {{0, LIGHT, 4.01},
      {22, LIGHT, 2.90},
      {44, LIGHT, 3.52},
      {66, LIGHT, 3.16},
      {88, LIGHT, 3.05},
      {110, LIGHT, 3.76},
      {132, LIGHT, 3.75}}},
    {"half dark",
     {{0, LIGHT, 3.0}, {30, HALF_DARK, 0.54}, {36, HALF_DARK, 0.3}, {75, LIGHT, 5.0}, {110, HALF_DARK, 0}}},
    {"held",
     {{0, LIGHT, 2.9},
      {30, GAIN_MODE, PUPIL_SENSOR_HELD},
      {30, EXPOSURE_MODE, PUPIL_SENSOR_HELD},
      {50, LIGHT, 4.0},
      {70, EXPOSURE_MODE, PUPIL_SENSOR_AUTO},
      {90, GAIN_MODE, PUPIL_SENSOR_AUTO},
      {110, LIGHT, 0.3}}},
    {"creeps", {{0, LIGHT, 6.0}, {20, RAMP, -0.005}, {80, RAMP, 0.01}, {115, LIGHT, 6.4}, {130, LIGHT, 6.05}}},
};
enum { LIGHTS = sizeof lights / sizeof lights[0] };

typedef struct states {
    char text[96], last;
    int repeats;
} states;

static void count_state(states *seen, char state)
{
    const size_t n = strlen(seen->text);
    if (seen->repeats && state != seen->last) {
        snprintf(seen->text + n, sizeof seen->text - n, "%c%d ", seen->last, seen->repeats);
        seen->repeats = 0;
    }
    seen->last = state;
    seen->repeats++;
}

static void run(const scripted_camera *c, const script *at, char line[LINE_BYTES])
{
    static scripted_loop l;
    states seen = {.repeats = 0};
    const pupil_sensor_config config = scripted_config(c);
    const pupil_sensor_setting *s = &l.s;
    const double in_line = 1e3 / FRAMES;
    scripted_open(&l, c, &config, at);
    while (l.frame < FRAMES) {
        scripted_frame(&l);
        count_state(&seen, "ESCLXFK"[s->state]);
    }
    count_state(&seen, 0);
    CHECK(!l.errors);
    snprintf(line, LINE_BYTES, "%-27s %-16s %3d %3d %5.0f %5.0f %5.0f %7.3f %7.4f %2u %2u %.3f %02x %d %s%s\n", c->name,
             at->name, l.off, l.settings, in_line * l.sensor_ev, in_line * l.shown_ev, in_line * l.scene_off_ev,
             1e3 * s->exposure_s, s->gain, s->exposure_delay, s->gain_delay, s->slope, l.limits, l.day_changes,
             seen.text, pupil_sensor_reason_name(s->reason));
}

int main(int argc, char **argv)
{
    static char line[LINE_BYTES];
    const expected_lines table = expected_begin("loops.txt", argc, argv);
    for (int i = 0; table.file && i < CAMERAS * LIGHTS && check_state.failures < 20; i++) { /* more are not printed */
        run(&cameras[i / LIGHTS], &lights[i % LIGHTS], line);
        expected_line(&table, line);
    }
    return expected_end(&table);
}
