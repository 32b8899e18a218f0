#include "key.h"

#include "numeric.h"

double pupil_key_log2(double key, const pupil_key_point *key_at, uint32_t points, double ev)
{
    double sum = pupil_log2(points ? key_at[0].key : key);
    for (const pupil_key_point *p = key_at + 1; p < key_at + points; p++)
        sum += clamp((ev - p[-1].scene_ev) / (p->scene_ev - p[-1].scene_ev), 0.0, 1.0) * pupil_log2(p->key / p[-1].key);
    return sum;
}

const char *pupil_key_fault(const pupil_key_point *key_at, uint32_t points)
{
    for (const pupil_key_point *p = key_at; p < key_at + points; p++)
        if (!(p->scene_ev >= -256.0 && p->scene_ev <= 256.0 && p->key >= 0x1p-10 && p->key <= 1.0) ||
            (p > key_at && !(p->scene_ev > p[-1].scene_ev && p->key >= p[-1].key && /* a stop for two, or rounded */
                             pupil_log2(p->key / p[-1].key) <= 0.5 * (p->scene_ev - p[-1].scene_ev) + 1e-9)))
            return "key_at must have scene_ev from -256 to 256, rising, and key from 2^-10 to 1, never falling, "
                   "rising by at most a stop for two of light";
    return 0;
}
