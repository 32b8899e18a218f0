/* drivers/synth/walk.c: the camera of the scene "walk": its way, its flash, its rays. */
#include "synth/walk.h"

/* Half the field of view across, as a tangent: 70 degrees, a phone's wide camera. */
#define HALF_WIDTH 0.7f

/* Parts of the way, as shares of the clip: stand, walk to the window, look out, step back and turn round, walk on,
 * stand. */
#define WALK_FROM 0.05f
#define WALK_TO   0.42f
#define TURN_FROM 0.57f
#define TURN_TO   0.80f
#define BACK_FROM 0.54f
#define BACK_TO   0.93f

#define FLASH_AT     0.2 /* on the way, the room still dark */
#define FLASH_FRAMES 2u

void pupil_walk_view_at(uint64_t frame, uint64_t frames, pupil_walk_view *view)
{
    double last = frames > 1 ? (double)(frames - 1) : 1.0;
    float u = (float)((double)frame / last);
    float there = ramp(WALK_FROM, WALK_TO, u), back = ramp(BACK_FROM, BACK_TO, u), turn = ramp(TURN_FROM, TURN_TO, u);

    /* Eight steps there, six back: the head goes up and down once a step and left and right once in two. */
    float steps = 8.0f * there + 6.0f * back;
    float bob = wave(steps), sway = wave(0.5f * steps);
    view->eye = vec(-0.45f + 0.45f * there + 0.3f * back + 0.012f * sway, 1.56f + 0.012f * bob,
                    0.7f + 5.85f * there - 3.05f * back);

    /* Half a turn; the parabolas are not on the circle, so the direction is brought back onto it. */
    float half = 0.5f * turn + 0.004f * sway + 0.012f * (1.0f - there);
    float s = wave(half), c = wave(half + 0.25f);
    float length = sqrtf(s * s + c * c);
    s /= length;
    c /= length;
    float pitch = 0.11f * there - 0.11f * turn - 0.03f * (1.0f - there); /* up to the sun, then level */
    float level = sqrtf(1.0f + pitch * pitch);
    view->right = vec(c, 0.0f, -s);
    view->forward = vec(s / level, pitch / level, c / level);
    view->up = vec(-s * pitch / level, 1.0f / level, -c * pitch / level);

    uint64_t flash = (uint64_t)(FLASH_AT * (double)frames);
    view->flash = frame >= flash && frame < flash + FLASH_FRAMES ? 1.0f : 0.0f;
}

/* The light of one point of the picture, in pixels from its centre. */
static v3 sample(const pupil_walk_view *view, float x, float y, float pixel)
{
    v3 direction = add(view->forward, add(times(view->right, x * pixel), times(view->up, y * pixel)));
    return pupil_walk_room(view, direction);
}

static int alike(float a, float b)
{
    float difference = a - b, sum = a + b;
    return (difference < 0.0f ? -difference : difference) <= 0.06f * sum;
}

void pupil_walk_render(const pupil_walk_view *view, uint32_t width, uint32_t height, float *rgb)
{
    float pixel = 2.0f * HALF_WIDTH / (float)width; /* square pixels: the height follows */

    for (uint32_t row = 0; row < height; row++)
        for (uint32_t column = 0; column < width; column++) {
            /* Four samples on a rotated grid, no two in one row or column; two where those already agree, which
             * halves the time. */
            float x = (float)column - 0.5f * (float)width, y = 0.5f * (float)height - (float)row;
            v3 a = sample(view, x + 0.375f, y - 0.125f, pixel), b = sample(view, x + 0.625f, y - 0.875f, pixel);
            v3 sum = times(add(a, b), 0.5f);
            if (!alike(a.x, b.x) || !alike(a.y, b.y) || !alike(a.z, b.z)) {
                v3 c = sample(view, x + 0.875f, y - 0.375f, pixel), d = sample(view, x + 0.125f, y - 0.625f, pixel);
                sum = times(add(add(a, b), add(c, d)), 0.25f);
            }
            *rgb++ = sum.x;
            *rgb++ = sum.y;
            *rgb++ = sum.z;
        }
}
