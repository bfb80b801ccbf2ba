"""gcode2vdb --thumbnail: pictures in G-code of every container, read back by parsers written from the formats' documents.

The program in the file must stay the same: every line besides the pictures, and the toolpath that is read from it."""

import base64
import gzip
import hashlib
import io
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import time
import zipfile
import zlib

from png_file import png_pixels
from run_tools import BIN, Scratch, check, corpus, gcode
from slicer_preview import PROGRAMS, Preview, make_locale

SCRATCH = Scratch("thumbnails")
FOLDER, path, read = SCRATCH.folder, SCRATCH.path, SCRATCH.read
GCODE2VDB = os.path.join(BIN, "gcode2vdb")


def write(name, data):
    with open(path(name), "wb") as file:
        file.write(data)
    return path(name)


def call(*arguments, stdin=b""):
    return subprocess.run([GCODE2VDB, *arguments], input=stdin, capture_output=True, timeout=300, cwd=FOLDER)


def pictured(source, sizes, output, *options):
    done = call(source, "--thumbnail", sizes, "-o", output, "--force", "--stats", "report.json", *options)
    check(done.returncode == 0, f"{os.path.basename(source)} --thumbnail {sizes}: {done.stderr.decode().strip()[-300:]}")
    return json.loads(read("report.json"))


# --- pictures ---------------------------------------------------------------------------------------------------------

def qoi_pixels(data):
    """The same of a QOI; qoiformat.org's specification."""
    magic, width, height, channels, space = struct.unpack_from(">4sIIBB", data)
    assert magic == b"qoif" and channels == 4 and space == 0 and data[-8:] == b"\0" * 7 + b"\1"
    seen, pixel, out, at = [(0, 0, 0, 0)] * 64, (0, 0, 0, 255), bytearray(), 14
    while at < len(data) - 8:
        tag, run = data[at], 1
        at += 1
        if tag >= 254:
            more = tag - 251
            pixel = (tuple(data[at:at + more]) + pixel[3:])[:4]
            at += more
        elif tag >> 6 == 3:
            run = (tag & 63) + 1
        elif tag >> 6 == 0:
            pixel = seen[tag]
        elif tag >> 6 == 1:
            pixel = tuple((pixel[c] + (tag >> 4 - 2 * c & 3) - 2) & 255 for c in range(3)) + pixel[3:]
        else:
            green = (tag & 63) - 32
            red, blue = green - 8 + (data[at] >> 4), green - 8 + (data[at] & 15)
            pixel = tuple((v + d) & 255 for v, d in zip(pixel, (red, green, blue))) + pixel[3:]
            at += 1
        seen[(pixel[0] * 3 + pixel[1] * 5 + pixel[2] * 7 + pixel[3] * 11) % 64] = pixel
        out += bytes(pixel) * run
    assert len(out) == 4 * width * height
    return width, height, [out[y * 4 * width:(y + 1) * 4 * width] for y in range(height)]


def jpeg_size(data):
    assert data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9"
    at = 2
    while True:
        marker, length = struct.unpack_from(">HH", data, at)
        if 0xffc0 <= marker <= 0xffc2:
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        at += 2 + length


def bmp_pixels(data):
    size, start, head, width, height, planes, bits = struct.unpack_from("<2xI4xIIiiHH", data)
    assert data[:2] == b"BM" and size == len(data) and (start, head, planes, bits) == (54, 40, 1, 24)
    stride = (3 * width + 3) // 4 * 4
    assert len(data) == 54 + stride * height
    rows = []
    for y in reversed(range(height)):
        row = data[54 + y * stride:54 + y * stride + 3 * width]
        rows.append(b"".join(bytes((row[3 * x + 2], row[3 * x + 1], row[3 * x], 255)) for x in range(width)))
    return width, height, rows


def shows_a_part(picture, what, transparent=True, least=0.05):
    """Something lit, nothing in the corners. Returns the size."""
    width, height, rows = picture
    corners = [rows[y][4 * x:4 * x + 4] for x in (0, width - 1) for y in (0, height - 1)]
    check(all(bytes(c) == (b"\0\0\0\0" if transparent else b"\0\0\0\xff") for c in corners), f"  {what}: empty corners")
    lit = sum(max(row[4 * x:4 * x + 3]) > 40 and row[4 * x + 3] > 250 for row in rows for x in range(width))
    check(least < lit / (width * height) < 0.95, f"  {what}: {100 * lit / (width * height):.0f} % of it is the part")
    return width, height


