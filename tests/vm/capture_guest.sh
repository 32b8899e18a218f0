#!/bin/sh
# capture_guest.sh PROGRAM...: in the guest. Two cameras, the second with the multi-planar interface (2), each with all
# four inputs: webcam, TV, S-Video, HDMI (0xe4); the first has a monitor on HDMI (1); nothing scales or crops (0).
# The kernel's Documentation/admin-guide/media/vivid.rst.
set -e
# Unquoted on purpose.
${MODPROBE:-modprobe -d $MODULES} vgem
${MODPROBE:-modprobe -d $MODULES} vivid n_devs=2 multiplanar=1,2 node_types=0x101,0x1 num_inputs=4,4 input_types=0xe4,0xe4 \
    ccs_cap_mode=0,0 num_outputs=1 output_types=1 ccs_out_mode=0
exec "$@"
