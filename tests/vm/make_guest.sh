#!/bin/sh
# make_guest.sh ARCHITECTURE FOLDER [PACKAGE]: makes FOLDER/vmlinuz and FOLDER/initrd for boot.sh: the stock kernel that
# PACKAGE (linux-image-ARCHITECTURE) depends on today, with the few modules that the tests load. Exit code 77 and a
# sentence if this machine cannot. An existing one is kept, and once a week Debian is asked for a newer one.
#
# Nothing is installed: the kernel and busybox are downloaded with separate package lists, so that another architecture
# needs no change of the system either, and unpacked in FOLDER. The rest of the guest is this machine's files (boot.sh).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
architecture=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
wanted=${3:-linux-image-$architecture}
# Modules for the host's files; a camera and a monitor; memory for dma-bufs; a USB port for a camera in user space; an
# overlay in memory. Their dependencies are added.
modules="virtio_pci 9p 9pnet_virtio vivid vgem vhci-hcd uvcvideo overlay"

skip() {
    echo "skipped: $1"
    exit 77
}

for tool in apt-get cpio depmod flock modprobe xz; do
    command -v $tool >/dev/null || skip "no $tool: the packages are listed in test.sh"
done
exec 9>"$folder/lock"
flock 9 # tests run in parallel

# The guest exists and was made by these scripts; for how many days it is used unchanged.
is_made() {
    [ -n "$(find "$folder/initrd" -newer "$here/make_guest.sh" -newer "$here/init.sh" ${1:+-mtime "-$1"} 2>/dev/null)" ]
}
is_made 7 && exit 0

new=$folder/new
rm -rf "$new"
mkdir -p "$new/state/lists/partial" "$new/cache/archives/partial" "$new/kernel" "$new/root/bin"
trap 'rm -rf "$new"' EXIT
: >"$new/status"
cat >"$new/apt.conf" <<END
Dir::State "$new/state";
Dir::State::status "$new/status";
Dir::Cache "$new/cache";
APT::Architecture "$architecture";
APT::Architectures { "$architecture"; };
APT::Sandbox::User "";
Acquire::Languages "none";
END
export APT_CONFIG="$new/apt.conf"

# A source that does not answer may be one of several.
apt-get -qq update >"$new/apt.log" 2>&1 || :
apt-cache depends "$wanted" >"$new/depends" 2>>"$new/apt.log" || {
    is_made && exit 0 # as good as it was
    skip "apt-get finds no $wanted: $(head -n 1 "$new/apt.log")"
}
package=$(awk '$1 == "Depends:" { print $2; exit }' "$new/depends")
if is_made && [ "$(cat "$folder/package")" = "$package" ]; then
    touch "$folder/initrd"
    exit 0
fi
(cd "$new" && apt-get -qq download "$package" busybox-static) >"$new/apt.log" 2>&1 ||
    skip "apt-get cannot download $package: $(head -n 1 "$new/apt.log")"
for file in "$new"/*.deb; do
    dpkg-deb -x "$file" "$new/kernel"
done
# From Debian 13 on packages have all of it in usr.
for name in bin lib; do
    [ -e "$new/kernel/$name" ] || ln -s "usr/$name" "$new/kernel/$name"
done
release=$(ls "$new/kernel/lib/modules")
depmod -b "$new/kernel" "$release"

# The guest's initial files: busybox, init, and the modules where modprobe looks for them.
from=$new/kernel/lib/modules/$release
to=$new/root/lib/modules/$release
for module in $modules; do
    modprobe -d "$new/kernel" -S "$release" --show-depends "$module" >>"$new/depends.modules"
done
awk '$1 == "insmod" && !seen[$2]++ { print $2 }' "$new/depends.modules" | while read -r file; do
    name=${file#*"/lib/modules/$release/"}
    mkdir -p "$to/$(dirname "$name")"
    case $file in
    *.xz) xz -dc "$file" >"$to/${name%.xz}" ;;
    *) cp "$file" "$to/$name" ;;
    esac
done
cp "$from"/modules.builtin* "$from/modules.order" "$to"
depmod -b "$new/root" "$release"
cp "$new/kernel/bin/busybox" "$new/root/bin/busybox"
cp "$here/init.sh" "$new/root/init"
chmod 755 "$new/root/init"
(cd "$new/root" && find . | LC_ALL=C sort | cpio -o -H newc --quiet -R 0:0) >"$new/initrd"

# A PC's kernel unpacks itself, which takes the emulator longer than everything else; qemu also boots the unpacked
# payload. Its position: the kernel's Documentation/arch/x86/boot.rst (setup_sects, payload_offset, payload_length,
# whose last four bytes are not part of the packed data).
kernel=$new/kernel/boot/vmlinuz-$release
number_at() {
    od -A n -t "u$2" -j "$1" -N "$2" "$kernel" | tr -d ' '
}
if [ "$architecture" = amd64 ]; then
    first=$((($(number_at 497 1) + 1) * 512 + $(number_at 584 4)))
    tail -c "+$((first + 1))" "$kernel" | head -c "$(($(number_at 588 4) - 4))" >"$new/packed"
    for unpack in xz zstd; do # without zstd, which few need, it unpacks itself
        if $unpack -dc <"$new/packed" >"$new/vmlinux" 2>/dev/null; then
            kernel=$new/vmlinux
            break
        fi
    done
fi
rm -f "$folder/initrd"
mv "$kernel" "$folder/vmlinuz"
cp "$new/kernel/bin/busybox" "$folder/busybox" # for guests that have no files of this machine
mv "$new/initrd" "$folder/initrd"
echo "$package" >"$folder/package"
