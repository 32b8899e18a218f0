# uvc_plug.sh: for guests' scripts: a USB camera whose controls were set by a user. $camera is uvc_camera's file, $node
# node_command's.

# plug WORDS...: a camera with these options; $plugged is its process, $path its node
plug() {
    "$camera" "$@" &
    plugged=$!
    for _ in $(seq 200); do
        path=$("$node" find uvcvideo capture 0) && break
        sleep 0.1
    done
    "$node" set "$path" "Auto Exposure" 3
    "$node" set "$path" Gain 40
}

# is_put_back: the controls have what plug gave them
is_put_back() {
    [ "$("$node" get "$path" "Auto Exposure"; "$node" get "$path" Gain)" = "3
40" ]
}
