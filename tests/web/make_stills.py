"""make_stills.py FOLDER: pictures of one scene in the formats that the page reads; ffmpeg writes EXR and PNG."""
import math
import pathlib
import struct
import subprocess
import sys

WIDTH, HEIGHT = 61, 37


def light(x, y):
    ev = 7 * math.sin(x / 9) * math.cos(y / 7) - 2
    return [2.0 ** ev * (0.4 + 0.6 * ((x * k + y) % 11) / 10) for k in (1, 2, 3)]


def pfm(path, pixels):
    rows = [b"".join(struct.pack("<3f", *p) for p in row) for row in reversed(pixels)]
    path.write_bytes(b"PF\n%d %d\n-1.0\n" % (WIDTH, HEIGHT) + b"".join(rows))


def rgbe(pixel):
    most = max(pixel)
    exponent = math.frexp(most)[1]
    return bytes(int(v * 2.0 ** (8 - exponent)) for v in pixel) + bytes([exponent + 128])


def radiance(path, pixels):
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=0.5\nEXPOSURE=0\n\n-Y %d +X %d\n" % (HEIGHT, WIDTH)
    path.write_bytes(head + b"".join(rgbe(p) for row in pixels for p in row))


def with_axes_of_xyz(path, to):
    """A scanline OpenEXR file with chromaticities: as the first attribute, and each chunk is so much further on."""
    old = path.read_bytes()
    new = b"chromaticities\0chromaticities\0" + struct.pack("<i8f", 32, 1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3)
    at = 8
    while old[at]:  # name, type, size, value
        at = old.index(b"\0", old.index(b"\0", at) + 1) + 1
        at += 4 + struct.unpack_from("<i", old, at)[0]
    first = struct.unpack_from("<Q", old, at + 1)[0]
    table = struct.unpack_from(f"<{(first - at - 1) // 8}Q", old, at + 1)
    table = struct.pack(f"<{len(table)}Q", *(t + len(new) for t in table))
    to.write_bytes(old[:8] + new + old[8:at + 1] + table + old[first:])


def main():
    folder = pathlib.Path(sys.argv[1])
    pixels = [[light(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]
    pfm(folder / "still.pfm", pixels)
    radiance(folder / "still.hdr", pixels)
    convert = ["ffmpeg", "-loglevel", "error", "-y", "-i", str(folder / "still.pfm")]
    for name, options in (("rle", ["-compression", "rle"]), ("zip1", ["-compression", "zip1"]),
                          ("zip16", ["-compression", "zip16"]), ("half", ["-compression", "zip16", "-format", "half"]),
                          ("none", ["-compression", "none"])):
        subprocess.run([*convert, *options, str(folder / f"{name}.exr")], check=True)
    exr = (folder / "zip1.exr").read_bytes()
    at = exr.index(b"displayWindow\0box2i\0") + 24
    around = struct.pack("<4i", -10, -20, 99, 30)  # the picture ends below it
    (folder / "window.exr").write_bytes(exr[:at] + around + exr[at + 16:])
    with_axes_of_xyz(folder / "zip1.exr", folder / "xyz.exr")
    for name, kind in (("rgb48", "rgb48be"), ("rgba64", "rgba64be"), ("grey16", "gray16be"), ("rgb24", "rgb24")):
        subprocess.run([*convert, "-pix_fmt", kind, str(folder / f"{name}.png")], check=True)


main()