READERS = {"PNG": png_pixels, "QOI": qoi_pixels}


# --- conventions ------------------------------------------------------------------------------------------------------

# What Moonraker, OctoPrint's plug-ins and file managers look for.
BLOCK = re.compile(r"^; thumbnail(?:_(\w+))? begin (\d+)[x ](\d+) (\d+)\r?$(.*?)^; thumbnail(?:_\1)? end\r?$", re.M | re.S)


def text_thumbnails(text):
    """(kind, width, height, bytes) of each block, its length and line lengths checked."""
    found = []
    for kind, width, height, length, body in BLOCK.findall(text.decode("utf-8", "replace")):
        lines = [line.strip() for line in body.strip().splitlines()]
        assert all(line.startswith("; ") and len(line) <= 80 for line in lines), "comments of at most 78 characters"
        coded = "".join(line[2:] for line in lines)
        assert len(coded) == int(length), f"{len(coded)} characters of base64, {length} stated"
        found.append((kind or "PNG", int(width), int(height), base64.b64decode(coded, validate=True)))
    return found


def bgcode_blocks(data):
    """(type, whole block, thumbnail or None); libbgcode's specification."""
    magic, version, checksum = struct.unpack_from("<4sIH", data)
    assert magic == b"GCDE" and version == 1 and checksum == 1
    at, blocks = 10, []
    while at < len(data):
        kind, compression, size = struct.unpack_from("<HHI", data, at)
        head = 8 if compression == 0 else 12
        stored = size if compression == 0 else struct.unpack_from("<I", data, at + 8)[0]
        parameters = 6 if kind == 5 else 2
        end = at + head + parameters + stored + 4
        assert struct.unpack_from("<I", data, end - 4)[0] == zlib.crc32(data[at:end - 4]), "CRC32 of a block"
        thumbnail = None
        if kind == 5:
            form, width, height = struct.unpack_from("<HHH", data, at + head)
            thumbnail = (("PNG", "JPG", "QOI")[form], width, height, data[at + head + 6:end - 4])
        blocks.append((kind, data[at:end], thumbnail))
        at = end
    return blocks


def without_pictures(text):
    """The lines that are left when blocks, the lines ';' and blank lines are gone."""
    bare = BLOCK.sub("", text.decode("utf-8", "replace"))
    bare = re.sub(r"^; THUMBNAIL_BLOCK_(START|END)\r?$", "", bare, flags=re.M)
    return [line for line in bare.splitlines() if line.strip() not in ("", ";")]


def toolpath(source, *options):
    done = call(source, "-o", "bare.vdb", "--dump-toolpath", "beads.csv", "--voxel-size", "0.8", "--quiet", *options)
    check(done.returncode == 0, f"  toolpath of {os.path.basename(source)}: {done.stderr.decode().strip()[-200:]}")
    rows = read("beads.csv").decode().splitlines()
    return [row.split(",", 1)[1] for row in rows]  # without the number of the line


def check_pictures(found, sizes, name):
    """What was found is what was asked for, and each can be decoded."""
    asked = [(m.group(3) or "PNG", int(m.group(1)), int(m.group(2)))
             for m in (re.fullmatch(r"(\d+)x(\d+)(?:/(\w+))?", word) for word in sizes.split(","))]
    check([picture[:3] for picture in found] == asked, f"  {name}: {[picture[:3] for picture in found]}")
    for kind, width, height, data in found:
        size = jpeg_size(data) if kind == "JPG" else shows_a_part(READERS[kind](data), f"{width}x{height}/{kind}")
        check(size == (width, height), f"  {kind} of {size[0]} x {size[1]}")


# --- text of every slicer, and gzip -----------------------------------------------------------------------------------

SIZES = "48x36,16x16/QOI,32x32/JPG"


def check_text(source, name):
    with open(source, "rb") as file:
        before = file.read()
    pictured(source, SIZES, name)
    after = read(name)
    check_pictures(text_thumbnails(after), SIZES, name)
    check(without_pictures(after) == without_pictures(before), "  every other line stays")
    check((b"\r\n" in before) == (b"\r\n; thumbnail begin" in after or b"\r\n;\r\n" in after), "  line ends are the file's")
    check(toolpath(path(name)) == toolpath(source), "  the toolpath is the same")
    again = "again_" + name
    pictured(path(name), SIZES, again)
    check(read(again) == after, "  the same again: the same bytes")


