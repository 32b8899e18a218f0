# roots.sh: for the tests of packages: sets $tree; clean_root makes and names a clean Debian with a user's packages and
# those that tests install. build_packages ARCHITECTURE makes the packages; both are kept in build/deb for the next
# test. Both are of the release of Debian that runs here, or of DEBIAN_SUITE.
suite=${DEBIAN_SUITE:-$(. /etc/os-release && echo "${VERSION_CODENAME:-bookworm}")}
tree=$(cd "$(dirname "$0")/../.." && pwd)
skip() {
    echo "skipped: $1"
    exit 77
}
command -v mmdebstrap >/dev/null || skip "no mmdebstrap: the packages are listed in test.sh"
[ "$(id -u)" = 0 ] || { echo "skipped: a clean Debian needs root"; exit 76; }
mkdir -p "$tree/build/deb"
exec 9>"$tree/build/deb/lock"
flock 9 # tests run at the same time
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

clean_root() {
    clean=$tree/build/deb/clean
    [ "$(cat "$clean.made" 2>/dev/null)" != "$suite" ] || return 0
    rm -rf "$clean" "$clean.made"
    mkdir -p "$clean"
    mmdebstrap --quiet --variant=minbase --include=autopkgtest,ca-certificates,dbus,systemd-sysv,udev "$suite" "$clean" \
        ${DEBIAN_SOURCE:+"$DEBIAN_SOURCE"} >"$work/mmdebstrap.log" 2>&1 || { cat "$work/mmdebstrap.log"; exit 1; }
    echo "$suite" >"$clean.made"
}

# build_packages ARCHITECTURE: into build/deb/ARCHITECTURE, unless they were already made for this release from this tree
# (without pictures and the tests of packages)
build_packages() {
    now="$suite $(cd "$tree" && git ls-files --cached --others --exclude-standard |
        grep -vE '^(docs/.*\.(jpg|png)|tests/(packaging|vm)/)' | while read -r name; do
        [ ! -f "$name" ] || sha256sum "$name"; done | sha256sum)"
    [ "$(cat "$tree/build/deb/$1.tree" 2>/dev/null)" != "$now" ] || return 0
    sh "$tree/packaging/build-deb.sh" -s "$suite" -a "$1"
    echo "$now" >"$tree/build/deb/$1.tree"
}
