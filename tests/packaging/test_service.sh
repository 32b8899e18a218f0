#!/bin/sh
# packaging.service: test_service.sh CAMERA NODE: pupil@video0 under systemd in a virtual machine, with a USB camera:
# the packages are installed in a clean Debian, which is booted. It converges, is killed, restarts, and has kept its
# state.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/roots.sh"
[ "$(uname -m)" = x86_64 ] || { echo "skipped: there is a guest for amd64 alone"; exit 76; }
camera=$1 node=$2
guest=$tree/build/vm/amd64
sh "$tree/tests/vm/make_guest.sh" amd64 "$guest"
build_packages amd64
clean_root

# The root of the guest: a clean root with the packages installed by apt, made once for them.
root=$tree/build/deb/guest
if [ "$(cat "$root.tree" 2>/dev/null)" != "$(cat "$tree/build/deb/amd64.tree")" ]; then
    rm -rf "$root" "$root.tree"
    cp -a "$clean" "$root"
    cp "$tree"/build/deb/amd64/pupil_*.deb "$root/"
    unshare --mount --pid --fork sh -euc '
        mount -t proc proc "$1/proc"
        exec chroot "$1" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive sh -euc "
            apt-get -qq update
            apt-get -qq install -y --no-install-recommends /pupil_*.deb"
    ' _ "$root" >"$work/install.log" 2>&1 || { tail -n 20 "$work/install.log"; exit 1; }
    cp "$tree/build/deb/amd64.tree" "$root.tree"
fi
mkdir -p "$root/test"
cp "$camera" "$node" "$here/service_guest.sh" "$tree/tests/vm/uvc_plug.sh" "$root/test/"
cat >"$root/etc/systemd/system/pupil-test.service" <<'END'
[Unit]
Description=the test
DefaultDependencies=no
After=basic.target
[Service]
Type=oneshot
ExecStart=/test/service_guest.sh
ExecStopPost=/bin/systemctl --force --force reboot
StandardOutput=tty
StandardError=tty
TTYPath=/dev/ttyS0
END
cat >"$root/etc/systemd/system/pupil-test.target" <<'END'
[Unit]
Description=what the test needs
Requires=basic.target
Wants=pupil-test.service
After=basic.target
END
GUEST_ROOT=$root sh "$tree/tests/vm/boot.sh" amd64 "$guest" 900 systemd --unit=pupil-test.target --show-status=no
