"""notify_listen.py SOCKET|@NAME FILE: a service manager's socket. Messages are written to FILE, one a line."""
import socket
import sys

name, out = sys.argv[1:]
listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
listener.bind("\0" + name[1:] if name[0] == "@" else name)
with open(out, "w", buffering=1) as log:
    while True:
        log.write(listener.recv(4096).decode() + "\n")
