#include "keys.h"

#include <math.h>
#include <stdio.h>

#include "window/window.h"

const char view_keys_help[] = "1 2 3 4     the study's formulas\n"
                              "0           the law in seconds\n"
                              "[ ]         faster, slower\n"
                              "- +         darker, brighter by 1/3 stop\n"
                              "l           lock the level\n"
                              "s           split: first exposure, adapted\n"
                              "left right  move the split\n"
                              "p           plot of the level\n"
                              "e           edges, where the picture is sharp\n"
                              "space       pause\n"
                              "f           full screen\n"
                              "h           these keys\n"
                              "q           quit";

/* A setting times or divided by the square root of two, within limits that differ visibly from none and from
 * forever. */
static double stepped(double value, int more, double least, double most)
{
    const double next = value * (more ? M_SQRT2 : M_SQRT1_2);
    return next < least ? least : next > most ? most : next;
}

void view_keys_law(const pupil_config *config, char *text, size_t text_bytes)
{
    if (config->law == PUPIL_LAW_SECONDS)
        snprintf(text, text_bytes, "seconds, tau %.2g and %.2g s", config->tau_light_s, config->tau_dark_s);
    else
        snprintf(text, text_bytes, "formula %u, weight %.2g", (unsigned)(config->law - PUPIL_LAW_ARITHMETIC_SCALE + 1),
                 config->frame_weight);
}

static void slower(pupil_config *config, int more)
{
    if (config->law == PUPIL_LAW_SECONDS) {
        config->tau_light_s = stepped(config->tau_light_s, more, 0.01, 100.0);
        config->tau_dark_s = stepped(config->tau_dark_s, more, 0.01, 100.0);
    } else {
        config->frame_weight = stepped(config->frame_weight, !more, 0.001, 1.0);
    }
}

static void brighter(pupil_config *config, double stops)
{
    const double ev = config->ev_compensation + stops;
    config->ev_compensation = fabs(ev) < 1e-9 ? 0.0 : ev < -16.0 ? -16.0 : ev > 16.0 ? 16.0 : ev; /* config.h */
}

int view_keys_take(int key, pupil_config *config, char *said, size_t said_bytes)
{
    switch (key) {
    case '0':
    case '1':
    case '2':
    case '3':
    case '4':
        config->law = key == '0' ? PUPIL_LAW_SECONDS : (uint32_t)(PUPIL_LAW_ARITHMETIC_SCALE + (key - '1'));
        view_keys_law(config, said, said_bytes);
        return 1;
    case '[':
    case ']':
        slower(config, key == ']');
        view_keys_law(config, said, said_bytes);
        return 1;
    case '+':
    case '=': /* the same key without shift on many keyboards */
    case PUPIL_WINDOW_UP:
    case '-':
    case PUPIL_WINDOW_DOWN:
        brighter(config, key == '-' || key == PUPIL_WINDOW_DOWN ? -1.0 / 3.0 : 1.0 / 3.0);
        snprintf(said, said_bytes, "EV %+.2f", config->ev_compensation);
        return 1;
    case 'l':
    case 'L':
        config->lock = !config->lock;
        snprintf(said, said_bytes, config->lock ? "locked" : "not locked");
        return 1;
    default:
        return 0;
    }
}
