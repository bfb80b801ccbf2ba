"""G-code in its containers, made from the formats' documents: what the client tests pack themselves."""

import io
import struct
import zipfile
import zlib


def zipped(entries):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    return out.getvalue()


def heatshrink(data):
    """Literals alone: a bit 1 before each byte."""
    bits = "".join("1" + format(byte, "08b") for byte in data)
    bits += "0" * (-len(bits) % 8)
    return int(bits, 2).to_bytes(len(bits) // 8, "big")


def meatpack(text):
    """Two characters a byte; 15 stands for one that follows as it is. A line's end takes a byte's second half with it."""
    table = {ord(letter): n for n, letter in enumerate("0123456789. \nGX")}
    out = bytearray(b"\xff\xff\xfb")
    at = 0
    while at < len(text):
        pair = text[at:at + 1] if text[at:at + 1] == b"\n" else text[at:at + 2]
        at += len(pair)
        codes = [table.get(letter, 15) for letter in pair]
        out.append(codes[0] | codes[-1] << 4)
        out += bytes(letter for letter, code in zip(pair, codes) if code == 15)
    return bytes(out)


def bgcode_block(kind, compression, parameters, data, checksum=True):
    packed = zlib.compress(data) if compression == 1 else heatshrink(data) if compression in (2, 3) else data
    head = struct.pack("<HHI", kind, compression, len(data))
    if compression:
        head += struct.pack("<I", len(packed))
    block = head + parameters + packed
    return block + struct.pack("<I", zlib.crc32(block)) if checksum else block


def bgcode(text, compression, encoding=0, checksum=True):
    """Prusa's binary G-code: header, the metadata that it must have, and the program in two blocks of whole lines."""
    ini = struct.pack("<H", 0)
    half = text.index(b"\n", len(text) // 2) + 1
    out = b"GCDE" + struct.pack("<IH", 1, int(checksum))
    for kind in (0, 3, 4, 2):
        out += bgcode_block(kind, 0, ini, b"key=value\n", checksum)
    for part in (text[:half], text[half:]):
        out += bgcode_block(1, compression, struct.pack("<H", encoding), part if encoding == 0 else meatpack(part),
                            checksum)
    return out


def gx(text):
    bitmap = b"BM" + struct.pack("<I", 54 + 240) + bytes(48) + b"0" * 240
    head = b"xgcode 1.0\n\0" + struct.pack("<5I", 0, 58, 58 + len(bitmap), 58 + len(bitmap), 100)
    return head.ljust(58, b"\0") + bitmap + text
