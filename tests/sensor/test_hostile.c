/* The sensor's loop around a camera that misbehaves, judged by the picture: how far what is shown, and the sensor, are
 * from the key. Each row has the figures of libcamera's real code in the same place, and of this loop in 2026-11.
 *
 *     test_sensor_hostile [--all] [--table] [--row TEXT]
 *
 * --all checks the rows in which real code was ahead of the loop, too. --table prints the measurements; CONV. is the
 * worst error of the shown level in a converged frame. --row: only rows with this text in their names. */
#include <math.h>

#include "check.h"
#include "hostile_rows.h"

/* Today's figure plus one frame, or plus a tenth. */
static const hostile_row ahead[] = {
    {"step of +1 EV", hostile_step, 1, 0, 0, 6, "frames", "5", "12", "12"},
    {"step of -1 EV", hostile_step, -1, 0, 0, 6, "frames", "5", "9", "9"},
    {"step of +3 EV", hostile_step, 3, 0, 0, 6, "frames", "5", "23", "29"},
    {"step of -3 EV", hostile_step, -3, 0, 0, 6, "frames", "5", "11", "11"},
    {"step of +6 EV", hostile_step, 6, 0, 0, 6, "frames", "5", "34", "53"},
    {"step of -6 EV", hostile_step, -6, 0, 0, 6, "frames", "5", "12", "13"},
    {"starts 10 EV too bright", hostile_start, 10, 0, 0, 7, "frames", "6", "32", "71"},
    {"starts 10 EV too dark", hostile_start, -10, 0, 0, 4, "frames", "3", "3", "21"},
    {"noise of 0.02 EV, total p-p", hostile_rest, 0.02, 0, 0, 0.0143, "EV", "0.013", "0.047", "0.064"},
    {"noise of 0.05 EV, total p-p", hostile_rest, 0.05, 0, 0, 0.0352, "EV", "0.032", "0.162", "0.150"},
    {"1 % blinks +7 EV, RMS a frame", hostile_blink, 0.01, 7, 0, 0.00066, "EV", "0.0006", "0.0069", "0.0080"},
    {"light 0.1 EV at 10 Hz, shown RMS", hostile_beat, 0.1, 10, 0, 0.00088, "EV", "0.0008", "0.122", "0.126"},
    {"strobe of 1 frame, +5 EV, total p-p", hostile_strobe, 1, 5, 0, 1e-6, "EV", "0", "0.164", "0.152"},
    {"strobe of 2 frames, +5 EV, total p-p", hostile_strobe, 2, 5, 0, 1e-6, "EV", "0", "0.287", "0.287"},
};

static double worst_converged_ev; /* of all rows */

static double converged_while_wrong(const hostile_row *row)
{
    (void)row;
    return worst_converged_ev;
}

