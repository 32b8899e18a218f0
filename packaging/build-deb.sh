#!/bin/sh
# build-deb.sh [--here] [-a ARCHITECTURE] [-s SUITE] [FOLDER]: Debian packages of this tree, into FOLDER
# (build/deb/ARCHITECTURE), and lintian's opinion of them in FOLDER/lintian.txt: any error or warning is a failure.
#   -a ARCHITECTURE  this machine's, or another one (arm64, armhf), cross-built: its libraries are installed next to
#                    this machine's
#   -s SUITE         for that release of Debian (bookworm, trixie), in place of the one that runs here
#   --here           with what is installed here, in place of a clean Debian; without lintian
# The clean Debian is a folder, build/deb/root-ARCHITECTURE (2 GB), with what builds need. mmdebstrap makes it if it is
# absent or of another release, or debian/control asks for other packages, which needs root, the network and some
# minutes.
# Builds leave nothing in it.
# DEBIAN_SOURCE, if set, is a line of sources.list for it, instead of those of Debian's servers.
# What git lists is built as it is in this folder, committed or not. CCACHE_DIR, if set, is used in the clean Debian, too.
set -eu
usage="usage: $0 [--here] [-a ARCHITECTURE] [-s SUITE] [FOLDER]"
tree=$(cd "$(dirname "$0")/.." && pwd)
native=$(dpkg --print-architecture)
architecture=$native
suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-bookworm}")
here=
folder=
while [ $# -gt 0 ]; do
    case $1 in
    --here) here=1 ;;
    -a)
        [ $# -gt 1 ] || { echo "$usage" >&2; exit 2; }
        architecture=$2
        shift
        ;;
    -s)
        [ $# -gt 1 ] || { echo "$usage" >&2; exit 2; }
        suite=$2
        shift
        ;;
    -*)
        echo "$usage" >&2
        exit 2
        ;;
    *) folder=$1 ;;
    esac
    shift
done
folder=${folder:-$tree/build/deb/$architecture}
root=$tree/build/deb/root-$architecture
version=$(sed -n '1s/^pupil (\(.*\)-[^-]*).*/\1/p' "$tree/packaging/debian/changelog")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
[ -n "$here" ] || {
    [ "$(id -u)" = 0 ] || { echo "$0: a clean Debian needs root; without: $0 --here" >&2; exit 1; }
    command -v mmdebstrap >/dev/null ||
        { echo "$0: no mmdebstrap: apt-get install mmdebstrap; without: $0 --here" >&2; exit 77; }
}

# --- the source package: the tree, and debian/ ---
mkdir -p "$work/build" "$folder"
(
    cd "$tree"
    if [ -e .git ]; then
        git ls-files --cached --others --exclude-standard
    else
        find . -type f -not -path './build*' -printf '%P\n'
    fi | while read -r name; do [ ! -f "$name" ] || echo "$name"; done | LC_ALL=C sort >"$work/names"
    stamp=$(sed -n 's/^ -- .*>  //p' packaging/debian/changelog | head -n 1)
    tar -c --owner=0 --group=0 --numeric-owner --mode=u+rw,go=rX --mtime="$stamp" \
        --transform "s,^,pupil-$version/," -T "$work/names"
) | xz -T 0 -3 >"$work/build/pupil_$version.orig.tar.xz"
tar -C "$work/build" -xf "$work/build/pupil_$version.orig.tar.xz"
cp -R "$tree/packaging/debian" "$work/build/pupil-$version/debian"

what=
[ "$architecture" = "$native" ] || what="-B -a$architecture"
if [ -n "$here" ]; then
    # Unquoted, to be split into words.
    (cd "$work/build/pupil-$version" && dpkg-buildpackage -us -uc ${what:--b}) >"$folder/build.log" 2>&1 || {
        tail -n 30 "$folder/build.log" | cut -c1-300 >&2
        echo "$0: the build failed; all of its output is in $folder/build.log" >&2
        exit 1
    }
else
    # --- the clean Debian ---
    # What the clean Debian is made for.
    control="$suite $(sed -n '/^Build-Depends:/,/^Standards-Version:/p' "$tree/packaging/debian/control" | sha256sum)"
    if [ "$(cat "$root.control" 2>/dev/null)" != "$control" ]; then
        rm -rf "$root" "$root.control"
        mkdir -p "$root"
        more=
        [ "$architecture" = "$native" ] || more="crossbuild-essential-$architecture"
        mmdebstrap --quiet --variant=buildd --include="ca-certificates,ccache,lintian${more:+,$more}" \
            ${more:+--architectures="$native,$architecture"} \
            --customize-hook="copy-in $work/build/pupil-$version /" \
            --customize-hook="chroot \"\$1\" apt-get build-dep -qq -y ${more:+--host-architecture=$architecture \
-P cross,nocheck} /pupil-$version >\"$folder/root.log\"" \
            --customize-hook="rm -rf \"\$1/pupil-$version\"" "$suite" "$root" ${DEBIAN_SOURCE:+"$DEBIAN_SOURCE"} \
            >"$folder/mmdebstrap.log" 2>&1 || {
            tail -n 20 "$folder/mmdebstrap.log" >&2
            echo "$0: mmdebstrap failed; its output is in $folder/mmdebstrap.log" >&2
            exit 1
        }
        echo "$control" >"$root.control"
    fi
    cat >"$work/build/make.sh" <<END
set -eu
cd /build/pupil-$version
[ ! -d /ccache ] || export CCACHE_DIR=/ccache CCACHE_NOHASHDIR=1 CCACHE_BASEDIR=/build PATH=/usr/lib/ccache:\$PATH
export DEB_BUILD_OPTIONS="parallel=$(nproc)${what:+ nocheck}"
dpkg-buildpackage -us -uc ${what:+$what -Pcross,nocheck} >/build/build.log 2>&1 || exit 1
lintian --allow-root --fail-on error,warning /build/*.changes >/build/lintian.txt 2>&1 || exit 2
END
    status=0
    sh "$tree/packaging/in-chroot.sh" "$root" "$work/build" sh /build/make.sh || status=$?
    cp "$work/build/build.log" "$folder/"
    [ $status != 1 ] || {
        tail -n 30 "$folder/build.log" | cut -c1-300 >&2
        echo "$0: the build failed; all of its output is in $folder/build.log" >&2
        exit 1
    }
    cp "$work/build/lintian.txt" "$folder/"
    [ $status = 0 ] || {
        cat "$folder/lintian.txt" >&2
        echo "$0: lintian has errors or warnings, above" >&2
        exit 1
    }
fi
rm -f "$folder"/*.deb "$folder"/*.changes "$folder"/*.buildinfo "$folder"/*.dsc "$folder"/*.tar.xz
find "$work/build" -maxdepth 1 -type f -name '*pupil*' -exec mv -t "$folder" {} +
(cd "$folder" && ls -- *.deb)
