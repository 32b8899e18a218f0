#!/bin/sh
# dmabuf_guest.sh PROGRAM: in the guest. A camera with two inputs, 0 a webcam (0) and 1 HDMI (3), a monitor on HDMI (1),
# both with the multi-planar interface (2), and no other nodes (the kernel's Documentation/admin-guide/media/vivid.rst).
set -e
modprobe -d "$MODULES" vgem
modprobe -d "$MODULES" vivid n_devs=1 multiplanar=2 node_types=0x101 num_inputs=2 input_types=0xc num_outputs=1 \
    output_types=1
exec "$1"