static const hostile_row behind[] = {
    {"saturation 0.7, light +4 EV", hostile_saturation, 0.7, 4, 0, 0.1, "EV", "+3.00", "right", "right"},
    {"saturation 0.7, light +5 EV", hostile_saturation, 0.7, 5, 0, 0.1, "EV", "+4.00", "right", "right"},
    {"saturation 0.7, light +6 EV", hostile_saturation, 0.7, 6, 0, 0.1, "EV", "+5.00", "right", "right"},
    {"saturation 0.7, light +8 EV", hostile_saturation, 0.7, 8, 0, 0.1, "EV", "+7.00", "right", "right"},
    {"saturation 0.95, light +4 EV", hostile_saturation, 0.95, 4, 0, 0.1, "EV", "", "right", "right"},
    {"saturation 0.95, light +5 EV", hostile_saturation, 0.95, 5, 0, 0.1, "EV", "+4.00", "right", "right"},
    {"saturation 0.95, light +6 EV", hostile_saturation, 0.95, 6, 0, 0.1, "EV", "+5.00", "right", "right"},
    {"saturation 0.95, light +8 EV", hostile_saturation, 0.95, 8, 0, 0.1, "EV", "+7.00", "right", "right"},
    {"saturation 0.98, light +4 EV", hostile_saturation, 0.98, 4, 0, 0.1, "EV", "", "right", "right"},
    {"saturation 0.98, light +5 EV", hostile_saturation, 0.98, 5, 0, 0.1, "EV", "+4.00", "right", "right"},
    {"saturation 0.98, light +6 EV", hostile_saturation, 0.98, 6, 0, 0.1, "EV", "+5.00", "right", "right"},
    {"saturation 0.98, light +8 EV", hostile_saturation, 0.98, 8, 0, 0.1, "EV", "+7.00", "right", "right"},
    {"saturation 0.9995, light +4 EV", hostile_saturation, 0.9995, 4, 0, 0.1, "EV", "", "right", "right"},
    {"saturation 0.9995, light +5 EV", hostile_saturation, 0.9995, 5, 0, 0.1, "EV", "+4.00", "right", "right"},
    {"saturation 0.9995, light +6 EV", hostile_saturation, 0.9995, 6, 0, 0.1, "EV", "+5.00", "right", "right"},
    {"saturation 0.9995, light +8 EV", hostile_saturation, 0.9995, 8, 0, 0.1, "EV", "+7.00", "right", "right"},
    {"saturation 0.9999, light +4 EV", hostile_saturation, 0.9999, 4, 0, 0.1, "EV", "", "right", "right"},
    {"saturation 0.9999, light +5 EV", hostile_saturation, 0.9999, 5, 0, 0.1, "EV", "+4.00", "right", "right"},
    {"saturation 0.9999, light +6 EV", hostile_saturation, 0.9999, 6, 0, 0.1, "EV", "+5.00", "right", "right"},
    {"saturation 0.9999, light +8 EV", hostile_saturation, 0.9999, 8, 0, 0.1, "EV", "+7.00", "right", "right"},
    {"... 0.7, +6 EV, info missing", hostile_saturation, 0.7, 6, 1, 0.1, "EV", "", "", ""},
    {"... 0.98, +6 EV, info missing", hostile_saturation, 0.98, 6, 1, 0.1, "EV", "", "", ""},
    {"... 0.9995, +6 EV, info missing", hostile_saturation, 0.9995, 6, 1, 0.1, "EV", "", "", ""},
    {"8 bits, white 254, light +6 EV", hostile_saturation_8_bits, 254.0 / 255, 6, 0, 0.1, "EV", "+5", "right", "right"},
    {"8 bits, white 250, light +6 EV", hostile_saturation_8_bits, 250.0 / 255, 6, 0, 0.1, "EV", "+5", "right", "right"},
    {"white noisy from 0.999 to 1, +6 EV", hostile_saturation_noise, 0.999, 6, 0, 0.1, "EV", "+5", "right", "right"},
    {"lens cap 10 s, then off", hostile_lens_cap_first, -20, 0, 0, 0.1, "EV", "+2.07", "right", "right"},
    {"... 10 s later, then +3 EV", hostile_lens_cap_later, 0, 3, 0, 0.1, "EV", "+5.07", "right", "right"},
    {"... info missing", hostile_lens_cap_first, -20, 0, 1, 0.1, "EV", "", "", ""},
    {"after street lamps, +3 EV", hostile_street_lamps, 3, 0, 0, 10, "frames", "1643", "0-3", ""},
    {"... then light of +1 EV", hostile_street_lamps, 3, 1, 0, 10, "frames", "", "", ""},
    {"... 2 frames late", hostile_street_lamps, 2, 0, 0, 10, "frames", "", "", ""},
    {"... 4 frames late", hostile_street_lamps, 4, 0, 0, 10, "frames", "", "", ""},
    {"... info missing", hostile_street_lamps, 3, 0, 1, 10, "frames", "", "", ""},
    {"pan, 1 EV each 0.5 s, mean error", hostile_pan, 1, 0, 0, 0.30, "EV", "0.60", "0.32", "0.37"},
    {"... info missing", hostile_pan, 1, 0, 1, 0.30, "EV", "", "", ""},
    {"10 % of the picture +3 EV, a frame", hostile_part_of_picture, 0.1, 3, 0, 0.05, "EV", "0.95", "", ""},
    {"ramp +0.1 EV/s, largest jump", hostile_ramp_jump, 0.1, 30, 0, 0.02, "EV", "", "", ""},
    {"ramp -0.1 EV/s, largest jump", hostile_ramp_jump, -0.1, 30, 0, 0.02, "EV", "", "", ""},
    {"ramp +0.3 EV/s, largest jump", hostile_ramp_jump, 0.3, 20, 0, 0.02, "EV", "0.096", "0.011-0.021", "0.006"},
    {"ramp -0.3 EV/s, largest jump", hostile_ramp_jump, -0.3, 20, 0, 0.02, "EV", "0.096", "0.011-0.021", "0.006"},
    {"ramp +1 EV/s, largest jump", hostile_ramp_jump, 1, 20, 0, 0.02, "EV", "", "", ""},
    {"ramp -1 EV/s, largest jump", hostile_ramp_jump, -1, 20, 0, 0.02, "EV", "", "", ""},
    {"ramp +0.3 EV/s, mean error", hostile_ramp_mean, 0.3, 20, 0, 0.04, "EV", "0.070", "0.042", "0.044"},
    {"ramp -0.3 EV/s, mean error", hostile_ramp_mean, -0.3, 20, 0, 0.04, "EV", "0.070", "0.042", "0.044"},
    {"timestamps constant, light +3 EV", hostile_timestamps, HOSTILE_CLOCK_CONSTANT, 3, 0, 0.1, "EV", "+3.00", "right",
     "right"},
    {"timestamps constant, light -3 EV", hostile_timestamps, HOSTILE_CLOCK_CONSTANT, -3, 0, 0.1, "EV", "", "right",
     "right"},
    {"timestamps zero, light +3 EV", hostile_timestamps, HOSTILE_CLOCK_ZERO, 3, 0, 0.1, "EV", "", "", ""},
    {"timestamps zero, light -3 EV", hostile_timestamps, HOSTILE_CLOCK_ZERO, -3, 0, 0.1, "EV", "", "", ""},
    {"timestamps jumping, light +3 EV", hostile_timestamps, HOSTILE_CLOCK_JUMPING, 3, 0, 0.1, "EV", "", "", ""},
    {"timestamps jumping, light -3 EV", hostile_timestamps, HOSTILE_CLOCK_JUMPING, -3, 0, 0.1, "EV", "", "", ""},
    {"timestamps stopped, light +3 EV", hostile_timestamps, HOSTILE_CLOCK_STOPPED, 3, 0, 0.1, "EV", "", "", ""},
    {"timestamps stopped, light -3 EV", hostile_timestamps, HOSTILE_CLOCK_STOPPED, -3, 0, 0.1, "EV", "", "", ""},
    {"timestamps going back, light +3 EV", hostile_timestamps, HOSTILE_CLOCK_BACK, 3, 0, 0.1, "EV", "", "", ""},
    {"timestamps going back, light -3 EV", hostile_timestamps, HOSTILE_CLOCK_BACK, -3, 0, 0.1, "EV", "", "", ""},
    {"bands at 25 fps, 50 Hz, 30 %", hostile_bands, 0.3, 0, 0, 0.005, "EV", "0.171", "0.000", "0.171"},
    {"gain dead from 1 to 2, jumps, -2.5 EV, swing", hostile_dead_gain_swing, -2.5, 0, 0, 0.1, "EV", "", "", ""},
    {"... final", hostile_dead_gain_wrong, -2.5, 0, 0, 0.1, "EV", "", "", ""},
    {"gain dead from 1 to 2, jumps, -2.65 EV, swing", hostile_dead_gain_swing, -2.65, 0, 0, 0.1, "EV", "1.4", "1.5",
     "1.1"},
    {"... final", hostile_dead_gain_wrong, -2.65, 0, 0, 0.1, "EV", "", "", ""},
    {"gain dead from 1 to 2, jumps, -3 EV, swing", hostile_dead_gain_swing, -3, 0, 0, 0.1, "EV", "", "", ""},
    {"... final", hostile_dead_gain_wrong, -3, 0, 0, 0.1, "EV", "", "", ""},
    {"gain dead from 1 to 2, jumps, -4 EV, swing", hostile_dead_gain_swing, -4, 0, 0, 0.1, "EV", "", "", ""},
    {"... final", hostile_dead_gain_wrong, -4, 0, 0, 0.1, "EV", "", "", ""},
    {"gain dead from 1 to 2, goes on, -2.5 EV, swing", hostile_dead_gain_swing, -2.5, 1, 0, 0.1, "EV", "", "", ""},
    {"... final", hostile_dead_gain_wrong, -2.5, 1, 0, 0.1, "EV", "", "", ""},
    {"gain dead from 1 to 2, goes on, -2.65 EV, swing", hostile_dead_gain_swing, -2.65, 1, 0, 0.1, "EV", "", "", ""},
    {"... final", hostile_dead_gain_wrong, -2.65, 1, 0, 0.1, "EV", "", "", ""},
    {"gain dead from 1 to 2, goes on, -3 EV, swing", hostile_dead_gain_swing, -3, 1, 0, 0.1, "EV", "", "", ""},
    {"... final", hostile_dead_gain_wrong, -3, 1, 0, 0.1, "EV", "", "", ""},
    {"gain dead from 1 to 2, goes on, -4 EV, swing", hostile_dead_gain_swing, -4, 1, 0, 0.1, "EV", "", "", ""},
    {"... final", hostile_dead_gain_wrong, -4, 1, 0, 0.1, "EV", "", "", ""},
    {"black level 0.17 too low", hostile_black_level, 0.1716, 0, 0, 1.5, "EV", "4.96", "1.45", "1.43"},
    {"... and not named", hostile_black_level_unnamed, 0.1716, 0, 0, 0, "", "", "", ""},
    {"exposures 2^n, +0.5 EV, shown", hostile_powers_of_two_shown, 0.5, 0.5, 0, 0.05, "EV", "0.81", "", ""},
    {"... sensor", hostile_powers_of_two_sensor, 0.5, 0.5, 0, 0.1, "EV", "0.81", "", ""},
    {"... -2 to +2 EV, shown", hostile_powers_of_two_shown, -2, 2, 0, 0.05, "EV", "", "", ""},
    {"... sensor", hostile_powers_of_two_sensor, -2, 2, 0, 0.1, "EV", "", "", ""},
    /* far_ev, changed by clipped light and the rounding of the setting */
    {"CONVERGED while this is shown wrong", converged_while_wrong, 0, 0, 0, 0.15, "EV", "", "", ""},
};

