/* drivers/synth/walk_room.c: the room of the scene "walk": its surfaces, what is on them, and the light they get. */
#include "synth/walk.h"

/* The room, the opening of its window in the wall z = DEPTH, and how deep the window sits in that wall. */
#define HALF   2.4f
#define HEIGHT 2.75f
#define DEPTH  8.0f
#define WIN_X  1.3f
#define WIN_LO 0.72f
#define WIN_HI 2.42f
#define RECESS 0.24f

/* Window bars: outer frame, one upright in the middle, one across. */
#define BAR    0.035f
#define BAR_Y  1.86f
#define BORDER 0.06f

typedef struct surface {
    v3 point, normal, albedo, emitted;
    float shade; /* darkening in corners, 0..1 */
} surface;

static const v3 lamp = {-2.12f, 1.03f, 4.1f};
#define LAMP_RADIUS 0.19f

static const v3 chest_lo = {-HALF, 0.0f, 3.3f}, chest_hi = {-1.9f, 0.84f, 5.3f};

/* Share of the sun that reaches a point of the floor: its ray crosses the window beside the bars. The penumbra widens
 * with the distance from the window. */
static float sunlight(v3 p)
{
    v3 sun = pupil_walk_sun();
    float t = DEPTH + RECESS - p.z, x = p.x + t * sun.x, y = p.y + t * sun.y, soft = 0.01f + 0.008f * t;
    float pane = band(-WIN_X + BORDER, WIN_X - BORDER, soft, x) * band(WIN_LO + BORDER, WIN_HI - BORDER, soft, y);
    float bars = (1.0f - band(-BAR, BAR, soft, x)) * (1.0f - band(BAR_Y - BAR, BAR_Y + BAR, soft, y));
    return pane * bars;
}

/* Light from a small source: cosine over squared distance, `size` keeps it finite. */
static float from_point(v3 p, v3 n, v3 source, float size)
{
    v3 to = sub(source, p);
    float d2 = dot(to, to) + size, c = dot(n, to);
    return c > 0.0f ? c / (d2 * sqrtf(d2)) : 0.0f;
}

/* Light from a surface that faces the direction `out`: the second cosine. */
static float from_area(v3 p, v3 n, v3 source, v3 out)
{
    v3 to = sub(source, p);
    float d2 = dot(to, to) + 1.0f, c = dot(n, to), e = -dot(out, to);
    return c > 0.0f && e > 0.0f ? c * e / (d2 * d2) : 0.0f;
}

static v3 lit(const pupil_walk_view *view, const surface *s)
{
    v3 p = s->point, n = s->normal;
    v3 light = vec(0.021f, 0.020f, 0.022f); /* what bounces everywhere */
    float window = from_area(p, n, vec(0.0f, 1.6f, DEPTH), vec(0.0f, 0.0f, -1.0f));
    light = add(light, times(vec(0.86f, 0.95f, 1.08f), 9.0f * window));
    float patch = from_area(p, n, vec(1.0f, 0.0f, 4.3f), vec(0.0f, 1.0f, 0.0f));
    light = add(light, times(vec(1.05f, 0.80f, 0.58f), 1.5f * patch));
    light = add(light, times(vec(1.0f, 0.66f, 0.34f), 0.10f * from_point(p, n, lamp, 0.02f)));
    light = times(light, s->shade);
    if (view->flash > 0.0f)
        light = add(light, times(vec(1.0f, 1.0f, 1.05f), 80.0f * view->flash * from_point(p, n, view->eye, 0.5f)));
    if (n.y > 0.5f && p.y < 1.0f)
        light = add(light, times(vec(1.0f, 0.84f, 0.62f), 9.0f * sunlight(p)));
    return add(mul(light, s->albedo), s->emitted);
}

static float corner(float distance)
{
    return (distance + 0.05f) / (distance + 0.13f);
}

/* --- what is on the surfaces --- */

static v3 rug(float x, float z)
{
    float edge = x < 1.0f - x ? x : 1.0f - x, end = z < 1.0f - z ? z : 1.0f - z;
    edge = edge < 1.4f * end ? edge : 1.4f * end; /* the rug is longer than wide */
    v3 red = vec(0.30f, 0.055f, 0.045f), blue = vec(0.05f, 0.08f, 0.17f), cream = vec(0.55f, 0.47f, 0.33f);
    if (edge < 0.03f || (edge > 0.13f && edge < 0.15f))
        return cream;
    if (edge < 0.13f)
        return mix(blue, cream, band(0.055f, 0.105f, 0.006f, edge) * ramp(0.1f, 0.4f, wave((x + z) * 14.0f)));
    float diamond = wave(4.0f * x - 0.25f) + wave(5.0f * z - 0.25f);
    return mix(red, mix(blue, cream, ramp(1.2f, 1.3f, diamond)), ramp(0.75f, 0.85f, diamond));
}

