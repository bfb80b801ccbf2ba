"""The viewer and what goes wrong around it: pipes, empty files, restarts, idle and noisy connections, secrets."""

import base64
import os
import re
import shutil
import signal
import socket
import stat
import struct
import subprocess
import tempfile
import time
import urllib.request

from run_tools import BIN, check, gcode

FOLDER = tempfile.mkdtemp(prefix="stratum_view_faults_")
VDBVIEW = os.path.join(BIN, "vdbview")


class Server:
    def __init__(self, *arguments, env=None):
        self.process = subprocess.Popen([VDBVIEW, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        env=env)
        self.url = self.process.stdout.readline().strip()
        self.host, self.port, self.token = re.fullmatch(r"http://([^:/]+):(\d+)/(\w+)/", self.url).groups()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        """It ends when it is told to, whatever happened."""
        self.process.send_signal(signal.SIGTERM)
        try:
            _, self.said = self.process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            check(False, "the server does not end")
        check(self.process.returncode == 0, f"it ends with {self.process.returncode}")

    def socket(self):
        connection = socket.create_connection((self.host, int(self.port)), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        connection.sendall((f"GET /{self.token}/socket HTTP/1.1\r\nHost: {self.host}:{self.port}\r\nOrigin: http://"
                            f"{self.host}:{self.port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n").encode())
        stream = connection.makefile("rb")
        check(b" 101 " in stream.readline(), "a web socket")
        while stream.readline() not in (b"\r\n", b""):
            pass
        return connection, stream


def frame(text):
    data, mask = text.encode(), os.urandom(4)
    return struct.pack("!BB", 0x81, 0x80 | len(data)) + mask + bytes(b ^ mask[n % 4] for n, b in enumerate(data))


def frames(stream):
    """What the server sends: (kind, bytes)."""
    while True:
        head = stream.read(2)
        if len(head) < 2:
            return
        size = head[1]
        if size == 126:
            size = struct.unpack("!H", stream.read(2))[0]
        elif size == 127:
            size = struct.unpack("!Q", stream.read(8))[0]
        yield head[0] & 15, stream.read(size)


def told(stream, words):
    for kind, data in frames(stream):
        if kind == 1 and words in data:
            return data.decode()
    return None


def pipes():
    """A pipe in place of the input is refused, and blocks nobody."""
    path, pipe = os.path.join(FOLDER, "part.gcode"), os.path.join(FOLDER, "pipe")
    shutil.copy(gcode("tile.gcode"), path)
    os.mkfifo(pipe)
    run = subprocess.run([VDBVIEW, pipe], capture_output=True, text=True, timeout=60, check=False)
    check(run.returncode == 2 and "pipe" in run.stderr, f"a pipe on the command line: {run.returncode} {run.stderr}")
    with Server(path, "--voxel-size", "0.2") as server:
        connection, stream = server.socket()
        check(told(stream, b'"facts"'), "the print is read")
        os.rename(pipe, path)
        check(told(stream, b"is a pipe"), "the page is told of a pipe")
        os.unlink(path)
        shutil.copy(gcode("tile.gcode"), path)
        check(told(stream, b'"facts"'), "and shows a file again")
        connection.close()
    # Of a link that leads to one, too, which nobody writes and closes.
    link = os.path.join(FOLDER, "link.gcode")
    os.symlink(path, link)
    os.mkfifo(pipe)
    with Server(link, "--voxel-size", "0.2") as server:
        connection, stream = server.socket()
        check(told(stream, b'"facts"'), "the print behind a link is read")
        os.unlink(link)
        os.symlink(pipe, link)
        check(told(stream, b"is a pipe"), "the page is told of a link to a pipe")
        os.unlink(link)
        os.symlink(path, link)
        check(told(stream, b'"facts"'), "and shows a file again")
        connection.close()


def empty():
    """An empty file does not stop the others."""
    nothing = os.path.join(FOLDER, "empty.gcode")
    with open(nothing, "w", encoding="utf-8"):
        pass
    with Server(nothing, gcode("tile.gcode")) as server:
        connection, stream = server.socket()
        check("tile.gcode" in told(stream, b'"hello"'), "the other file is there")
        connection.close()
    check("empty.gcode" in server.said, f"the empty one is told of: {server.said}")
    run = subprocess.run([VDBVIEW, nothing], capture_output=True, text=True, timeout=60, check=False)
    check(run.returncode == 3 and "empty" in run.stderr, f"alone, it ends the viewer: {run.returncode} {run.stderr}")


def secrets():
    """The token is in no argument of a process, and may be kept."""
    tools = os.path.join(FOLDER, "tools")
    os.mkdir(tools)
    record = os.path.join(FOLDER, "opened")
    with open(os.path.join(tools, "xdg-open"), "w", encoding="utf-8") as file:
        file.write(f'#!/bin/sh\nstat -c %a "$1" > {record}.mode; cat "$1" > {record}.page; echo "$*" > {record}\n')
    os.chmod(os.path.join(tools, "xdg-open"), 0o755)
    env = {**os.environ, "PATH": tools + ":" + os.environ["PATH"], "XDG_RUNTIME_DIR": FOLDER}
    with Server(gcode("tile.gcode"), "--open", env=env) as server:
        end = time.monotonic() + 60
        while not os.path.exists(record) and time.monotonic() < end:
            time.sleep(0.05)
        with open(record, encoding="utf-8") as file:
            page = file.read().strip()
        check(server.token not in page and page.endswith(".html"), f"xdg-open gets a file: {page}")
        with open(record + ".page", encoding="utf-8") as file:
            check(server.url in file.read(), "that leads to the page")
        with open(record + ".mode", encoding="utf-8") as file:
            check(file.read().strip() == "600", "and is its owner's alone")
    check(not os.path.exists(page), "the file is gone afterwards")
    token = os.path.join(FOLDER, "token")
    with Server(gcode("tile.gcode"), "--token-file", token) as server:
        check(stat.S_IMODE(os.stat(token).st_mode) == 0o600, "the token's file is its owner's alone")
    with Server(gcode("tile.gcode"), "--token-file", token, "--port", server.port) as again:
        check(again.url == server.url, "the next server has the same URL")
    with open(token, "w", encoding="utf-8") as file:
        file.write("short\n")
    run = subprocess.run([VDBVIEW, gcode("tile.gcode"), "--token-file", token], capture_output=True, text=True, timeout=60,
                         check=False)
    check(run.returncode == 3, f"a guessable token is refused: {run.returncode}")


def crowds():
    """Idle connections don't keep the page away, and who floods is told why it is shut out."""
    with Server(gcode("tile.gcode"), "--voxel-size", "0.2") as server:
        held = [socket.create_connection((server.host, int(server.port)), timeout=60) for _ in range(300)]
        begin = time.monotonic()
        with urllib.request.urlopen(server.url, timeout=15) as answer:
            check(answer.status == 200, "the page beside 300 idle connections")
        check(time.monotonic() - begin < 12, f"at once: {time.monotonic() - begin:.1f} s")  # they may idle for 20 s
        for connection in held:
            connection.close()
        connection, stream = server.socket()
        try:
            connection.sendall(frame('{"type":"shown"}') * 2000)
        except OSError:
            pass
        closed = [data for kind, data in frames(stream) if kind == 8]
        check(closed and b"too many messages" in closed[0], f"a flood is told why: {closed}")
        connection.close()


try:
    pipes()
    empty()
    secrets()
    crowds()
finally:
    shutil.rmtree(FOLDER, ignore_errors=True)
