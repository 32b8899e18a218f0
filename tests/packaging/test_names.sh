#!/bin/sh
# packaging.names: the packages are named after the soname, their version is the tree's and is in the changelog; the
# program accepts what the packages' tests and the unit use.
set -u
. "$(dirname "$0")/../lib.sh"
tree=$(cd "$(dirname "$0")/../.." && pwd)
use_pupil
debian=$tree/packaging/debian
version=$(sed -n 's/^project(pupil VERSION \([0-9.]*\).*/\1/p' "$tree/CMakeLists.txt")
soversion=${version%.*}
[ "${version%%.*}" = 0 ] || soversion=${version%%.*}
[ -n "$version" ] || fail "CMakeLists.txt has no version"
grep -qx "Package: libpupil$soversion" "$debian/control" || fail "control has no libpupil$soversion"
[ "$(grep -o 'libpupil[0-9][0-9.]*' "$debian/control" | sort -u)" = "libpupil$soversion" ] ||
    fail "control names $(grep -o 'libpupil[0-9][0-9.]*' "$debian/control" | sort -u | tr '\n' ' ')"
[ -e "$debian/libpupil$soversion.install" ] || fail "no libpupil$soversion.install"
[ "$(sed -n '1s/^pupil (\(.*\)-[^-]*) .*/\1/p' "$debian/changelog")" = "$version" ] ||
    fail "debian/changelog begins with $(head -n 1 "$debian/changelog"), and the version is $version"
grep -q "^## \[$version\]" "$tree/CHANGELOG.md" || fail "CHANGELOG.md has no $version"
call 0 "" version
grep -qF "pupil $version (library $version)" said.out || fail "version: $(cat said.out)"
for recipe in "$tree/packaging/buildroot/pupil/pupil.mk" "$tree"/packaging/yocto/pupil_*.bb; do
    [ -e "$recipe" ] || fail "$recipe is not there"
done
[ -e "$tree/packaging/yocto/pupil_$version.bb" ] || fail "the recipe of Yocto is not of $version"
grep -qx "PUPIL_VERSION = $version" "$tree/packaging/buildroot/pupil/pupil.mk" || fail "pupil.mk is not of $version"

# the CMake options that recipes name exist
for option in $(grep -rhoE -- '-DPUPIL_[A-Z_0-9]+' "$tree/packaging" | sort -u | sed 's/-D//'); do
    grep -rqE "\b$option\b" "$tree/CMakeLists.txt" "$tree"/packaging/systemd/CMakeLists.txt "$tree/drivers/python/CMakeLists.txt" ||
        fail "a recipe names $option, which is no option"
done
end_test