static v3 floor_albedo(v3 p, float distance)
{
    const float wide = 0.15f, longish = 1.3f;
    if (p.x > -1.15f && p.x < 1.15f && p.z > 2.0f && p.z < 5.2f)
        return times(rug((p.x + 1.15f) / 2.3f, (p.z - 2.0f) / 3.2f), 0.85f + 0.3f * noise(p.x * 40.0f, p.z * 40.0f));
    float column = p.x / wide;
    int32_t i = floor_int(column);
    float row = p.z / longish + 3.7f * lattice(i, 77);
    int32_t k = floor_int(row);
    float tone = 0.75f + 0.4f * lattice(i, k), grain = noise(p.x * 55.0f, p.z * 4.0f + 13.0f * tone);
    float fx = column - (float)i, fz = row - (float)k;
    /* Gaps fade with distance, where they are thinner than a pixel. */
    float gap = fx < 0.05f || fz < 0.006f ? clamp01(2.2f / (distance * distance + 0.5f)) : 0.0f;
    return times(vec(0.40f, 0.245f, 0.135f), tone * (0.82f + 0.36f * grain) * (1.0f - 0.75f * gap));
}

/* A picture of the given size: wooden frame, mount, and a painted landscape; u and v run 0..1 inside it. */
static v3 picture(float u, float v, float width, float height, float kind)
{
    float x = u * width, y = v * height;
    float edge = x < width - x ? x : width - x, end = y < height - y ? y : height - y;
    edge = edge < end ? edge : end;
    if (edge < 0.05f)
        return times(vec(0.16f, 0.085f, 0.04f), 0.7f + 12.0f * edge);
    if (edge < 0.12f)
        return vec(0.78f, 0.76f, 0.70f);
    float hill = 0.33f + 0.13f * wave(1.3f * u + kind) + 0.05f * wave(3.7f * u);
    float dx = (u - 0.66f) * width, dy = (v - 0.62f) * height;
    v3 colour = mix(vec(0.75f, 0.42f, 0.16f), vec(0.10f, 0.22f, 0.42f), ramp(0.3f, 0.95f, v));
    if (dx * dx + dy * dy < 0.008f)
        colour = vec(0.85f, 0.70f, 0.42f);
    if (v < hill)
        colour = mix(vec(0.03f, 0.09f, 0.08f), vec(0.13f, 0.22f, 0.12f), ramp(hill - 0.3f, hill, v));
    return colour;
}

static int within(float x, float lo, float hi)
{
    return x > lo && x < hi;
}

static v3 painted(float along, float y)
{
    v3 paint = times(vec(0.60f, 0.63f, 0.58f), 0.96f + 0.08f * noise(along * 17.0f, y * 17.0f));
    if (y < 0.12f || within(y, 0.93f, 0.98f) || y > HEIGHT - 0.07f)
        return vec(0.74f, 0.71f, 0.64f); /* skirting, rail, moulding */
    if (y < 0.93f) {                     /* panels */
        float f = along / 0.8f;
        f = f - (float)floor_int(f);
        float line =
            within(f, 0.1f, 0.9f) && within(y, 0.2f, 0.85f) && !(within(f, 0.125f, 0.875f) && within(y, 0.22f, 0.83f))
                ? 0.62f
                : 1.0f;
        return times(vec(0.36f, 0.40f, 0.37f), line);
    }
    return paint;
}

static v3 side_albedo(v3 p)
{
    if (p.x > 0.0f && within(p.z, 3.1f, 4.7f) && within(p.y, 1.15f, 2.2f))
        return picture((4.7f - p.z) / 1.6f, (p.y - 1.15f) / 1.05f, 1.6f, 1.05f, 0.1f);
    if (p.x < 0.0f && within(p.z, 4.45f, 5.2f) && within(p.y, 1.3f, 2.2f))
        return picture((p.z - 4.45f) / 0.75f, (p.y - 1.3f) / 0.9f, 0.75f, 0.9f, 0.45f);
    return painted(p.z, p.y);
}

