#!/bin/sh
# installed.sh: in a clean Debian (test_debian.sh) with the packages in /build: they are installed by apt, tested by
# autopkgtest, removed and purged, and nothing of them is left.
set -eu
cd /build
apt-get -qq update
# Unquoted on purpose: the packages of both kinds.
apt-get -qq install -y --no-install-recommends ./*.deb >install.log 2>&1 || { tail -n 20 install.log; exit 1; }
names=$(for file in *.deb; do dpkg-deb -f "$file" Package; done)
dpkg -L $names | sort -u | while read -r path; do [ -d "$path" ] || echo "$path"; done >files
[ -s files ] || { echo "nothing is installed"; exit 1; }
# files that a run would leave, and that an administrator would write
mkdir -p /etc/pupil /var/lib/private/pupil/video0 /etc/systemd/system/dev-video0.device.wants
ln -s private/pupil /var/lib/pupil
: >/etc/pupil/video0.conf
: >/var/lib/private/pupil/video0/exposure
ln -s /usr/lib/systemd/system/pupil@.service /etc/systemd/system/dev-video0.device.wants/pupil@video0.service

status=0
autopkgtest --no-built-binaries --output-dir=/build/autopkgtest ./*.deb ./*.dsc -- null >autopkgtest.log 2>&1 || status=$?
cat autopkgtest/summary
# 2: a test was skipped, which is not allowed
[ $status = 0 ] || { echo "autopkgtest: exit $status"; tail -n 40 autopkgtest.log; exit 1; }
[ "$(grep -c ' PASS' autopkgtest/summary)" = "$(grep -c '^Tests:' /build/debian-tests-control)" ] || { echo "not all tests passed"; exit 1; }

apt-get -qq remove -y $names >remove.log 2>&1 || { cat remove.log; exit 1; }
[ -e /var/lib/private/pupil/video0/exposure ] && [ -e /etc/pupil/video0.conf ] || { echo "removing takes what only purging may"; exit 1; }
dpkg --purge $names >purge.log 2>&1 || { cat purge.log; exit 1; }
while read -r path; do
    [ ! -e "$path" ] || { echo "left: $path"; exit 1; }
done <files
left=$(find / -xdev -iname '*pupil*' -not -path '/build/*' -not -path '/tmp/*' -not -path '/var/cache/apt/*' -print)
[ -z "$left" ] || { echo "left: $left"; exit 1; }
echo "$(wc -l <files) files were installed, and none is left"
