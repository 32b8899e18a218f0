#!/usr/bin/env python3
"""Writes lib/kernels/tables.c: the 8-bit transfer tables, from 60-digit decimal arithmetic. With "hdr" it writes
tables_hdr.c: those of PQ and HLG.

Run it after a change (python3 lib/kernels/make_tables.py > lib/kernels/tables.c, the other likewise); the
build never does.
"""
import struct
import sys
from decimal import Decimal, getcontext

getcontext().prec = 60
D = Decimal


def srgb_to_linear(c):  # IEC 61966-2-1
    return c / D("12.92") if c <= D("0.04045") else ((c + D("0.055")) / D("1.055")) ** D("2.4")


def bt709_to_linear(c):  # the inverse of the camera's curve of Rec. ITU-R BT.709-6, item 1.2
    return c / D("4.5") if c < D("0.081") else ((c + D("0.099")) / D("1.099")) ** (1 / D("0.45"))


def gamma22_to_linear(c):
    return c ** D("2.2") if c else D(0)


def linear_to_linear(c):
    return c


def pq_to_linear(c):  # SMPTE ST 2084, as in Rec. ITU-R BT.2100-2, table 4; 1.0 is 100 cd/m2
    m1, m2 = D(2610) / 16384, D(2523) / 4096 * 128
    c1, c2, c3 = D(3424) / 4096, D(2413) / 4096 * 32, D(2392) / 4096 * 32
    p = c ** (1 / m2) if c else D(0)
    return 100 * (max(p - c1, D(0)) / (c2 - c3 * p)) ** (1 / m1) if p > c1 else D(0)


def hlg_to_linear(c):  # the inverse OETF of Rec. ITU-R BT.2100-2, table 5
    a = D("0.17883277")
    b, shift = 1 - 4 * a, D("0.5") - a * (4 * a).ln()
    return min(c * c / 3 if c <= D("0.5") else (((c - shift) / a).exp() + b) / 12, D(1)) if c < 1 else D(1)


def bits_of(f):
    return struct.unpack("<I", struct.pack("<f", f))[0]


def float_of(bits):
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def nearest_float(x):
    best = bits_of(float(x))  # within one of the nearest, after double rounding
    return min((float_of(b) for b in range(max(best - 1, 0), best + 2)), key=lambda f: abs(D(f) - x))


def float_at_or_above(x):
    b = max(bits_of(float(x)) - 2, 0)
    while D(float_of(b)) < x:
        b += 1
    return float_of(b)


def literal(f):
    return float.hex(f).replace("0x1.", "0x1.").rstrip() + "f"


def rows(items, per_line):
    return ",\n".join("    " + ", ".join(items[i : i + per_line]) for i in range(0, len(items), per_line))


def encoder(name, to_linear):
    bound = [D(0)] + [to_linear((D(k) - D("0.5")) / 255) for k in range(1, 256)]
    bound = [0.0] + [float_at_or_above(b) for b in bound[1:]] + [2.0]
    base = bits_of(bound[1]) & 0x7F800000  # the power of two below the first boundary
    cells = []
    for start in range(base, bits_of(1.0) + 1, 1 << 16):
        code = sum(1 for b in bound[1:256] if b <= float_of(start))
        inside = [b for b in bound[1:256] if start < bits_of(b) < start + (1 << 16)]
        assert len(inside) <= 1, (name, start)
        cells.append((code << 16) + (65536 - (bits_of(inside[0]) - start) if inside else 0))
    assert cells[0] >> 16 == 0 and cells[-1] >> 16 == 255
    print(f"static const uint32_t {name}_cell[{len(cells)}] = {{\n{rows([f'0x{c:06x}' for c in cells], 12)}}};\n")
    return base


