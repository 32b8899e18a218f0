# tests/vm/amd64.sh: sourced by the tests whose program is this machine's: $here is this folder, $guest the guest's;
# in_guest COMMAND... runs it there.
here=$(cd "$(dirname "$0")" && pwd)
guest=$here/../../build/vm/amd64
[ "$(uname -m)" = x86_64 ] || {
    echo "skipped: the program is of this machine, and there is a guest for amd64 alone"
    exit 76
}

in_guest() {
    sh "$here/make_guest.sh" amd64 "$guest"
    sh "$here/boot.sh" amd64 "$guest" 600 "$@"
}
