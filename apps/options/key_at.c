#include "key_at.h"

#include <stdlib.h>
#include <string.h>

const char key_at_right[] =
    "EV:KEY,EV:KEY,..., at most 8, for example -4:0.06,2:0.18: EV from -256 to 256, rising; KEY "
    "from 0.001 to 1, rising by at most a stop for two of EV";

int key_at_parse(const char *text, pupil_key_point key_at[PUPIL_KEY_POINTS], uint32_t *key_points)
{
    pupil_config c;
    char *end;
    pupil_config_default(&c);
    do {
        pupil_key_point p;
        if (c.key_points == PUPIL_KEY_POINTS)
            return -1;
        p.scene_ev = strtod(text, &end);
        if (end == text || *end != ':')
            return -1;
        text = end + 1;
        p.key = strtod(text, &end);
        if (end == text || (*end && *end != ','))
            return -1;
        c.key_at[c.key_points++] = p;
        text = end + 1;
    } while (*end);
    if (pupil_config_check(&c, NULL))
        return -1;
    memcpy(key_at, c.key_at, sizeof c.key_at);
    *key_points = c.key_points;
    return 0;
}
