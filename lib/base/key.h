/* lib/base/key.h: a key that depends on the light, as pupil_config and pupil_sensor_config have it. */
#ifndef PUPIL_BASE_KEY_H
#define PUPIL_BASE_KEY_H

#include "pupil/config.h"

/* log2 of the key where the scene's light is ev: `key`, or with points that of key_at. */
double pupil_key_log2(double key, const pupil_key_point *key_at, uint32_t points, double ev);

/* What is wrong with the points, or NULL. */
const char *pupil_key_fault(const pupil_key_point *key_at, uint32_t points);

#endif
