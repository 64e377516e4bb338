#!/usr/bin/env python3
"""draw_icons.py FOLDER: draws the program's icon into a folder with the layout of a freedesktop icon theme
(hicolor/SIZExSIZE/apps/NAME.png and hicolor/scalable/apps/NAME.svg). One description, below, gives all sizes.
Needs only Python."""
import math
import os
import struct
import sys
import zlib

NAME = 'org.ghostspace.GhostSpace'
SIZES = (16, 22, 24, 32, 48, 64, 128, 256, 512)

# Drawing: polygons in a square of side 64, lowest polygon first. Each has a gradient from its top to its bottom, given
# as (red, green, blue, opacity from 0 to 1) for both ends.


def arc(cx, cy, rx, ry, begin, end, steps=48):
    angles = [math.radians(begin + (end - begin) * i / steps) for i in range(steps + 1)]
    return [(cx + rx * math.cos(a), cy - ry * math.sin(a)) for a in angles]


def rounded(x0, y0, x1, y1, r):
    return (arc(x1 - r, y0 + r, r, r, 90, 0, 12) + arc(x1 - r, y1 - r, r, r, 0, -90, 12)
            + arc(x0 + r, y1 - r, r, r, -90, -180, 12) + arc(x0 + r, y0 + r, r, r, 180, 90, 12))


def turned(points, degrees, cx=32, cy=32):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(cx + (x - cx) * c - (y - cy) * s, cy + (x - cx) * s + (y - cy) * c) for x, y in points]


def ring(begin, end):
    """Returns a part of the orbit around the ghost: a band between two tilted ellipses."""
    outer = arc(32, 37, 28.5, 8.6, begin, end)
    inner = arc(32, 36.8, 26.0, 6.6, end, begin)
    return turned(outer + inner, -14)


def ghost():
    """Returns the outline of the ghost: round at the top, with three waves at the bottom."""
    hem = [(46 - 28 * t / 60, 52 + 2.4 * math.cos(math.radians(t / 60 * 1080))) for t in range(61)]
    return arc(32, 26, 14, 14, 180, 0) + hem


DRAWING = (
    (rounded(1, 1, 63, 63, 14), (0.11, 0.12, 0.30, 1), (0.80, 0.42, 0.38, 1)),
    (ring(0, 180), (1.0, 0.80, 0.50, 0.75), (1.0, 0.80, 0.50, 0.75)),
    (ghost(), (1.0, 1.0, 1.0, 1), (0.74, 0.82, 0.96, 1)),
    (arc(26.8, 27, 2.6, 3.9, 0, 360), (0.11, 0.12, 0.30, 1), (0.11, 0.12, 0.30, 1)),
    (arc(37.2, 27, 2.6, 3.9, 0, 360), (0.11, 0.12, 0.30, 1), (0.11, 0.12, 0.30, 1)),
    (ring(180, 360), (1.0, 0.86, 0.56, 1), (1.0, 0.74, 0.40, 1)),
    (arc(10.5, 44.2, 3.4, 3.4, 0, 360), (1.0, 0.93, 0.75, 1), (1.0, 0.72, 0.42, 1)),
)


def svg():
    lines = ['<?xml version="1.0" encoding="UTF-8"?>',
             '<svg xmlns="http://www.w3.org/2000/svg" width="64" height="64" viewBox="0 0 64 64">', ' <defs>']
    paths = []
    for i, (points, top, end) in enumerate(DRAWING):
        stops = ''.join('<stop offset="%d" stop-color="#%02x%02x%02x" stop-opacity="%g"/>' %
                        ((at,) + tuple(round(255 * c) for c in color[:3]) + (color[3],))
                        for at, color in ((0, top), (1, end)))
        lines.append('  <linearGradient id="g%d" x1="0" y1="0" x2="0" y2="1">%s</linearGradient>' % (i, stops))
        paths.append(' <path fill="url(#g%d)" d="M%sZ"/>' % (i, ' '.join('%.2f,%.2f' % p for p in points)))
    return '\n'.join(lines + [' </defs>'] + paths + ['</svg>']) + '\n'


def cover(points, size, rows_a_pixel=4):
    """Returns the coverage of each pixel by a polygon, as rows of (first column, shares)."""
    scale = size / 64
    polygon = [(x * scale, y * scale) for x, y in points]
    edges = list(zip(polygon, polygon[1:] + polygon[:1]))
    first = max(0, math.floor(min(y for _, y in polygon)))
    last = min(size - 1, math.ceil(max(y for _, y in polygon)))
    for row in range(first, last + 1):
        shares = [0.0] * size
        for part in range(rows_a_pixel):
            y = row + (part + 0.5) / rows_a_pixel
            crossings = sorted(x0 + (y - y0) / (y1 - y0) * (x1 - x0)
                               for (x0, y0), (x1, y1) in edges if (y0 <= y) != (y1 <= y))
            for begin, end in zip(crossings[::2], crossings[1::2]):
                begin, end = max(0.0, begin), min(float(size), end)
                for column in range(int(begin), min(size, math.ceil(end))):
                    shares[column] += max(0.0, min(end, column + 1) - max(begin, column)) / rows_a_pixel
        yield row, shares


def png(size):
    image = [[(0.0, 0.0, 0.0, 0.0)] * size for _ in range(size)]
    for points, top, end in DRAWING:
        low, high = min(y for _, y in points), max(y for _, y in points)
        for row, shares in cover(points, size):
            t = min(1.0, max(0.0, ((row + 0.5) * 64 / size - low) / (high - low)))
            color = [a + (b - a) * t for a, b in zip(top, end)]
            line = image[row]
            for column, share in enumerate(shares):
                if share <= 0:
                    continue
                alpha = color[3] * min(1.0, share)
                r, g, b, a = line[column]
                line[column] = (r * (1 - alpha) + color[0] * alpha, g * (1 - alpha) + color[1] * alpha,
                                b * (1 - alpha) + color[2] * alpha, a * (1 - alpha) + alpha)
    raw = bytearray()
    for line in image:
        raw.append(0)
        for r, g, b, a in line:
            share = 255 / a if a > 0 else 0
            raw += bytes((round(min(255, r * share)), round(min(255, g * share)), round(min(255, b * share)), round(255 * min(1, a))))

    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))

    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', size, size, 8, 6, 0, 0, 0))
            + chunk(b'IDAT', zlib.compress(bytes(raw), 9)) + chunk(b'IEND', b''))


def write(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'wb') as file:
        file.write(data)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    theme = os.path.join(sys.argv[1], 'hicolor')
    write(os.path.join(theme, 'scalable', 'apps', NAME + '.svg'), svg().encode())
    for size in SIZES:
        write(os.path.join(theme, '%dx%d' % (size, size), 'apps', NAME + '.png'), png(size))


main()
