#!/usr/bin/env python3
"""Decodes a QNV stream of records, from FORMAT.md alone: prints the place, the normal and the palette's colour of every
vector, places in the space of the source.

    records_decode.py STREAM.qnv
"""
import math
import struct
import sys
import zlib

from streams import chunks


def sections_of(data, length):
    at = 108
    while at + 6 <= length:
        tag, size = struct.unpack_from("<HI", data, at)
        yield tag, data[at + 6:at + 6 + size]
        at += 6 + size


def main():
    data = open(sys.argv[1], "rb").read()
    version, kind, payload, length = struct.unpack_from("<HBBI", data, 8)
    if data[:8] != b"\x89QNV\r\n\x1a\n" or version not in (1, 2) or payload != 0:
        sys.exit("no stream of records")
    if zlib.crc32(data[:16] + bytes(4) + data[20:length]) != struct.unpack_from("<I", data, 16)[0]:
        sys.exit("a damaged header")
    origin, palette = (0.0, 0.0, 0.0), []
    for tag, section in sections_of(data, length):
        if tag == 1:
            palette = [tuple(section[i:i + 3]) for i in range(0, len(section) - 2, 3)]
        if tag == 7 and version == 2:
            origin = struct.unpack_from("<3d", section)
    for body in chunks(data, length, 0):
        lower, cell = struct.unpack_from("<3f", body, 16), struct.unpack_from("<3f", body, 28)
        for i in range(48, len(body) - 7, 8):
            (word,) = struct.unpack_from("<Q", body, i)
            place = [o + l + (2 * (word >> shift & 1023) + 1) * c / 2
                     for o, l, c, shift in zip(origin, lower, cell, (0, 10, 20))]
            t, f = ((word >> 30 & 31) + 0.5) / 32 * math.pi, ((word >> 35 & 63) + 0.5) / 64 * 2 * math.pi
            normal = (math.sin(t) * math.cos(f), math.sin(t) * math.sin(f), math.cos(t))
            color = palette[word >> 56] if word >> 56 < len(palette) else struct.unpack_from("<3B", data, 22)
            print(*("%.17g" % x for x in place), *("%.6f" % x for x in normal), *color)


main()
