/* drivers/synth/walk_outside.c: what the window shows: sky, clouds, the sun, hills and meadows. */
#include "synth/walk.h"

/* Height of a ridge (tangent above the horizon) in the direction `azimuth`: two octaves of noise. */
static float ridge(float azimuth, float scale, float base, float height, float row)
{
    float x = azimuth * scale + 20.0f;
    return base + height * (0.75f * noise(x, row) + 0.25f * noise(x * 2.7f, row));
}

static v3 clouds(v3 sky, v3 d)
{
    /* A layer of clouds is a plane overhead; low down it is too far away to be told from haze. */
    float reach = 1.0f / (d.y > 0.05f ? d.y : 0.05f);
    float x = d.x * reach * 0.9f + 3.0f, z = reach * 1.3f;
    float n = 0.55f * noise(x, z) + 0.30f * noise(2.1f * x + 5.0f, 2.1f * z) + 0.15f * noise(4.3f * x, 4.3f * z + 9.0f);
    float cover = ramp(0.48f, 0.78f, n) * ramp(0.05f, 0.16f, d.y);
    return mix(sky, vec(400.0f, 385.0f, 370.0f), cover * 0.75f);
}

static v3 sky(v3 d)
{
    /* The angle to the sun by tan^2 = 1 / cos^2 - 1. */
    v3 sun = pupil_walk_sun();
    float along = dot(d, sun), sun_tan2 = along > 0.0f ? dot(d, d) * dot(sun, sun) / (along * along) - 1.0f : 1e6f;

    /* Blue above, whitish at the horizon, brighter around the sun. */
    v3 light = mix(vec(330.0f, 300.0f, 260.0f), vec(75.0f, 125.0f, 215.0f), ramp(-0.05f, 0.55f, d.y));
    light = clouds(light, d);
    float glow = 1.0f / (1.0f + 40.0f * sun_tan2), near = 1.0f / (1.0f + 900.0f * sun_tan2);
    light = add(light, times(vec(1.0f, 0.85f, 0.6f), 260.0f * glow * glow + 1500.0f * near * near));
    float disc = 1.0f - ramp(0.00040f, 0.00048f, sun_tan2); /* 1.2 degrees: over twice the sun, to last at 320 px */
    return mix(light, vec(PUPIL_WALK_SUN, PUPIL_WALK_SUN, 0.9f * PUPIL_WALK_SUN), disc);
}

static v3 meadow(v3 d)
{
    float distance = 1.0f / (d.y < -0.01f ? -d.y : 0.01f);
    float x = d.x * distance, fields = noise(x * 0.9f + 7.0f, distance * 0.45f);
    float grass = noise(x * 9.0f, distance * 7.0f);
    v3 near = mix(vec(16.0f, 26.0f, 7.0f), vec(44.0f, 48.0f, 14.0f), ramp(0.35f, 0.65f, fields));
    near = times(near, 0.8f + 0.4f * grass);
    return mix(near, vec(105.0f, 115.0f, 105.0f), ramp(4.0f, 60.0f, distance));
}

v3 pupil_walk_outside(v3 direction)
{
    float z = direction.z > 0.05f ? direction.z : 0.05f; /* the window faces forward */
    v3 d = vec(direction.x / z, direction.y / z, 1.0f);

    if (d.y < 0.07f) { /* no ridge is higher than its base and height together */
        float near = ridge(d.x, 3.1f, -0.05f, 0.12f, 5.0f);
        if (d.y < near) {
            if (d.y < -0.045f)
                return meadow(d);
            float wood = noise(d.x * 45.0f, d.y * 90.0f) * ramp(near - 0.06f, near, d.y);
            return mix(vec(24.0f, 38.0f, 24.0f), vec(60.0f, 76.0f, 40.0f), wood);
        }
    }
    if (d.y < 0.19f) {
        float far = ridge(d.x, 2.2f, 0.02f, 0.17f, 1.0f);
        if (d.y < far)
            return mix(vec(125.0f, 140.0f, 160.0f), vec(75.0f, 95.0f, 125.0f), ramp(-0.02f, far, d.y));
    }
    return sky(d);
}