# Gauss-Legendre, 5 points on 0..1: (place, weight)
def gauss_points():
    root = (D(10) / 7).sqrt()
    places = [(D(0), D(128) / 225)]
    for sign, weight in ((-1, (322 + 13 * D(70).sqrt()) / 900), (1, (322 - 13 * D(70).sqrt()) / 900)):
        place = (5 + 2 * sign * root).sqrt() / 3
        places += [(place, weight), (-place, weight)]
    return [((1 + place) / 2, weight / 2) for place, weight in places]


# The step from code k to the next with which the interpolated light has a mean relative error of 0 in between, so that
# a log-average over many codes has no error. (A chord is always above a convex curve.) From 2^-14 on it ends at most
# 3.2e-4 below the next code's light: HLG has half of PQ's points, and coding.h promises 3.3e-4.
def unbiased_step(curve, top, k):
    first, last = curve(D(k) / top), curve(D(k + 1) / top)
    if not first:
        return last
    parts = [(t, weight / curve((k + t) / top)) for t, weight in gauss_points()]
    step = (1 - first * sum(w for _, w in parts)) / sum(t * w for t, w in parts)
    return max(step, last * (1 - D("3.2e-4")) - first) if last > D(2) ** -14 else step


def light_pairs(curve, top, in_text, unbiased):
    light = [nearest_float(curve(D(k) / top)) for k in range(top + 1)]
    if unbiased:
        step = [nearest_float(unbiased_step(curve, top, k)) for k in range(top)] + [0.0]
    else:
        step = [nearest_float(D(b) - D(a)) for a, b in zip(light, light[1:])] + [0.0]
    return [f"{{{in_text(a)}, {in_text(b)}}}" for a, b in zip(light, step)]


def light_table(name, curve, top, in_text):
    pairs = light_pairs(curve, top, in_text, True)
    print(f"const float pupil_{name}_light[{top + 1}][2] = {{\n{rows(pairs, 3)}}};\n")


# Codes 0 to 255; if PUPIL_BEYOND is not 0, the light of these two is repeated for that many codes at both ends.
def codes_table(name, curve):
    beyond = 304
    pairs = light_pairs(curve, 255, literal, False)
    print(f"const float pupil_{name}_codes[256 + 2 * PUPIL_BEYOND][2] = {{")
    print(f"#if PUPIL_BEYOND\n{rows(['{0, 0}'] * beyond, 16)},\n#endif\n{rows(pairs, 3)},")
    print(f"#if PUPIL_BEYOND\n{rows(['{1, 0}'] * beyond, 16)},\n#endif\n}};\n")


def decimal_literal(f):  # nine digits are enough to name a float
    return f"{f:.8e}f"


if sys.argv[1:] == ["hdr"]:
    print("/* Made by lib/kernels/make_tables.py hdr; do not edit. Transfer curves: coding.h names their sources. */")
    print('#include "kernels.h"\n')
    print("/* clang-format off */")
    light_table("pq", pq_to_linear, 4092, decimal_literal)
    light_table("hlg", hlg_to_linear, 2046, decimal_literal)
    sys.exit()

print("/* Made by lib/kernels/make_tables.py; do not edit. Transfer curves: config.h names their sources. */")
print('#include "kernels.h"\n')
print("/* clang-format off */")
decode = [literal(nearest_float(srgb_to_linear(D(k) / 255))) for k in range(256)]
print(f"const float pupil_srgb8_to_linear[256] = {{\n{rows(decode, 6)}}};\n")
for name, curve in (("srgb", srgb_to_linear), ("bt709", bt709_to_linear)):
    codes_table(name, curve)
bases = [
    (n, encoder(n, f))
    for n, f in (("srgb", srgb_to_linear), ("gamma22", gamma22_to_linear), ("linear", linear_to_linear))
]
print("const pupil_encoder pupil_encoders[PUPIL_TRANSFER_COUNT] = {")
for n, base in bases:
    print(f"    [PUPIL_TRANSFER_{n.upper()}] = {{{n}_cell, 0x{base:08x}u, PUPIL_TRANSFER_{n.upper()}}},")
print("};")
sys.stdout.flush()
