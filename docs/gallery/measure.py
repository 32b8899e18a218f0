"""What a picture for a display keeps of a scene's light.

    measure.py SCENE.pfm PICTURE.png...    prints a line a picture

Scene: linear light in BT.709 primaries. Picture: 8-bit sRGB of the same size. Hue and chroma are Oklab's (B. Ottosson,
"A perceptual color space for image processing", 2020). The picture's colour is compared with the scene's colour, scaled
to the picture's luminance Y, so exposure and curve play no part.
"""
import sys

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
TO_CONES = np.array([[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566],
                     [0.0883024619, 0.2817188376, 0.6299787005]])
TO_LAB = np.array([[0.2104542553, 0.7936177850, -0.0040720468], [1.9779984951, -2.4285922050, 0.4505937099],
                   [0.0259040371, 0.7827717662, -0.8086757660]])
FROM_CONES, FROM_LAB = np.linalg.inv(TO_CONES), np.linalg.inv(TO_LAB)


def read_pfm(path):
    with open(path, "rb") as file:
        kind, size, scale = file.readline().strip(), file.readline().split(), float(file.readline())
        if kind != b"PF" or scale >= 0:
            sys.exit(f"{path}: not a PFM file of three little-endian floats")
        width, height = int(size[0]), int(size[1])
        return np.fromfile(file, "<f4", width * height * 3).reshape(height, width, 3)[::-1].astype(np.float64)


def write_pfm(path, rgb):
    with open(path, "wb") as file:
        file.write(b"PF\n%d %d\n-1.0\n" % (rgb.shape[1], rgb.shape[0]))
        rgb[::-1].astype("<f4").tofile(file)


def linear_of_codes(codes):
    v = codes / 255.0
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def oklab(rgb):
    return np.cbrt(rgb @ TO_CONES.T) @ TO_LAB.T


def lch(rgb):
    lab = oklab(rgb)
    return lab[..., 0], np.hypot(lab[..., 1], lab[..., 2]), np.degrees(np.arctan2(lab[..., 2], lab[..., 1]))


def largest_chroma(lightness, hue):
    """The chroma at which a lightness and a hue leave the gamut, by bisection to 2^-24."""
    inside, outside = np.zeros_like(lightness), np.full_like(lightness, 0.5)
    cosine, sine = np.cos(np.radians(hue)), np.sin(np.radians(hue))
    for _ in range(24):
        chroma = 0.5 * (inside + outside)
        cones = np.stack([lightness, chroma * cosine, chroma * sine], -1) @ FROM_LAB.T
        rgb = cones**3 @ FROM_CONES.T
        fits = (rgb.min(-1) >= -1e-6) & (rgb.max(-1) <= 1.0 + 1e-6)
        inside, outside = np.where(fits, chroma, inside), np.where(fits, outside, chroma)
    return inside


def quantiles(values):
    return [float(q) for q in np.percentile(values, [10, 50, 90])] if len(values) >= 100 else None


def colour(scene, shown):
    """Where the scene's chroma is over half of the gamut's: how far the hue turned, and the share of chroma kept. For
    pure LED colours: the share of the gamut's largest chroma."""
    light, y = scene @ LUMINANCE, shown @ LUMINANCE
    use = (y > 0.1) & (y < 0.9) & (light > 0) & (scene.min(-1) >= 0)
    scene, shown = scene[use], shown[use]
    lightness, chroma, hue = lch(scene * (y[use] / light[use])[:, None])
    shown_lightness, shown_chroma, shown_hue = lch(shown)
    vivid = chroma > 0.5 * largest_chroma(lightness, hue)
    turned = (shown_hue - hue + 180) % 360 - 180
    warm = vivid & (hue > 30) & (hue < 100)
    result = {"share": float(vivid.sum() / max(1, use.size)), "hue": quantiles(turned[vivid]),
              "hue_size": quantiles(abs(turned[vivid])), "kept": quantiles(shown_chroma[vivid] / chroma[vivid]),
              "warm_hue": quantiles(turned[warm]), "warm_kept": quantiles(shown_chroma[warm] / chroma[warm])}
    for i, name in enumerate(("red", "green", "blue")):
        pure = np.delete(scene, i, -1).max(-1) < 0.1 * scene[:, i]  # one channel nearly alone
        most = largest_chroma(shown_lightness[pure], shown_hue[pure])
        result[name] = quantiles(shown_chroma[pure] / np.maximum(most, 1e-6))
    return result


def measure(scene, codes):
    scene = np.where(np.isfinite(scene), scene, 0.0).reshape(-1, 3)
    codes = codes.reshape(-1, 3)
    shown = linear_of_codes(codes)
    y = shown @ LUMINANCE
    # 2^-12 is about the light of the first code
    return {"log_average": float(np.exp2(np.log2(np.maximum(y, 2.0**-12)).mean())),
            "white": float((codes.min(-1) == 255).mean()), **colour(scene, shown)}


def main():
    import cv2

    scene = read_pfm(sys.argv[1])
    for path in sys.argv[2:]:
        print(path, measure(scene, cv2.imread(path, cv2.IMREAD_COLOR)[:, :, ::-1]))


if __name__ == "__main__":
    main()