static void walk(const hostile_row *rows, size_t count, int is_printed, const char *text)
{
    for (size_t i = 0; i < count; i++) {
        const hostile_row *row = &rows[i];
        if (!strstr(row->name, text))
            continue;
        hostile.converged_ev = 0.0;
        const double value = row->measure(row);
        worst_converged_ev = fmax(worst_converged_ev, hostile.converged_ev);
        const int is_good = value <= row->limit + 1e-12; /* the rounding of logarithms */
        if (is_printed)
            printf("%-44s %8.4g %8.4g %-6s %-4s %6.3f %8s %12s %8s\n", row->name, row->limit, value, row->unit,
                   is_good ? "" : "FAIL", hostile.converged_ev, row->before, row->rpi, row->libipa);
        CHECK_MSG(is_good, "%s: %g %s, limit %g", row->name, value, row->unit, row->limit);
    }
}

static int has_option(int argc, char **argv, const char *option)
{
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], option) == 0)
            return 1;
    return 0;
}

int main(int argc, char **argv)
{
    const int is_printed = has_option(argc, argv, "--table");
    const char *text = "";
    for (int i = 1; i + 1 < argc; i++)
        text = strcmp(argv[i], "--row") == 0 ? argv[i + 1] : text;
    check_begin(1, argv);
    if (is_printed)
        printf("%-44s %8s %8s %-6s %-4s %6s %8s %12s %8s\n", "row", "limit", "measured", "", "", "CONV.", "2026-11",
               "rpi", "libipa");
    walk(ahead, sizeof ahead / sizeof *ahead, is_printed, text);
    if (has_option(argc, argv, "--all"))
        walk(behind, sizeof behind / sizeof *behind, is_printed, text);
    return check_end();
}
