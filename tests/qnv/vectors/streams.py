"""What decoders of streams share: chunks, and normals in an octahedron, from FORMAT.md alone."""
import struct
import sys
import zlib

from residuals import clamp


def chunks(data, at, wanted):
    """Payloads of the chunks of type `wanted`, from byte `at`."""
    while at + 10 <= len(data):
        mark, size, kind, _, checksum = struct.unpack_from("<HHBBI", data, at)
        payload = data[at + 10:at + 10 + size]
        if mark != 0x4351 or zlib.crc32(data[at:at + 6] + payload) != checksum:
            sys.exit("a damaged chunk at byte %d" % at)
        at += 10 + size
        if kind == wanted:
            yield payload


def sign(v):
    return -1 if v < 0 else 1


def normal(u, v):
    w = 1024 - abs(u) - abs(v)
    return (u, v, w) if w >= 0 else (sign(u) * (1024 - abs(v)), sign(v) * (1024 - abs(u)), w)


def wrap(u, v):
    if abs(u) > 1024:
        u, v = 2048 * sign(u) - u, -v
    if abs(v) > 1024:
        v, u = 2048 * sign(v) - v, -u
    return clamp(u, -1024, 1024), clamp(v, -1024, 1024)
