"""Decodes 8-bit PNG files: PNG Specification, ISO/IEC 15948, every CRC checked."""
import struct
import zlib


def png_pixels(data):
    """Width, height and rows from the top, each a bytearray of 1, 3 or 4 channels a pixel."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed = 8, b""
    while at < len(data):
        length, = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        assert struct.unpack_from(">I", data, at + 8 + length)[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            assert depth == 8, "8 bits"
            each = {0: 1, 2: 3, 6: 4}[color]
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    assert kind == b"IEND"
    raw, stride = zlib.decompress(packed), each * width
    assert len(raw) == height * (stride + 1)
    before, rows = bytearray(stride), []
    for y in range(height):
        method, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        if method == 1:  # Sub, the only filter of vdbtrace's pictures
            for x in range(each, stride):
                row[x] = (row[x] + row[x - each]) & 255
        elif method:
            for x in range(stride):
                left, up, corner = (row[x - each], before[x], before[x - each]) if x >= each else (0, before[x], 0)
                guess = left + up - corner
                paeth = min((left, up, corner), key=lambda v: abs(guess - v))
                row[x] = (row[x] + (0, left, up, (left + up) // 2, paeth)[method]) & 255
        rows.append(row)
        before = row
    return width, height, rows
