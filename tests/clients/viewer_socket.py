"""Pages of a vdbview without a browser."""

import base64
import json
import os
import re
import socket
import struct
import threading
import time


class Socket:
    """A page without a browser: turns, and acknowledges what it gets."""

    def __init__(self, url):
        host, port, token = re.fullmatch(r"http://([^:/]+):(\d+)/(\w+)/", url).groups()
        self.connection = socket.create_connection((host, int(port)))
        key = base64.b64encode(os.urandom(16)).decode()
        self.connection.sendall((f"GET /{token}/socket HTTP/1.1\r\nHost: {host}:{port}\r\nOrigin: http://{host}:{port}\r\n"
                                 "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                                 f"Sec-WebSocket-Key: {key}\r\n\r\n").encode())
        self.stream = self.connection.makefile("rb")
        while self.stream.readline() not in (b"\r\n", b""):
            pass
        self.pictures = 0
        self.finals = {}  # by number: what is said of a finished picture, and its file
        threading.Thread(target=self.read, daemon=True).start()

    def send(self, message):
        data = json.dumps(message).encode()
        mask = os.urandom(4)
        head = struct.pack("!BB", 0x81, 0x80 | len(data)) if len(data) < 126 else struct.pack("!BBH", 0x81, 0xFE, len(data))
        self.connection.sendall(head + mask + bytes(byte ^ mask[n % 4] for n, byte in enumerate(data)))

    def read(self):
        try:
            while True:
                first, size = self.stream.read(2)
                if size == 126:
                    size = struct.unpack("!H", self.stream.read(2))[0]
                elif size == 127:
                    size = struct.unpack("!Q", self.stream.read(8))[0]
                if first & 15 != 0:  # not the next piece of a message
                    kind, data = first & 15, b""
                data += self.stream.read(size)
                if first & 0x80 and kind == 2:
                    self.pictures += 1
                    self.keep(data)
                    self.send({"type": "shown"})
        except (OSError, ValueError):
            pass

    def keep(self, data):
        length = struct.unpack("<I", data[:4])[0]
        head = json.loads(data[4:4 + length])
        if head.get("kind") == "final":
            self.finals[head["number"]] = head, data[4 + length:]

    def final(self, number, state, seconds=60):
        """Asks for a picture, and waits until it is finished."""
        self.send({"type": "show", "number": number, "moving": False, "own": False, "state": state})
        until = time.monotonic() + seconds
        while number not in self.finals and time.monotonic() < until:
            time.sleep(0.02)
        return self.finals.get(number, (None, b""))


def resident(process):
    """Its memory in MB."""
    with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
        return int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1)) / 1024


def soak(process, url, seconds, tell):
    """Eight clients turn, slide and colour; returns them. tell(seconds, process, clients) each half minute."""
    clients = [Socket(url) for _ in range(8)]
    begin, turn, told = time.monotonic(), 0, 0
    while process.poll() is None and time.monotonic() - begin < seconds:
        turn += 1
        for n, client in enumerate(clients):
            view = (turn // 40 + n) % 7
            state = {"size": [640, 360], "camera": {"view": ["iso", "front", "back", "left", "right", "top", "bottom"][view]},
                     "layers": [0, 0] if turn % 3 else [1 + turn % 5, 20 + turn % 50],
                     "color_by": ["", "feature", "layer"][turn // 25 % 3]}
            client.send({"type": "show", "number": turn, "moving": turn % 20 > 0, "state": state})
        time.sleep(0.1 if turn % 20 else 1.5)
        if time.monotonic() - begin > told * 30:
            told += 1
            tell(time.monotonic() - begin, process, clients)
    return clients
