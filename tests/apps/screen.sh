# screen.sh: sourced after lib.sh by tests that need a screen: a virtual one, 640 x 480.

# on_no_screen ARGUMENTS...: without a display the program says so, and leaves no a.y4m
on_no_screen() {
    needs Xvfb xdotool import convert
    got=0
    env -u DISPLAY -u WAYLAND_DISPLAY -u SDL_VIDEODRIVER "$program" "$@" --view -o a.y4m 2>said.err || got=$?
    grep -qE "PUPIL_(GPU|PROGRAM)=OFF" said.err && skip "$(cat said.err)"
    [ $got = 1 ] || fail "no display: exit $got"
    grep -q "display" said.err || fail "no display: said $(cat said.err)"
    [ ! -e a.y4m ] || fail "no display, but an output"
}

# begin_screen: $DISPLAY
begin_screen() {
    export SDL_VIDEODRIVER=x11 SDL_VIDEO_X11_FORCE_EGL=1 XDG_RUNTIME_DIR="$room"
    Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp -noreset 3>number >xvfb.log 2>&1 &
    server=$!
    trap 'kill $server 2>/dev/null; leave' EXIT
    tries=0
    while [ ! -s number ] && [ $tries -lt 100 ]; do sleep 0.1; tries=$((tries + 1)); done
    [ -s number ] || skip "Xvfb does not start: $(cat xvfb.log)"
    DISPLAY=:$(cat number)
    export DISPLAY
}

# look: saves the present screen as look.png
look() { import -window root look.png; }
# mean CROP: the mean of that part of look.png, 0 to 65535
mean() { convert look.png -crop "$1" +repage -colorspace gray -format '%[fx:int(65535*mean)]' info:; }
