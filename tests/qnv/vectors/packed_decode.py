#!/usr/bin/env python3
"""Decodes a packed QNV stream, from FORMAT.md alone: prints level, x, y, z, u, v, o, double, Y, Co, Cg of every voxel that
is shown (Y, Co, Cg are 0 where there are no colours).

    packed_decode.py STREAM.qnv
"""
import struct
import sys

from residuals import Rans, clamp
from streams import chunks, normal, sign, wrap

OCCUPANCY = [[int(n) for n in row.split()] for row in """
    4 4 4 4 4 4 4 4 4 4 4 4 4 4 4 85 3256 4090 4092 4092 4092 4092 4092 4092
    6 6 6 6 6 6 6 6 6 6 6 6 6 6 14 293 2609 3996 4090 4090 4090 4090 4090 4090
    8 8 8 8 8 8 8 8 8 8 8 8 8 11 90 628 2428 3773 4053 4088 4088 4088 4088 4088
    16 16 16 16 16 16 16 16 16 16 16 16 16 64 246 836 2076 3297 3862 4035 4080 4080 4080 4080
    40 40 40 40 40 40 40 40 40 40 40 41 99 234 528 1087 1920 2798 3442 3800 3970 4043 4056 4056
    100 100 100 100 100 100 100 100 100 100 111 192 327 545 873 1324 1874 2450 2967 3369 3650 3831 3941 3996
    300 300 300 300 300 300 300 300 300 300 393 535 718 947 1223 1540 1885 2239 2583 2897 3169 3394 3574 3713
    800 800 800 800 800 800 800 858 969 1089 1218 1356 1502 1653 1809 1968 2128 2287 2443 2594 2740 2878 3007 3127
""".strip().splitlines()]


def along(n, c):
    return sum(n[a] if c >> a & 1 else -n[a] for a in range(3))


class Voxel:
    def __init__(self, x, y, z):
        self.place = (x, y, z)
        self.u = self.v = self.o = 0
        self.activity, self.double = 3, 0
        self.color = [128, 0, 0]


def neighbour_differences(voxel, places):
    """(a, b, k) for the faces -x, +x, -y, +y, -z, +z."""
    out = []
    for face in range(6):
        axis, side = face // 2, face % 2
        at = list(voxel.place)
        at[axis] += 1 if side else -1
        other = places.get(tuple(at))
        if other is None or other.double or voxel.double or any(p >> 5 != q >> 5 for p, q in zip(at, voxel.place)):
            out.append((0, 0, 0))
            continue
        images = [(other.u - voxel.u, other.v - voxel.v),
                  (2048 * sign(other.u) - other.u - voxel.u, -other.v - voxel.v),
                  (-other.u - voxel.u, 2048 * sign(other.v) - other.v - voxel.v)]
        a, b = min(images, key=lambda image: abs(image[0]) + abs(image[1]))  # the first of equal ones
        if abs(a) + abs(b) > 700:
            out.append((0, 0, 0))
            continue
        n = normal(other.u, other.v)[axis]
        out.append((a, b, 2 * (other.o - voxel.o) + ((n if side else -n) >> 3)))
    return out


