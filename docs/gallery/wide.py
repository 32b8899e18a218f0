"""Colours of BT.2020 that BT.709 lacks: how hue and chroma change if negative components are set to 0, and if the
colour moves toward grey at constant hue and luminance (docs/pictures.md). Hue and chroma are Oklab's."""
import numpy as np

import measure

TO_BT709 = np.array([[1.660491, -0.587641, -0.072850], [-0.124550, 1.132900, -0.008349],
                     [-0.018151, -0.100579, 1.118730]])  # Rec. ITU-R BT.2087-0
HUES = {"red and orange": (0, 60), "yellow": (60, 120), "green": (120, 180), "cyan": (-180, -120),
        "blue": (-120, -60), "magenta": (-60, 0)}
CONES = measure.TO_CONES / measure.TO_CONES.sum(1, keepdims=True)


def colours():
    random = np.random.default_rng(5)
    rgb = random.random((20000, 3)) ** random.uniform(1, 8, (20000, 1)) @ TO_BT709.T
    rgb = rgb[rgb.min(-1) < -1e-4]
    return rgb / (rgb @ measure.LUMINANCE)[:, None]


def at_luminance_1(rgb):
    rgb = np.maximum(rgb, 0)
    return rgb / (rgb @ measure.LUMINANCE)[:, None]


def constant_hue(rgb):
    """Moved to where the least component is 0: by a step of false position, and one of the Illinois rule."""
    root = np.cbrt(rgb @ CONES.T)

    def moved(part):
        return (root + (root[:, 1:2] - root) * part[:, None]) ** 3 @ np.linalg.inv(CONES).T

    least = rgb.min(-1)
    first = least / (least - 1)
    there = moved(first)
    reached = there.min(-1) / (there @ measure.LUMINANCE)
    half = -least / 2
    part = np.where(reached < 0, (first / 2 - reached) / (0.5 - reached), first * half / (reached + half))
    return at_luminance_1(moved(part))


def main():
    rgb = colours()
    _, chroma, hue = measure.lch(rgb)
    print(f"{len(rgb)} colours; hue turned: median, 90 %, most; chroma kept, median by hue")
    for name, kept in (("set to 0", np.maximum(rgb, 0)), ("constant hue", constant_hue(rgb))):
        _, new_chroma, new_hue = measure.lch(kept)
        turned = abs((new_hue - hue + 180) % 360 - 180)
        by_hue = (f"{word} {np.median((new_chroma / chroma)[(hue >= low) & (hue < high)]):.2f}"
                  for word, (low, high) in HUES.items())
        median, most_of_them = np.percentile(turned, [50, 90])
        print(f"{name}: {median:.1f}, {most_of_them:.1f}, {turned.max():.1f};", ", ".join(by_hue))


if __name__ == "__main__":
    main()
