#!/bin/sh
# gstreamer_h264.sh [DEVICE [OUT.mkv [FRAMES]]]: a camera, well exposed, as H.264 in a file. Ctrl-C ends it; the file is
# complete. Needs the plugin of pupil (GST_PLUGIN_PATH), and on Debian gstreamer1.0-tools, -plugins-good and -plugins-ugly.
device=${1:-/dev/video0}
out=${2:-camera.mkv}
frames=${3:--1} # -1: until Ctrl-C

# pupilsrc controls exposure time and gain, balances white and maps. It uses the size and rate that the camera is set
# to; to choose others, put caps behind it: video/x-raw,width=1280,height=720,framerate=30/1
#
# With the queue, the next frame is exposed and mapped while one is encoded. If the encoder is too slow, the queue drops
# frames, which does not affect the exposure.
#
# -m prints the messages of pupilsrc: state, exposure-time, gain. -e completes the file when interrupted.
exec gst-launch-1.0 -m -e \
    pupilsrc device="$device" num-buffers="$frames" ! \
    queue leaky=downstream max-size-buffers=8 ! \
    x264enc tune=zerolatency speed-preset=ultrafast bitrate=4000 key-int-max=60 ! \
    matroskamux ! \
    filesink location="$out"
