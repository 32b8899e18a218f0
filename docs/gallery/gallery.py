"""The gallery of docs/pictures.md: see make.sh.

    gallery.py PUPIL BEFORE IMAGES OUT [NAME...]

PUPIL and BEFORE are two builds of the program, IMAGES the folder of the HDR images, OUT gets the contact sheets, the
pictures and the tables. With names: only those scenes.
"""
import json
import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
import cv2  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image, ImageDraw, ImageFont  # noqa: E402

import measure  # noqa: E402
import operators  # noqa: E402

LONGEST = 640  # pixels of a side; larger images are averaged down to it, in linear light
CELL = (300, 210)
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
LOW_KEY = ("table", "candle", "stars", "meadow", "leds", "CandleGlass", "StarField", "desk")


def read_image(path):
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    return image[:, :, 2::-1].astype(np.float64)


def smaller(rgb):
    step = -(-max(rgb.shape[:2]) // LONGEST)
    height, width = rgb.shape[0] // step, rgb.shape[1] // step
    return rgb[:height * step, :width * step].reshape(height, step, width, step, 3).mean((1, 3))


def roof(path):
    with tarfile.open(path) as tar, tempfile.TemporaryDirectory() as folder:
        member = next(m for m in tar.getmembers() if m.name.endswith("frame_0010.hdr"))
        file = pathlib.Path(folder) / "frame.hdr"
        file.write_bytes(tar.extractfile(member).read())
        return read_image(file)


def rose(path):
    """A Bayer frame as RGB, one pixel for each cell of 2 x 2. Levels and gains are those of its manifest."""
    codes = (np.fromfile(path, "<u2").reshape(512, 768) - 600.0) / (15520 - 600)
    return np.stack([codes[0::2, 0::2] * 1.949, (codes[0::2, 1::2] + codes[1::2, 0::2]) / 2,
                     codes[1::2, 1::2] * 1.344], -1)


def scenes_of(pupil, images, work):
    """Every scene's name and light."""
    for name in ("table", "candle", "stars", "meadow", "leds", "walk", "room"):
        path = work / f"synth-{name}.pfm"
        subprocess.run([pupil, "render", name, "-n", "0..0", "-o", path, "-q", "--overwrite"], check=True)
        yield name, measure.read_pfm(path)
    for path in sorted(images.iterdir()):
        name = path.stem.split("_")[0]
        if path.suffix in (".exr", ".hdr"):
            yield name, smaller(read_image(path))
        elif path.suffix == ".tar":
            yield name, roof(path)
        elif path.suffix == ".raw":
            yield name, rose(path)


def by_pupil(program, scene, out):
    stats = out.with_suffix(".jsonl")
    subprocess.run([program, "replay", scene, "-n", "1", "-o", out, "--stats", stats, "-q", "--overwrite"], check=True)
    return cv2.imread(str(out), cv2.IMREAD_COLOR)[:, :, ::-1], json.loads(stats.read_text().splitlines()[0])


def pictures_of(programs, name, light, work):
    path = work / f"{name}.pfm"
    measure.write_pfm(path, light)
    shown, stats = {}, {}
    for word, program in programs.items():
        shown[word], stats[word] = by_pupil(program, path, work / f"{name}-{word}.png")
    for word, run in operators.OPERATORS.items():
        shown[word] = run(light, stats["pupil"]["scale"])
        Image.fromarray(np.ascontiguousarray(shown[word])).save(work / f"{name}-{word.replace(' ', '-')}.png")
    return shown, stats


# --- the contact sheets ---


def cell(codes):
    picture = Image.fromarray(np.ascontiguousarray(codes))
    picture.thumbnail(CELL, Image.LANCZOS)
    whole = Image.new("RGB", CELL, (40, 40, 40))
    whole.paste(picture, ((CELL[0] - picture.width) // 2, (CELL[1] - picture.height) // 2))
    return whole


def sheet(rows, path):
    if not rows:
        return
    words = list(next(iter(rows.values())))
    font = ImageFont.truetype(FONT, 22)
    whole = Image.new("RGB", (len(words) * (CELL[0] + 4), 30 + len(rows) * (CELL[1] + 4)), (90, 90, 90))
    draw = ImageDraw.Draw(whole)
    for x, word in enumerate(words):
        draw.text((x * (CELL[0] + 4) + 4, 2), word, fill=(255, 255, 255), font=font)
    for y, shown in enumerate(rows.values()):
        for x, word in enumerate(words):
            whole.paste(cell(shown[word]), (x * (CELL[0] + 4), 30 + y * (CELL[1] + 4)))
    whole.save(path, quality=82, optimize=True)


# --- the tables ---


def figure(value, places, scale=1.0):
    return "" if value is None else f"{value * scale:.{places}f}"


def row_of(name, word, m, beyond):
    hue, size, kept = m["hue"] or [None] * 3, m["hue_size"] or [None] * 3, m["kept"] or [None] * 3
    warm = m["warm_kept"] or [None] * 3
    return (f"| {name} | {word} | {m['log_average']:.3f} | {100 * m['white']:.2f} | {beyond} | {figure(hue[1], 1)} | "
            f"{figure(size[1], 1)}, {figure(size[2], 1)} | {figure(kept[0], 2)}, {figure(kept[1], 2)}, "
            f"{figure(kept[2], 2)} | {figure(warm[1], 2)} |")


def beyond_white(light, stats):
    """The share of the pixels at or beyond the white point, which the curve itself makes white."""
    return float((np.nan_to_num(light) @ measure.LUMINANCE * stats["scale"] >= stats["white"]).mean())


SHORT = ("before", "pupil", "libplacebo")


def short_row(name, by_word):
    """Before, pupil and libplacebo in one row."""
    def cell_of(write):
        return "; ".join(write(by_word[word]) or "-" for word in SHORT)
    return (f"| `{name}` | " + " | ".join((
        cell_of(lambda m: f"{m['log_average']:.3f}"), cell_of(lambda m: f"{100 * m['white']:.2f}"),
        cell_of(lambda m: m["hue"] and f"{round(m['hue'][1], 1) + 0.0:+.1f}, {m['hue_size'][2]:.1f}"),
        cell_of(lambda m: m["kept"] and f"{m['kept'][0]:.2f}, {m['kept'][1]:.2f}"),
        cell_of(lambda m: m["warm_kept"] and f"{m['warm_kept'][1]:.2f}"))) + " |")


def short_table(measured):
    yield "| before; pupil; libplacebo | log-average | white, % | hue turned: median, size of 90 % | " \
          "chroma kept: 10 %, median | of warm ones: median |"
    yield "|---|---|---|---|---|---|"
    for name, (by_word, _) in measured.items():
        yield short_row(name, by_word)
    yield ""


def tables(measured):
    yield from short_table(measured)
    yield ("| | | log-average | white, % | beyond the white point, % | hue turned | its size: median, 90 % | "
           "chroma kept: 10 %, median, 90 % | of warm ones |")
    yield "|---|---|--:|--:|--:|--:|--:|--:|--:|"
    for name, (by_word, beyond) in measured.items():
        for word, m in by_word.items():
            yield row_of(name, word, m, figure(beyond.get(word), 2, 100))
    yield ""
    yield "| leds: share of the gamut's largest chroma, 10 %, median, 90 % | red | green | blue |"
    yield "|---|--:|--:|--:|"
    for word, m in measured.get("leds", ({}, None))[0].items():
        yield f"| {word} | " + " | ".join(
            ", ".join(f"{v:.2f}" for v in m[c]) if m[c] else "" for c in ("red", "green", "blue")) + " |"


def main():
    programs = {"before": sys.argv[2], "pupil": sys.argv[1]}
    images, out, only = pathlib.Path(sys.argv[3]), pathlib.Path(sys.argv[4]), sys.argv[5:]
    work = out / "work"
    work.mkdir(parents=True, exist_ok=True)
    shown, measured = {}, {}
    for name, light in scenes_of(sys.argv[1], images, work):
        if only and name not in only:
            continue
        shown[name], stats = pictures_of(programs, name, light, work)
        beyond = {word: beyond_white(light, s) for word, s in stats.items()}
        measured[name] = {word: measure.measure(light, codes) for word, codes in shown[name].items()}, beyond
        print(name, flush=True)
    sheet({n: s for n, s in shown.items() if n in LOW_KEY}, out / "gallery-low-key.jpg")
    sheet({n: s for n, s in shown.items() if n not in LOW_KEY}, out / "gallery-ordinary.jpg")
    (out / "tables.md").write_text("\n".join(tables(measured)) + "\n")


if __name__ == "__main__":
    main()