check_text(gcode("tile.gcode"), "prusa.gcode")
check(read("prusa.gcode").startswith(b"; generated by PrusaSlicer"), "  PrusaSlicer's first line stays first")
check_text(gcode("tile_cura.gcode"), "cura.gcode")
check(re.search(rb";Generated with Cura[^\n]*\n;\n; thumbnail begin 48 36 \d+\n", read("cura.gcode")) is not None,
      "  Cura's form, behind Cura's line")
with open(gcode("tile.gcode"), "rb") as plain:
    TEXT = plain.read()
write("orca.gcode", b"; HEADER_BLOCK_START\n; generated by OrcaSlicer 2.3.1\n; HEADER_BLOCK_END\n\n" + TEXT.split(b"\n", 1)[1])
check_text(path("orca.gcode"), "orca_out.gcode")
check(re.search(rb"; HEADER_BLOCK_END\n\n; THUMBNAIL_BLOCK_START\n\n;\n; thumbnail begin 48x36 .*; thumbnail_JPG end\n;\n"
                rb"; THUMBNAIL_BLOCK_END\n", read("orca_out.gcode"), re.S) is not None, "  Orca's frame around them")

write("packed.gcode.gz", gzip.compress(TEXT))
pictured(path("packed.gcode.gz"), SIZES, "packed_out.gcode.gz")
check_pictures(text_thumbnails(gzip.decompress(read("packed_out.gcode.gz"))), SIZES, "gzip")
check(gzip.decompress(read("packed_out.gcode.gz")) == read("prusa.gcode"), "  gzip holds the same text")
check(toolpath(path("packed_out.gcode.gz")) == toolpath(gcode("tile.gcode")), "  and the same toolpath")

piped = call("-", "--thumbnail", SIZES, "-o", "-", stdin=TEXT)
check(piped.returncode == 0 and piped.stdout == read("prusa.gcode"), "from standard input to standard output")

one = call(gcode("tile.gcode"), "--thumbnail", SIZES, "-o", "one.gcode", "--threads", "1")
check(one.returncode == 0 and read("one.gcode") == read("prusa.gcode"), "one thread: the same bytes")

# --- real files -------------------------------------------------------------------------------------------------------


for name in ("preprocess_cancellation-prusaslicer.gcode", "preprocess_cancellation-superslicer.gcode",
             "libbgcode-mini_cube_a.gcode", "slicercompare-bambu_plate_1.gcode", "preprocess_cancellation-cura.gcode"):
    if source := corpus(name):
        check_text(source, name)

if source := corpus("libbgcode-mini_cube_b.bgcode"):
    pictured(source, SIZES, "cube.bgcode")
    with open(source, "rb") as file:
        before = bgcode_blocks(file.read())
    after = bgcode_blocks(read("cube.bgcode"))
    check([b[1] for b in after if b[0] != 5] == [b[1] for b in before if b[0] != 5], "  every other block stays")
    check([b[0] for b in after][:7] == [0, 3, 5, 5, 5, 4, 2], "  in the order of the specification")
    check_pictures([b[2] for b in after if b[0] == 5], SIZES, "bgcode")
    check(toolpath(path("cube.bgcode")) == toolpath(source), "  the toolpath is the same")