def divide(rans, voxels, first, count, p):
    run = voxels[first:first + count]
    places = {voxel.place: voxel for voxel in voxels}
    masks = []
    for parent in run:
        n, mask = normal(parent.u, parent.v), 0
        for c in range(8):
            b = clamp((3072 - abs(along(n, c) - 64 * parent.o)) >> 7, 0, 23)
            mask |= rans.bit(c, OCCUPANCY[p["occupancy"]][b]) << c
        if mask == 0:
            sys.exit("a divided voxel without a child")
        masks.append(mask)
    children, out = [], []
    for parent, mask in zip(run, masks):
        around = neighbour_differences(parent, places)
        for c in range(8):
            if not mask >> c & 1:
                continue
            x, y, z = parent.place
            child = Voxel(2 * x + (c & 1), 2 * y + (c >> 1 & 1), 2 * z + (c >> 2))
            f = [2 * a + (c >> a & 1) for a in range(3)]
            u, v = parent.u, parent.v
            if p["normals"]:
                u += (sum(3 * around[i][0] - around[i ^ 1][0] for i in f) + 8) >> 4
                v += (sum(3 * around[i][1] - around[i ^ 1][1] for i in f) + 8) >> 4
                u, v = wrap(u, v)
            if p["offsets"]:
                o = 2 * parent.o - ((32 * along(normal(u, v), c) + 512) >> 10) + ((sum(around[i][2] for i in f) + 2) >> 2)
            else:
                o = 2 * parent.o - ((32 * along(normal(parent.u, parent.v), c) + 512) >> 10)
            child.u, child.v, child.o = u, v, clamp(o, -32, 32)
            children.append((parent, c))
            out.append(child)
    if p["doubles"]:
        for i, child in enumerate(out):
            child.double = rans.bit(i % 8, 512)
        for i, (child, (parent, c)) in enumerate(zip(out, children)):
            if parent.double and not child.double and rans.bit(i % 8, 2048):
                u, v = -sign(parent.u) * (1024 - abs(parent.v)), -sign(parent.v) * (1024 - abs(parent.u))
                child.u, child.v = u, v
                child.o = clamp(-2 * parent.o - ((32 * along(normal(u, v), c) + 512) >> 10), -32, 32)
    contexts = [min(2, parent.activity) for parent, _ in children]
    models = [p["normal"][k] for k in contexts]
    du, dv = rans.residuals(models), rans.residuals(models)
    for child, a, b in zip(out, du, dv):
        child.u, child.v = wrap(child.u + (a << p["normal_shift"]), child.v + (b << p["normal_shift"]))
        child.activity = min(3, max(abs(a), abs(b)))
    for child, r in zip(out, rans.residuals([p["offset"][k] for k in contexts])):
        child.o = clamp(child.o + (r << p["offset_shift"]), -32, 32)
    if p["colored"]:
        channels = []
        for channel in range(3):
            residuals = rans.residuals([p["chroma" if channel else "luma"]] * len(out))
            shift = p["color_shift"] + (1 if channel else 0)
            channels.append([clamp(parent.color[channel] + (r << shift), -1024, 1024)
                             for (parent, _), r in zip(children, residuals)])
        for child, color in zip(out, zip(*channels)):
            child.color = list(color)
    else:
        for child in out:
            child.color = [0, 0, 0]
    return out


def main():
    data = open(sys.argv[1], "rb").read()
    if data[:8] != b"\x89QNV\r\n\x1a\n" or data[11] != 1:
        sys.exit("no packed stream")
    (at,) = struct.unpack_from("<I", data, 12)
    clusters = {}
    for payload in chunks(data, at, 1):
        number, parent, first, count, level, times, flags, shifts = struct.unpack_from("<IIHHBBBB", payload)
        models = int.from_bytes(payload[16:19], "little")
        four = [models >> 4 * i & 15 for i in range(6)]
        p = {"occupancy": flags & 7, "doubles": flags & 8, "colored": flags & 16, "normals": flags & 32,
             "offsets": flags & 64, "normal_shift": shifts & 15, "offset_shift": shifts >> 4 & 7, "normal": four[:3],
             "offset": four[3:], "luma": payload[19] & 15, "chroma": payload[19] >> 4, "color_shift": payload[20] & 7}
        rans = Rans(payload[22:])
        if parent == 0xFFFFFFFF:
            voxels = [Voxel(0, 0, 0)]
        else:
            voxels = clusters[parent][1]
            clusters[parent][2].update(range(first, first + count))
        for _ in range(times):
            voxels = divide(rans, voxels, first, count, p)
            first, count = 0, len(voxels)
        if not rans.even():
            sys.exit("cluster %d does not come out even" % number)
        clusters[number] = (level + times, voxels, set())
    for number in sorted(clusters):
        level, voxels, divided = clusters[number]
        for i, q in enumerate(voxels):
            if i not in divided:
                print(level, *q.place, q.u, q.v, q.o, 1 if q.double else 0, *q.color)


main()
