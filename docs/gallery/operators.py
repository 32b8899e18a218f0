"""The operators of the gallery: linear light to 8-bit sRGB, each with its own defaults.

OpenCV's scale the light themselves; their gamma is set to 2.2, since their default leaves the picture linear. ffmpeg's
and libplacebo's expect exposed light, so they get it with pupil's exposure: 1 is the display's white.
"""
import subprocess

import cv2
import numpy as np


def opencv(make):
    def run(rgb, _):
        light = np.maximum(rgb, 1e-6)[:, :, ::-1].astype(np.float32)  # they turn 0 into NaN
        return codes_of(np.nan_to_num(make().process(np.ascontiguousarray(light)))[:, :, ::-1])
    return run


def codes_of(values):
    return np.floor(np.clip(values, 0, 1) * 255 + 0.5).astype(np.uint8)


def ffmpeg(rgb, pixel, filters, devices=()):
    height, width = rgb.shape[:2]
    command = ["ffmpeg", "-hide_banner", "-loglevel", "error", *devices, "-f", "rawvideo", "-pixel_format", pixel,
               "-video_size", f"{width}x{height}", "-i", "-", "-vf", filters, "-frames:v", "1", "-f", "rawvideo",
               "-pix_fmt", "rgb24", "-"]
    planes = np.stack([rgb[:, :, 1], rgb[:, :, 2], rgb[:, :, 0]])  # gbrp: green, blue, red
    said = subprocess.run(command, input=planes.tobytes(), stdout=subprocess.PIPE, check=True)
    return np.frombuffer(said.stdout, np.uint8).reshape(height, width, 3)


def ffmpeg_tonemap(name):
    def run(rgb, exposure):
        light = np.clip(rgb * exposure, 0, 1e4).astype("<f4")
        return ffmpeg(light, "gbrpf32le", "setparams=range=pc:color_primaries=bt709:color_trc=linear:colorspace=gbr,"
                      f"tonemap={name},zscale=transferin=linear:transfer=iec61966-2-1:dither=none,format=gbrp")
    return run


def pq(light):
    """Light of 1 = 203 cd/m2 (BT.2408) to PQ (ST 2084)."""
    p = np.power(np.clip(light * 203 / 10000, 0, 1), 0.1593017578125)
    return np.power((0.8359375 + 18.8515625 * p) / (1 + 18.6875 * p), 78.84375)


TO_BT2020 = np.array([[0.627404, 0.329283, 0.043313], [0.069097, 0.919540, 0.011362], [0.016391, 0.088013, 0.895595]])


def libplacebo(rgb, exposure):
    height, width = rgb.shape[:2]
    video = pq(np.maximum(rgb * exposure, 0) @ TO_BT2020.T)
    padded = np.pad(video, ((0, height % 2), (0, width % 2), (0, 0)), "edge")
    codes = np.floor(padded * 65535 + 0.5).astype("<u2")
    filters = ("setparams=range=pc:color_primaries=bt2020:color_trc=smpte2084:colorspace=gbr,"
               "zscale=matrix=2020_ncl:range=tv,format=yuv444p16le,hwupload,"
               "libplacebo=colorspace=bt709:color_primaries=bt709:color_trc=iec61966-2-1:range=tv:format=yuv444p16le,"
               "hwdownload,format=yuv444p16le,zscale=matrixin=709:matrix=gbr:range=pc:dither=none,format=gbrp")
    return ffmpeg(codes, "gbrp16le", filters, ("-init_hw_device", "vulkan=vk", "-filter_hw_device",
                                               "vk"))[:height, :width]


OPERATORS = {
    "OpenCV Reinhard": opencv(lambda: cv2.createTonemapReinhard(2.2)),
    "OpenCV Drago": opencv(lambda: cv2.createTonemapDrago(2.2)),
    "OpenCV Mantiuk": opencv(lambda: cv2.createTonemapMantiuk(2.2)),
    "ffmpeg reinhard": ffmpeg_tonemap("reinhard"),
    "ffmpeg mobius": ffmpeg_tonemap("mobius"),
    "ffmpeg hable": ffmpeg_tonemap("hable"),
    "libplacebo": libplacebo,
}
