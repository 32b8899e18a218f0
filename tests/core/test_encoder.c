/* The encoder is exact: code = floor(255 * encode(x) + 0.5) with encode in long double, for a dense sweep of floats and
 * for the two floats on either side of every boundary between codes.
 */
#include "check.h"
#include "reference.h"

#include <math.h>

#define AT_ONCE 8192

static float value[AT_ONCE];
static unsigned count;
static uint64_t tried, wrong, far_off;

/* Grey through a curve that multiplies by exactly 1: scale 1, white 1. */
static void flush(const pupil_t *pupil, uint32_t transfer)
{
    static float rgb[3 * AT_ONCE];
    static unsigned char code[3 * AT_ONCE];
    const pupil_curve one = {.scale = 1, .inverse_white_squared = 1};
    const pupil_image_const in = {
        .data = rgb, .stride_bytes = (ptrdiff_t)sizeof rgb, .width = count, .height = 1, .pixel = PUPIL_PIXEL_RGB32F};
    const pupil_image out = {
        .data = code, .stride_bytes = (ptrdiff_t)sizeof code, .width = count, .height = 1, .pixel = PUPIL_PIXEL_RGB8};
    if (!count)
        return;
    for (unsigned i = 0; i < 3 * count; i++)
        rgb[i] = value[i / 3];
    CHECK(pupil_map_rows(pupil, &one, &in, &out) == PUPIL_OK);
    for (unsigned i = 0; i < count; i++) {
        const long double exact = ref_encode(transfer, value[i]);
        const int right = (int)floorl(exact + 0.5L);
        tried++;
        if (code[3 * i] == right && code[3 * i + 1] == right && code[3 * i + 2] == right)
            continue;
        if (fabsl(fabsl(exact - right) - 0.5L) < 1e-15L)
            continue; /* a tie as far as long double can distinguish */
        wrong++;
        far_off += abs(code[3 * i] - right) > 1;
        CHECK_MSG(0, "transfer %u: %.9g became %d, wanted %.9Lg", transfer, value[i], code[3 * i], exact);
    }
    count = 0;
}

static void try(const pupil_t *pupil, uint32_t transfer, float x)
{
    if (count == AT_ONCE)
        flush(pupil, transfer);
    value[count++] = x;
}

/* The light at which the code k begins. */
static float boundary(uint32_t transfer, int k)
{
    const long double code = (k - 0.5L) / 255;
    if (transfer == PUPIL_TRANSFER_LINEAR)
        return (float)code;
    if (transfer == PUPIL_TRANSFER_GAMMA22)
        return (float)powl(code, 2.2L);
    return (float)(code <= 12.92L * 0.0031308L ? code / 12.92L : powl((code + 0.055L) / 1.055L, 2.4L));
}

int main(int argc, char **argv)
{
    check_begin(argc, argv);
    for (uint32_t transfer = 0; transfer < PUPIL_TRANSFER_COUNT; transfer++) {
        pupil_config config;
        pupil_t pupil;
        tried = wrong = far_off = 0;
        pupil_config_default(&config);
        config.transfer = transfer;
        CHECK(pupil_init(&pupil, &config) == PUPIL_OK);
        for (int k = 1; k <= 255; k++) {
            float x = boundary(transfer, k);
            for (int i = 0; i < 3; i++)
                x = nextafterf(x, 0);
            for (int i = 0; i < 7; i++, x = nextafterf(x, 2))
                try(&pupil, transfer, x);
        }
        for (uint32_t bits = 0; bits <= 0x3f800010; bits += 1499) { /* every float would take minutes */
            float x;
            memcpy(&x, &bits, 4);
            try(&pupil, transfer, x);
        }
        for (int i = 0; i < 200000; i++)
            try(&pupil, transfer, (float)check_uniform());
        flush(&pupil, transfer);
        printf("transfer %u: %llu floats encoded, %llu codes wrong\n", transfer, (unsigned long long)tried,
               (unsigned long long)wrong);
        CHECK(wrong == 0 && far_off == 0);
    }
    return check_end();
}
