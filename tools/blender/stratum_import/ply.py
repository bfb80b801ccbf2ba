"""Binary PLY, as gcode2vdb writes it, into arrays."""

import numpy

TYPES = {"float": "<f4", "uchar": "u1", "int": "<i4", "uint": "<u4", "ushort": "<u2", "double": "<f8"}


class PolygonMesh:
    """points: float32, (n, 3). colors: uint8 sRGB, (n, 3), or None. corners: uint32, the points of all faces, one face
    after the other, counter-clockwise from outside. sizes: int32, the corners of each face, 3 or 4."""

    def __init__(self, points, colors, corners, sizes):
        self.points, self.colors, self.corners, self.sizes = points, colors, corners, sizes

    def starts(self):
        """Of each face, its first place in corners."""
        starts = numpy.zeros(len(self.sizes), numpy.int32)
        numpy.cumsum(self.sizes[:-1], out=starts[1:])
        return starts


def read_ply(path):
    """The PolygonMesh of a file. Raises ValueError if it isn't laid out as gcode2vdb does it."""
    with open(path, "rb") as file:
        data = file.read()
    head, mark, _ = data.partition(b"end_header\n")
    if not mark:
        raise ValueError(f"{path}: no PLY header")
    counts, fields = {}, []
    element = ""
    for words in (line.split() for line in head.decode("ascii").splitlines()):
        if words[0] == "format" and words[1] != "binary_little_endian":
            raise ValueError(f"{path}: {words[1]} PLY; binary_little_endian is read")
        if words[0] == "element":
            element = words[1]
            counts[element] = int(words[2])
        elif words[0] == "property" and element == "vertex":
            fields.append((words[2], TYPES[words[1]]))
    vertices = numpy.frombuffer(data, numpy.dtype(fields), counts["vertex"], len(head) + len(mark))
    points = numpy.stack([vertices[axis] for axis in "xyz"], axis=1)
    colors = None
    if "red" in vertices.dtype.names:
        colors = numpy.stack([vertices[name] for name in ("red", "green", "blue")], axis=1)
    corners, sizes = _read_faces(data, len(head) + len(mark) + vertices.nbytes, counts["face"], path)
    return PolygonMesh(points, colors, corners, sizes)


def _read_faces(data, offset, count, path):
    """Faces are a byte, 3 or 4, and as many uint32. They come in long runs of a kind, taken a run at a time."""
    data = numpy.frombuffer(data, numpy.uint8)
    corners, sizes = [], []
    while count > 0:
        size = int(data[offset]) if offset < len(data) else 0
        length = 1 + 4 * size
        if size < 3 or offset + length > len(data):
            raise ValueError(f"{path}: its faces end too early")
        most = min(count, (len(data) - offset) // length)
        run = 1
        while run < most:  # doubling, so that a short run costs little
            step = data[offset + run * length : offset + min(2 * run, most) * length : length]
            others = numpy.flatnonzero(step != size)
            run += int(others[0]) if len(others) else len(step)
            if len(others):
                break
        records = data[offset : offset + run * length].reshape(run, length)
        corners.append(numpy.ascontiguousarray(records[:, 1:]).view("<u4").ravel())
        sizes.append(numpy.full(run, size, numpy.int32))
        offset += run * length
        count -= run
    if not sizes:
        return numpy.zeros(0, numpy.uint32), numpy.zeros(0, numpy.int32)
    return numpy.concatenate(corners), numpy.concatenate(sizes)
