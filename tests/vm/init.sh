#!/bin/busybox sh
# init.sh: the guest's process 1. Its arguments are a command, which is run on the host's files (read-only; /dev, /proc,
# /sys and /run are the guest's own) with MODULES, for modprobe -d. The last line is its exit status. Then the guest
# ends: a reset also ends qemu. After "systemd" they are arguments of systemd, which becomes process 1 on the host's
# files with an overlay in memory.
/bin/busybox mkdir -p /proc /sys /dev /host
/bin/busybox --install -s /bin
export PATH=/bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs dev /dev 2>/dev/null
exec <>/dev/console >&0 2>&1

modprobe virtio_pci && modprobe 9pnet_virtio && modprobe 9p &&
    mount -t 9p -o trans=virtio,version=9p2000.L,ro,cache=loose,msize=512000 host /host || reboot -f
if [ "$1" = systemd ]; then
    shift
    modprobe overlay && modprobe vhci-hcd && modprobe uvcvideo || reboot -f
    mkdir -p /above /root
    mount -t tmpfs above /above
    mkdir /above/upper /above/work
    mount -t overlay overlay -o lowerdir=/host,upperdir=/above/upper,workdir=/above/work /root || reboot -f
    exec switch_root /root /lib/systemd/systemd "$@"
fi
mount -t tmpfs run /host/run
for folder in proc sys dev; do
    mount --rbind /$folder /host/$folder
done
mkdir -p /host/run/modules/lib
cp -R /lib/modules /host/run/modules/lib
cd /
env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/run XDG_STATE_HOME=/dev/null TMPDIR=/run MODULES=/run/modules chroot /host "$@" </dev/null
echo "guest: status $?"
reboot -f
