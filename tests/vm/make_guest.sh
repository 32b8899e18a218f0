#!/bin/sh
# make_guest.sh ARCHITECTURE FOLDER: makes FOLDER/vmlinuz and FOLDER/initrd, a stock Debian kernel with the few modules
# that the tests load, for boot.sh. Exit code 77 and a sentence where this machine cannot. What is there already is kept
# until Debian has a newer kernel (or for a week without asking): remove FOLDER to make it anew.
#
# Nothing is installed: the kernel's package is downloaded and unpacked here, from lists of its own, so that another
# architecture needs no change of the system's either. The rest of the guest is the machine's own files (boot.sh).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
architecture=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
# Drivers of disks, cameras and screens that the tests use; modprobe adds what they depend on.
modules="virtio_pci 9p 9pnet_virtio vivid vgem"

skip() {
    echo "skipped: $1"
    exit 77
}

for tool in apt-get busybox cpio depmod dpkg-deb modprobe xz; do
    command -v $tool >/dev/null || skip "no $tool: the packages are listed in test.sh"
done
[ -n "$(find "$folder/initrd" -newer "$here/make_guest.sh" -newer "$here/init.sh" -mtime -7 2>/dev/null)" ] && exit 0

apt="$folder/apt"
mkdir -p "$apt/state/lists/partial" "$apt/cache/archives/partial"
: >"$apt/status"
cat >"$apt/apt.conf" <<END
Dir::State "$apt/state";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
APT::Architecture "$architecture";
APT::Architectures { "$architecture"; };
APT::Sandbox::User "";
Acquire::Languages "none";
Acquire::Retries "2";
END
APT_CONFIG=$apt/apt.conf
export APT_CONFIG

new=$folder/new
rm -rf "$new"
mkdir -p "$new/kernel" "$new/root/bin"
trap 'rm -rf "$new"' EXIT
{ apt-get -qq update && apt-cache depends "linux-image-$architecture" >"$new/depends"; } >"$folder/apt.log" 2>&1 ||
    skip "apt-get finds no kernel: $(tail -n 1 "$folder/apt.log")"
package=$(awk '$1 == "Depends:" { print $2; exit }' "$new/depends")
if [ "$(cat "$folder/package" 2>/dev/null)" = "$package" ] && [ "$folder/initrd" -nt "$here/make_guest.sh" ] &&
    [ "$folder/initrd" -nt "$here/init.sh" ]; then
    touch "$folder/initrd"
    exit 0
fi
(cd "$new" && apt-get -qq download "$package") >"$folder/apt.log" 2>&1 ||
    skip "apt-get cannot download $package: $(tail -n 1 "$folder/apt.log")"
dpkg-deb -x "$new"/*.deb "$new/kernel"
release=$(ls "$new/kernel/lib/modules")
depmod -b "$new/kernel" "$release"

# The guest's first files: busybox, init, and the modules with their dependencies, which modprobe finds as in a system.
to=$new/root/lib/modules/$release
for module in $modules; do
    modprobe -d "$new/kernel" -S "$release" --show-depends "$module"
done | awk '$1 == "insmod" && !seen[$2]++ { print $2 }' >"$new/wanted"
while read -r file; do
    name=${file#"$new/kernel/lib/modules/$release/"}
    mkdir -p "$to/$(dirname "$name")"
    case $file in
    *.xz) xz -dc "$file" >"$to/${name%.xz}" ;;
    *) cp "$file" "$to/$name" ;;
    esac
done <"$new/wanted"
cp "$new/kernel/lib/modules/$release"/modules.builtin* "$new/kernel/lib/modules/$release"/modules.order "$to"
depmod -b "$new/root" "$release"
cp "$(command -v busybox)" "$new/root/bin/busybox"
cp "$here/init.sh" "$new/root/init"
chmod 755 "$new/root/init"
(cd "$new/root" && find . | LC_ALL=C sort | cpio -o -H newc --quiet -R 0:0) >"$new/initrd"

# A PC's kernel unpacks itself, which takes the emulator longer than the rest of the boot; qemu also boots what is in it.
# Where it lies: the kernel's Documentation/arch/x86/boot.rst (setup_sects, payload_offset, payload_length).
kernel=$new/kernel/boot/vmlinuz-$release
field() {
    od -A n -t "u$2" -j "$1" -N "$2" "$kernel" | tr -d ' '
}
if [ "$architecture" = amd64 ]; then
    first=$((($(field 497 1) + 1) * 512 + $(field 584 4)))
    tail -c "+$((first + 1))" "$kernel" | head -c "$(field 588 4)" >"$new/payload"
    xz -dc --single-stream "$new/payload" >"$new/vmlinux" 2>/dev/null && mv "$new/vmlinux" "$kernel"
fi

mv "$kernel" "$folder/vmlinuz"
mv "$new/initrd" "$folder/initrd"
echo "$package" >"$folder/package"
rm -rf "$apt"