static v3 back_albedo(v3 p)
{
    if (within(p.x, -1.9f, -0.8f) && p.y < 2.15f) { /* a door */
        if (!(within(p.x, -1.8f, -0.9f) && p.y < 2.05f))
            return vec(0.74f, 0.71f, 0.64f);
        float dx = p.x + 0.99f, dy = p.y - 1.0f;
        if (dx * dx + dy * dy < 0.0012f)
            return vec(0.85f, 0.66f, 0.28f);
        float x = p.x < -1.35f ? p.x + 1.8f : -0.9f - p.x;
        int panel = within(x, 0.1f, 0.4f) && (within(p.y, 0.2f, 0.95f) || within(p.y, 1.15f, 1.9f));
        return times(vec(0.30f, 0.17f, 0.09f), panel ? 0.75f : 1.0f);
    }
    if (within(p.x, -0.1f, 1.7f) && within(p.y, 1.1f, 2.25f))
        return picture((1.7f - p.x) / 1.8f, (p.y - 1.1f) / 1.15f, 1.8f, 1.15f, 0.7f);
    return painted(p.x, p.y);
}

/* Curtains on both sides of the window: folds, and some of the daylight behind them. */
static v3 front_albedo(v3 p, v3 *emitted)
{
    float x = p.x > 0.0f ? p.x : -p.x;
    if (within(p.y, WIN_HI + 0.1f, WIN_HI + 0.13f) && x < 2.1f)
        return vec(0.10f, 0.07f, 0.05f); /* the rod */
    if (within(x, WIN_X + 0.02f, 2.0f) && within(p.y, 0.06f, WIN_HI + 0.13f)) {
        float fold = 0.5f + 0.5f * wave(x * 8.0f + 0.25f * wave(p.y * 0.35f));
        *emitted = times(vec(0.34f, 0.12f, 0.06f), (0.25f + 0.75f * fold) * (1.0f - ramp(WIN_X, 2.0f, x)));
        return times(vec(0.50f, 0.13f, 0.08f), 0.35f + 0.65f * fold);
    }
    return painted(p.x, p.y);
}

/* --- where a ray ends --- */

/* The globe lamp on the chest. */
static int hit_lamp(v3 o, v3 d, surface *s)
{
    v3 to = sub(lamp, o);
    float a = dot(d, d), b = dot(d, to), c = dot(to, to) - LAMP_RADIUS * LAMP_RADIUS, root = b * b - a * c;
    if (b <= 0.0f || root <= 0.0f)
        return 0;
    s->point = add(o, times(d, (b - sqrtf(root)) / a));
    s->normal = times(sub(s->point, lamp), 1.0f / LAMP_RADIUS);
    float facing = -dot(s->normal, d) / sqrtf(a);
    s->albedo = vec(0.5f, 0.48f, 0.42f);
    s->emitted = times(vec(2.6f, 1.75f, 0.95f), 0.35f + 0.65f * facing);
    return 1;
}

static int on_chest(v3 p, v3 normal, v3 albedo, surface *s)
{
    s->point = p;
    s->normal = normal;
    s->albedo = albedo;
    return 1;
}

/* The chest stands at the left wall, so that the camera only ever sees its top, its front and its two ends. */
static int hit_chest(v3 o, v3 d, surface *s)
{
    v3 wood = vec(0.23f, 0.125f, 0.06f);
    if (d.x >= 0.0f)
        return 0;
    v3 p = add(o, times(d, (chest_hi.x - o.x) / d.x));
    if (p.y < chest_hi.y && within(p.z, chest_lo.z, chest_hi.z)) {
        float f = (p.z - chest_lo.z) / 0.5f, y = p.y;
        f = f - (float)floor_int(f);
        int gap = !within(f, 0.03f, 0.97f) || within(y, 0.43f, 0.455f) || y < 0.06f;
        int knob = within(f, 0.44f, 0.56f) && (within(y, 0.62f, 0.65f) || within(y, 0.24f, 0.27f));
        return on_chest(p, vec(1.0f, 0.0f, 0.0f), knob ? vec(0.8f, 0.62f, 0.3f) : times(wood, gap ? 0.3f : 1.0f), s);
    }
    float end = d.z > 0.0f ? chest_lo.z : chest_hi.z;
    p = add(o, times(d, (end - o.z) / d.z));
    if (p.x < chest_hi.x && p.y < chest_hi.y && (end - o.z) * d.z > 0.0f)
        return on_chest(p, vec(0.0f, 0.0f, d.z > 0.0f ? -1.0f : 1.0f), wood, s);
    if (d.y >= 0.0f)
        return 0;
    p = add(o, times(d, (chest_hi.y - o.y) / d.y));
    if (p.x < chest_hi.x && within(p.z, chest_lo.z, chest_hi.z))
        return on_chest(p, vec(0.0f, 1.0f, 0.0f), times(wood, 0.9f + 0.4f * noise(p.z * 8.0f, p.x * 70.0f)), s);
    return 0;
}

