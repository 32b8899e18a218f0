"""The worst frames of docs/pictures.md, each as 8-bit sRGB, as a 12-bit mosaic and as floats.

    worst.py PUPIL MODULE OUT    PUPIL is the program, MODULE the folder with pupil_ae (build/python), OUT gets a sheet

A row for each frame, a column for each format. Codes are of all channels; white means 255 in each.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np

import measure

HEIGHT, WIDTH = 360, 480
BLACK, MOST = 256, 4095  # of the mosaic
NOISE = {"8 bit": 0.8, "12 bit": 4.0}  # standard deviation, codes
FLOAT_NOISE = 1e-3


def codes_of(light):
    light = np.clip(light, 0.0, 1.0)
    return 255.0 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def mosaic_of(light):
    cells = np.empty(light.shape[:2])
    for y, x, channel in ((0, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 2)):
        cells[y::2, x::2] = light[y::2, x::2, channel]
    return BLACK + cells * (MOST - BLACK)


def scenes(program, work):
    """Name, light, and whether a sensor's noise is still to be added."""
    random = np.random.default_rng(3)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    far = np.hypot(x - 300, y - 150)
    grey, warm = np.ones(3), np.array([1.0, 0.6, 0.25])

    def lamp(glow):
        return np.where(far < 6, 1.0, glow)[..., None] * warm

    hot = np.where(random.random(far.shape) < 1e-3, random.uniform(0.02, 1.0, far.shape), 0.0)
    yield "lens cap", 0.0 * hot[..., None] * grey, True
    yield "hot pixels", hot[..., None] * grey, True
    yield "all white", np.ones(far.shape)[..., None] * grey, False
    yield "a lamp alone", lamp(0.0), False
    yield "a lamp, its glow falls as 1 / r^2", lamp(0.05 * (6 / np.maximum(far, 6)) ** 2), False
    yield "a lamp, its glow falls as exp(-r)", lamp(0.05 * np.exp(-far / 25)), False
    subprocess.run([program, "render", "stars", "-n", "0..0", "-o", work / "stars.pfm", "-q"], check=True)
    yield "starry sky, synth:stars", measure.read_pfm(work / "stars.pfm"), False


def replayed(program, light, work):
    measure.write_pfm(work / "light.pfm", light)
    subprocess.run([program, "replay", work / "light.pfm", "-n", "1", "-o", work / "shown.png", "--stats",
                    work / "stats.jsonl", "-q", "--overwrite"], check=True)
    stats = json.loads((work / "stats.jsonl").read_text().splitlines()[0])
    return cv2.imread(str(work / "shown.png"))[:, :, ::-1], stats["scale"], stats["reason"]


def processed(pupil_ae, frame, **how):
    pupil = pupil_ae.Pupil()
    shown = pupil.process(frame, **how)
    return shown, pupil.exposure.scale, pupil_ae.Reason(pupil.exposure.reason).name.lower()


def pictures_of(program, pupil_ae, light, noisy, work):
    random = np.random.default_rng(5)
    codes = codes_of(light) + (abs(random.normal(0, NOISE["8 bit"], light.shape)) if noisy else 0.0)
    yield "8 bit", processed(pupil_ae, np.clip(np.round(codes), 0, 255).astype(np.uint8))
    codes = mosaic_of(light) + (random.normal(0, NOISE["12 bit"], light.shape[:2]) if noisy else 0.0)
    codes = np.clip(np.round(codes), 0, MOST).astype(np.uint16)
    yield "12 bit", processed(pupil_ae, codes, pixel="BAYER12", coding={"black": BLACK, "white": MOST})
    yield "float", replayed(program, light + (random.normal(0, FLOAT_NOISE, light.shape) if noisy else 0.0), work)


def main():
    program, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[3])
    sys.path.insert(0, sys.argv[2])
    import pupil_ae
    rows = []
    print("| frame | format | scale | reason | display codes of half, of 99 % | white, % |\n|---|---|--:|---|---|--:|")
    with tempfile.TemporaryDirectory() as folder:
        for name, light, noisy in scenes(program, pathlib.Path(folder)):
            row = []
            for word, (shown, scale, reason) in pictures_of(program, pupil_ae, light, noisy, pathlib.Path(folder)):
                half, most = np.percentile(shown, [50, 99])
                white = 100 * (shown.min(-1) == 255).mean()
                print(f"| {name} | {word} | {scale:.4g} | {reason} | {half:.0f}, {most:.0f} | {white:.2f} |")
                row.append(cv2.resize(np.ascontiguousarray(shown[:, :, ::-1]), (WIDTH // 2, HEIGHT // 2),
                                      interpolation=cv2.INTER_AREA))
            rows.append(np.hstack(row))
    cv2.imwrite(str(out), np.vstack(rows))


if __name__ == "__main__":
    main()
