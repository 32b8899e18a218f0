#!/bin/sh
# make_vimc.sh FOLDER: makes FOLDER/vimc.ko, the kernel's simulated sensor behind a media graph, for the guest that
# make_guest.sh made there for this machine's architecture. Debian does not ship it: it is built from the kernel's
# source package (140 MB to download, once for each kernel). Exit code 77 and a sentence if this machine cannot.
set -eu
folder=$(cd "$1" && pwd)
package=$(cat "$folder/package")
release=${package#linux-image-}
series=$(echo "$release" | cut -d. -f1,2)

skip() {
    echo "skipped: $1"
    exit 77
}

for tool in apt-get dpkg-deb flock gcc make strip xz; do
    command -v $tool >/dev/null || skip "no $tool: the packages are listed in test.sh"
done
exec 8>"$folder/vimc.lock"
flock 8
[ "$(cat "$folder/vimc.release" 2>/dev/null)" = "$release" ] && [ -e "$folder/vimc.ko" ] && exit 0

# Separate package lists, as in make_guest.sh.
new=$folder/vimc.new
rm -rf "$new"
mkdir -p "$new/state/lists/partial" "$new/cache/archives/partial" "$new/headers" "$new/source"
trap 'rm -rf "$new"' EXIT
: >"$new/status"
cat >"$new/apt.conf" <<END
Dir::State "$new/state";
Dir::State::status "$new/status";
Dir::Cache "$new/cache";
APT::Sandbox::User "";
Acquire::Languages "none";
END
export APT_CONFIG="$new/apt.conf"
apt-get -qq update >"$new/apt.log" 2>&1 || :
headers=linux-headers-$release
apt-cache depends "$headers" >"$new/depends" 2>>"$new/apt.log" || skip "apt-get finds no $headers"
needs=$(awk '$1 == "Depends:" && $2 ~ /^linux-(headers-.*-common|kbuild-)/ { print $2 }' "$new/depends")
# Unquoted on purpose.
(cd "$new" && apt-get -qq download "$headers" $needs "linux-source-$series") >"$new/apt.log" 2>&1 ||
    skip "apt-get cannot download $headers and linux-source-$series: $(head -n 1 "$new/apt.log")"
for file in "$new"/linux-headers-*.deb "$new"/linux-kbuild-*.deb; do
    dpkg-deb -x "$file" "$new/headers"
done
tree=$new/headers/usr/src/$headers
for file in "$tree/Makefile" "$tree/.config"; do # what is named by where it would be installed
    [ ! -e "$file" ] || sed -i "s|/usr/src/|$new/headers/usr/src/|g; s|/usr/lib/linux-kbuild|$new/headers/usr/lib/linux-kbuild|g" "$file"
done
rm -f "$tree/scripts" "$tree/tools"
kbuild=$(echo "$new"/headers/usr/lib/linux-kbuild-*)
ln -s "$kbuild/scripts" "$tree/scripts"
ln -s "$kbuild/tools" "$tree/tools"
rm -f "$tree/vmlinux" # no type information of the kernel's for a module that is loaded once

dpkg-deb --fsys-tarfile "$new"/linux-source-*.deb | tar -xO --wildcards '*.tar.xz' | xz -dc |
    tar -x -C "$new/source" --strip-components=5 --wildcards 'linux-source-*/drivers/media/test-drivers/vimc/*'
make -s -C "$tree" M="$new/source" CONFIG_VIDEO_VIMC=m modules >"$new/make.log" 2>&1 || {
    tail -n 20 "$new/make.log"
    skip "vimc does not build from linux-source-$series for $release"
}
strip --strip-debug -o "$folder/vimc.ko" "$new/source/vimc.ko"
echo "$release" >"$folder/vimc.release"