static float to_wall(float from, float along, float low, float high)
{
    return along > 0.0f ? (high - from) / along : along < 0.0f ? (low - from) / along : 1e30f;
}

/* The wall, floor or ceiling that the ray ends on; returns 1 if that is the wall of the window. */
static int hit_walls(v3 o, v3 d, surface *s)
{
    float tx = to_wall(o.x, d.x, -HALF, HALF), ty = to_wall(o.y, d.y, 0.0f, HEIGHT),
          tz = to_wall(o.z, d.z, 0.0f, DEPTH);
    float t = tx < ty ? tx : ty;
    t = t < tz ? t : tz;
    v3 p = add(o, times(d, t));
    s->point = p;
    float ax = corner(HALF - (p.x > 0.0f ? p.x : -p.x)), ay = corner(p.y) * corner(HEIGHT - p.y);
    float az = corner(p.z) * corner(DEPTH - p.z);
    if (t == tz) {
        s->normal = vec(0.0f, 0.0f, d.z > 0.0f ? -1.0f : 1.0f);
        s->shade = ax * ay;
        s->albedo = d.z > 0.0f ? front_albedo(p, &s->emitted) : back_albedo(p);
        return d.z > 0.0f;
    }
    if (t == tx) {
        s->normal = vec(d.x > 0.0f ? -1.0f : 1.0f, 0.0f, 0.0f);
        s->shade = ay * az;
        s->albedo = side_albedo(p);
        return 0;
    }
    s->normal = vec(0.0f, d.y > 0.0f ? -1.0f : 1.0f, 0.0f);
    s->shade = ax * az;
    s->albedo = d.y > 0.0f ? times(vec(0.74f, 0.72f, 0.68f), 0.95f + 0.1f * noise(p.x * 12.0f, p.z * 12.0f))
                           : floor_albedo(p, t * sqrtf(dot(d, d)));
    return 0;
}

/* Beyond the opening: the sides of the recess, bright with the sky; the bars, dark against it; the view. */
static v3 through_window(v3 o, v3 d, const surface *wall, const pupil_walk_view *view)
{
    v3 p = add(o, times(d, (DEPTH + RECESS - o.z) / d.z));
    float x = p.x > 0.0f ? p.x : -p.x;
    if (x > WIN_X || p.y > WIN_HI || p.y < WIN_LO) {
        float side = (WIN_X - (wall->point.x > 0.0f ? wall->point.x : -wall->point.x)) / (x - WIN_X);
        float level =
            p.y > WIN_HI ? (WIN_HI - wall->point.y) / (p.y - WIN_HI) : (wall->point.y - WIN_LO) / (WIN_LO - p.y);
        int sill = p.y<WIN_LO, upright = x> WIN_X && (within(p.y, WIN_LO, WIN_HI) || side < level);
        return times(vec(0.95f, 0.95f, 0.92f), upright ? 7.0f : sill ? 16.0f : 3.5f);
    }
    int bar = x < BAR || within(p.y, BAR_Y - BAR, BAR_Y + BAR);
    int border = x > WIN_X - BORDER || p.y > WIN_HI - BORDER || p.y < WIN_LO + BORDER;
    if (!bar && !border)
        return pupil_walk_outside(d);
    surface frame = *wall;
    frame.point = p;
    frame.albedo = vec(0.62f, 0.60f, 0.56f);
    frame.emitted = border ? vec(1.6f, 1.6f, 1.6f) : vec(0.9f, 0.9f, 0.9f); /* the sky round its edges */
    frame.shade = 1.0f;
    return lit(view, &frame);
}

v3 pupil_walk_room(const pupil_walk_view *view, v3 direction)
{
    surface s = {.shade = 1.0f};
    if (hit_lamp(view->eye, direction, &s) || hit_chest(view->eye, direction, &s))
        return lit(view, &s);
    if (hit_walls(view->eye, direction, &s) && s.point.x > -WIN_X && s.point.x < WIN_X && s.point.y > WIN_LO &&
        s.point.y < WIN_HI)
        return through_window(view->eye, direction, &s, view);
    return lit(view, &s);
}
