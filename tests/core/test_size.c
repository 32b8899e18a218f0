/* The sizes that callers compile in, printed on every run. */
#include "check.h"
#include "pupil/pupil.h"

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    printf("sizes in bytes: pupil_t %zu, pupil_stats %zu, pupil_config %zu, pupil_exposure %zu, pupil_curve %zu\n",
           sizeof(pupil_t), sizeof(pupil_stats), sizeof(pupil_config), sizeof(pupil_exposure), sizeof(pupil_curve));
    CHECK(sizeof(pupil_t) == PUPIL_OBJECT_BYTES && sizeof(pupil_t) % sizeof(uint64_t) == 0);
    /* the same on every ABI: fixed-width members without holes */
    CHECK(sizeof(pupil_stats) == 12 * 8 + 6 * 4 + (PUPIL_HISTOGRAM_BINS + PUPIL_PEAK_BINS) * 8 + PUPIL_BANDS * 12);
    CHECK(sizeof(pupil_stats) < sizeof(pupil_t));
    CHECK(sizeof(pupil_curve) == 10 * 4 + PUPIL_CURVE_KNOTS * 4);
    CHECK(strcmp(pupil_version(), "0.2.0") == 0);
    return check_end();
}
