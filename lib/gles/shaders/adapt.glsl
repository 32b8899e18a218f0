// The default law (lib/core/adapt.c) in integers: a level is a signed number of 2^-56 stops, 64 bits. A step is rounded
// away from the old value, so that the state ends on its target and never stalls, as a float would.

uniform uint sum_shift;      // by how much sums are shortened, so that those of the largest frames fit 64 bits
uniform uvec2 minus_divisor; // from the frame's values to scene luminance
uniform uvec4 level_limits;  // the lowest target, the highest
uniform uvec2 step_weight;   // toward more light, toward less: 1 - exp(-dt / tau) in 2^-32; all bits: at once
uniform uvec4 given;         // the state to begin with, where w is 1
uniform bool is_locked;
uniform bool is_black_left_out; // frames of floats
uniform uint black_log2;        // of the floor, with the offset, in 2^-24 stops
uniform uint least_light;       // if light has less weight than this, black makes up for it

#define OFFSET_STOPS 32 // makes every exponent positive

// A column's sums of weights times log2 (in 2^-24 stops, shifted) and of weights.
void weigh_region(ivec2 region, uvec4 sums, inout uvec2 log2_sum, inout uvec2 weight_sum)
{
    uint weight = weight_of(region);
    ivec4 row = region_row[region.y];
    int pixels = (first_column(region.x + 1) - first_column(region.x)) * (row.y - row.x);
    uint exponent = uint(int(sums.x) + OFFSET_STOPS * pixels);
    if (weight == 0u)
        return;
    uvec2 sum = add(uvec2(exponent << 24, exponent >> 8), uvec2(sums.y, 0u));
    if (is_black_left_out) {
        uint black = sums.z & 0xfffffu;
        sum = subtract(sum, multiply(black, black_log2));
        pixels -= int(black);
    }
    uvec2 weighed = add(multiply(sum.x, weight), uvec2(0u, sum.y * weight));
    log2_sum = add(log2_sum, shift_right(weighed, sum_shift));
    weight_sum = add(weight_sum, multiply(uint(pixels), weight));
}

// The mean in 2^-56 stops, to 2^-32: a division bit by bit.
uvec2 mean_of(uvec2 log2_sum, uvec2 weight_sum)
{
    uvec2 rest = uvec2(0u), quotient = uvec2(0u);
    for (uint bit = 0u; bit < 72u + sum_shift; bit++) {
        rest = uvec2(rest.x << 1 | log2_sum.y >> 31, rest.y << 1 | rest.x >> 31);
        log2_sum = uvec2(log2_sum.x << 1, log2_sum.y << 1 | log2_sum.x >> 31);
        quotient = uvec2(quotient.x << 1, quotient.y << 1 | quotient.x >> 31);
        if (!is_less(rest, weight_sum)) {
            rest = subtract(rest, weight_sum);
            quotient.x |= 1u;
        }
    }
    uvec2 level = uvec2(quotient.x << 24, quotient.y << 24 | quotient.x >> 8);
    return subtract(level, uvec2(0u, uint(OFFSET_STOPS) << 24));
}

// A step of w of the way from s to t.
uvec2 approach(uvec2 s, uvec2 t)
{
    bool up = is_less_signed(s, t);
    uint w = up ? step_weight.x : step_weight.y;
    if (w == 0xffffffffu)
        return t;
    uvec2 distance = up ? subtract(t, s) : subtract(s, t);
    uvec2 low = multiply(distance.x, w);
    uvec2 step_size = add(multiply(distance.y, w), uvec2(low.y, 0u));
    if (low.x > 0u)
        step_size = add(step_size, uvec2(1u, 0u));
    if (is_less(distance, step_size))
        step_size = distance;
    return up ? add(s, step_size) : subtract(s, step_size);
}

// A state is (level, whether a frame has set it, 0).
uvec4 adapt(uvec4 state, uvec2 log2_sum, uvec2 weight_sum)
{
    if (given.w == 1u)
        state = uvec4(given.xyz, 0u);
    if (is_black_left_out && is_less(weight_sum, uvec2(least_light, 0u))) {
        log2_sum = add(log2_sum, shift_right(multiply(least_light - weight_sum.x, black_log2), sum_shift));
        weight_sum = uvec2(least_light, 0u);
    }
    if (weight_sum == uvec2(0u) || (is_locked && state.z == 1u))
        return state;
    uvec2 target = add(mean_of(log2_sum, weight_sum), minus_divisor);
    if (is_less_signed(target, level_limits.xy))
        target = level_limits.xy;
    if (is_less_signed(level_limits.zw, target))
        target = level_limits.zw;
    return uvec4(state.z == 1u ? approach(state.xy, target) : target, 1u, 0u);
}