def entries(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        return {info.filename: (archive.read(info), info.date_time, info.compress_type) for info in archive.infolist()}


for name in ("slicer-meta-orca_twocolors.gcode.3mf", "slicer-meta-flashstudio_2color.gcode.3mf"):
    if source := corpus(name):
        pictured(source, "90x60,32x32/QOI", "plate.gcode.3mf")
        with open(source, "rb") as file:
            before = entries(file.read())
        after = entries(read("plate.gcode.3mf"))
        check(list(after) == list(before), "  the same entries in the same order")
        changed = [entry for entry in before if before[entry] != after[entry]]
        check(sorted(changed) == ["Metadata/plate_1.gcode", "Metadata/plate_1.gcode.md5", "Metadata/plate_1.png",
                                  "Metadata/plate_1_small.png"], f"  changed: {changed}")
        check(shows_a_part(png_pixels(after["Metadata/plate_1.png"][0]), "plate_1.png") == (90, 60), "  its size")
        small = png_pixels(before["Metadata/plate_1_small.png"][0])[:2]
        check(shows_a_part(png_pixels(after["Metadata/plate_1_small.png"][0]), "plate_1_small.png") == small, "  its own size")
        text = after["Metadata/plate_1.gcode"][0]
        check_pictures(text_thumbnails(text), "90x60,32x32/QOI", "text in the container")
        check(without_pictures(text) == without_pictures(before["Metadata/plate_1.gcode"][0]), "  every other line stays")
        check(after["Metadata/plate_1.gcode.md5"][0].decode().lower() == hashlib.md5(text).hexdigest(), "  the MD5 is the text's")
        check(toolpath(path("plate.gcode.3mf")) == toolpath(source), "  the toolpath is the same")

if source := corpus("gcode_metadata-cura_2ext.ufp"):
    pictured(source, "80x80", "two.ufp")
    with open(source, "rb") as file:
        before = entries(file.read())
    after = entries(read("two.ufp"))
    check([entry for entry in before if before[entry][0] != after[entry][0]] == ["/Metadata/thumbnail.png"], "  its picture alone")
    check(shows_a_part(png_pixels(after["/Metadata/thumbnail.png"][0]), "thumbnail.png", least=0.02) == (80, 80), "  its size")
    check(toolpath(path("two.ufp")) == toolpath(source), "  the toolpath is the same")

if source := corpus("slicer-meta-FlashPrint.gx"):
    pictured(source, "80x60", "flash.gx")
    with open(source, "rb") as file:
        before = file.read()
    after = read("flash.gx")
    bitmap, png, text = struct.unpack_from("<III", after, 0x10)
    check((bitmap, png) == (58, 58 + 14454), "  the BMP is where printers expect it")
    check(shows_a_part(bmp_pixels(after[bitmap:png]), "BMP", transparent=False) == (80, 60), "  80 x 60")
    check(shows_a_part(png_pixels(after[png:text]), "PNG") == (320, 320), "  the PNG behind it in its own size")
    check(after[text:] == before[struct.unpack_from("<I", before, 0x18)[0]:], "  the text stays")
    check(after[:0x14] + after[0x1c:58] == before[:0x14] + before[0x1c:58], "  and the rest of the head")
    check(toolpath(path("flash.gx")) == toolpath(source), "  the toolpath is the same")

# --- in place, many at once -------------------------------------------------------------------------------------------

shutil.copy(gcode("tile.gcode"), path("own.gcode"))
os.chmod(path("own.gcode"), 0o640)
os.symlink(path("own.gcode"), path("link.gcode"))
done = call("link.gcode", "--thumbnail", SIZES, "--in-place")
check(done.returncode == 0 and read("own.gcode") == read("prusa.gcode"), "--in-place replaces the input")
check(os.path.islink(path("link.gcode")), "  the file of a link, not the link")
check(os.stat(path("own.gcode")).st_mode & 0o777 == 0o640, "  its permissions stay")
done = call("own.gcode", "cura.gcode", "--thumbnail", "32x32", "-o", "many/")
check(done.returncode == 0 and sorted(os.listdir(path("many"))) == ["cura.gcode", "own.gcode"], "several into a folder")

# --- refusals ---------------------------------------------------------------------------------------------------------


def refused(arguments, status, *fragments):
    done = call(*arguments)
    text = done.stderr.decode(errors="replace")
    check(done.returncode == status, f"{' '.join(arguments)}: exit {done.returncode}: {text.strip()}")
    for fragment in fragments:
        check(fragment in text, f"  says {fragment!r}")
    check(not os.path.exists(path("refused.gcode")), "  leaves no file behind")


to = ["-o", "refused.gcode"]
tile = gcode("tile.gcode")
refused([tile, "--thumbnail", "5000x10", *to], 2, "from 1 to 4096")
refused([tile, "--thumbnail", "0x10", *to], 2, "from 1 to 4096")
refused([tile, "--thumbnail", "300", *to], 2, "expected WIDTHxHEIGHT")
refused([tile, "--thumbnail", "30x30/PMG", *to], 2, "did you mean 'PNG'")
refused([tile, "--thumbnail", "30x30"], 2, "name the new file with -o", "--in-place")
refused([tile, "--thumbnail", "30x30", "-o", tile], 2, "is an input")
refused(["own.gcode", "--thumbnail", "30x30", "-o", "link.gcode"], 2, "the same file as the input")
refused([tile, "--thumbnail", "30x30", "--in-place", *to], 2, "leave one of them out")
refused([tile, "--in-place", *to], 2, "--thumbnail")
refused([tile, "--thumbnail", "30x30", "-o", "refused.vdb"], 2, "writes G-code again")
refused([tile, "--thumbnail", "30x30", "-o", "refused.bgcode"], 2, "keeps the container")
refused([tile, "--thumbnail", "30x30", "--grids", "layer", *to], 2, "--grids")
refused(["-", "--thumbnail", "30x30", "--in-place"], 2, "standard input can't be replaced")
refused(["none.gcode", "--thumbnail", "30x30", *to], 3, "none.gcode")
refused([tile, "--thumbnail", "30x30", "-o", "none/refused.gcode"], 1, "none")
write("open.gcode", TEXT.replace(b"\n", b"\n; thumbnail begin 16x16 8\n; AAAAAAAA\n", 1))
refused(["open.gcode", "--thumbnail", "30x30", *to], 3, "line 2", "has no end")
write("empty.gcode", b"; nothing\nG28\n")
refused(["empty.gcode", "--thumbnail", "30x30", *to], 3, "empty.gcode")
packed = io.BytesIO()
with zipfile.ZipFile(packed, "w") as archive:
    archive.writestr("Metadata/plate_1.gcode", TEXT)
write("bare.gcode.3mf", packed.getvalue())
packed = io.BytesIO()
with zipfile.ZipFile(packed, "w") as archive:
    archive.writestr("Metadata/plate_1.gcode", TEXT)
    archive.writestr("Metadata/plate_1.png", b"old")
write("one.gcode.3mf", packed.getvalue())
done = call("one.gcode.3mf", "--thumbnail", "30x30,16x16/QOI,20x20", "-o", "some.gcode.3mf", "--stats", "report.json")
check(done.returncode == 0 and "not written: 16x16/QOI, 20x20/PNG" in done.stderr.decode(),
      f"pictures that a container has no place for: {done.stderr.decode().strip()[-200:]}")
check(json.loads(read("report.json"))["left_out"] == ["16x16/QOI", "20x20/PNG"], "  and in the report")
refused(["bare.gcode.3mf", "--thumbnail", "30x30", "-o", "refused.3mf"], 3, "has no Metadata/plate_1.png to replace")
check(not os.path.exists(path("refused.3mf")), "  leaves no file behind")

# --- PrusaSlicer's own eyes -------------------------------------------------------------------------------------------


ORANGE = bytes((56, 125, 255))  # of an external perimeter in the legend: blue, green, red


def shown(viewers, seconds):
    """The screens, once both have a legend and rest."""
    end, before, rests = time.monotonic() + seconds, None, 0
    while time.monotonic() < end and rests < 4:
        time.sleep(2)
        screens = [viewer.screen() for viewer in viewers]
        ready = all(screen.count(ORANGE) > 100 for screen in screens)
        rests = rests + 1 if ready and screens == before else 0
        before = screens
    return before if rests == 4 else None


if all(shutil.which(program) for program in PROGRAMS):
    # Three layers and the end: it draws all of a print again and again, by the processor.
    layers = TEXT.split(b";LAYER_CHANGE")
    write("before.gcode", b";LAYER_CHANGE".join([*layers[:4], layers[-1]]))
    pictured(path("before.gcode"), SIZES, "after.gcode")
    # It shows the number of the last line: there are as many lines without the pictures.
    with open(path("before.gcode"), "rb") as file, open(path("after.gcode"), "rb") as pictures:
        first, rest = file.read().split(b"\n", 1)
        more = pictures.read().count(b"\n") - rest.count(b"\n") - 1
    write("before.gcode", first + b"\n" + b";\n" * more + rest)
    locale = make_locale(FOLDER)
    viewers = [Preview(path(name), locale) for name in ("before.gcode", "after.gcode")]
    try:
        screens = shown(viewers, 150)
        check(screens is not None, "PrusaSlicer's viewer opens the file with and without our pictures")
        check(screens[0] == screens[1], "  and shows the same print, times and weights")
    finally:
        for viewer in viewers:
            viewer.close()
else:
    print("skipped: prusa-gcodeviewer, Xvfb or localedef is not there")

shutil.rmtree(FOLDER)
sys.exit(0)
