// Integers of 64 bits as (low word, high word), signed ones in two's complement; ES 3.0 has no carries.

uvec2 add(uvec2 a, uvec2 b)
{
    uint low = a.x + b.x;
    return uvec2(low, a.y + b.y + uint(low < a.x));
}

uvec2 subtract(uvec2 a, uvec2 b)
{
    return uvec2(a.x - b.x, a.y - b.y - uint(a.x < b.x));
}

bool is_less(uvec2 a, uvec2 b)
{
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

bool is_less_signed(uvec2 a, uvec2 b)
{
    return is_less(uvec2(a.x, a.y ^ 0x80000000u), uvec2(b.x, b.y ^ 0x80000000u));
}

// bits: 0..31
uvec2 shift_right(uvec2 a, uint bits)
{
    return bits == 0u ? a : uvec2(a.x >> bits | a.y << (32u - bits), a.y >> bits);
}

uvec2 multiply(uint a, uint b)
{
    uint a_low = a & 0xffffu, a_high = a >> 16, b_low = b & 0xffffu, b_high = b >> 16;
    uint low = a_low * b_low, middle = a_high * b_low + (low >> 16), other = a_low * b_high + (middle & 0xffffu);
    return uvec2(other << 16 | (low & 0xffffu), a_high * b_high + (middle >> 16) + (other >> 16));
}
