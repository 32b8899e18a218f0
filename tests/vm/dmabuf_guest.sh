#!/bin/sh
# dmabuf_guest.sh PROGRAM: in the guest. A camera with one input, HDMI (3), that scales to any size (4), a monitor on
# HDMI (1), both with the multi-planar interface (2), and no other nodes (the kernel's
# Documentation/admin-guide/media/vivid.rst).
set -e
modprobe -d "$MODULES" vgem
modprobe -d "$MODULES" vivid n_devs=1 multiplanar=2 node_types=0x101 num_inputs=1 input_types=3 ccs_cap_mode=4 \
    num_outputs=1 output_types=1
exec "$@"
