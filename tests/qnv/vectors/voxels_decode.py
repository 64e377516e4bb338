#!/usr/bin/env python3
"""Decodes a QNV stream of voxels, from FORMAT.md alone: prints level, x, y, z, u, v, c, m of every voxel that is shown.

    voxels_decode.py STREAM.qnv
"""
import struct
import sys

from residuals import Rans, clamp
from streams import chunks, normal, sign, wrap

S = [6, 9, 12, 14, 16, 20, 25, 32]
P = [int(n) for n in """
    2048 2176 2303 2428 2550 2668 2782 2891 2994 3092 3184 3269 3349 3422 3490 3551 3608 3659 3705 3747 3785 3819
    3850 3877 3902 3924 3943 3960 3976 3990 4002 4013 4022 4031 4038 4045 4051 4056 4061 4065 4069 4072 4075 4077
    4079 4081 4083 4085 4086 4087 4088 4089 4090 4091 4091 4092 4092 4093 4093 4093 4094 4094 4094 4094 4095
""".split()]
# Row: share of the direction, sibling; column: neither, other side, child's side, both.
ODDS = [
    [[-12, -15, 0, 14], [-15, -42, -8, -22], [-4, -9, 32, 38]],
    [[-7, -16, 8, 13], [-4, -35, 5, -3], [-13, -12, 26, 22]],
    [[3, -14, 18, 8], [2, -21, 17, 2], [-3, -15, 17, 11]],
]


def towards_zero(a, b):
    return a // b if a >= 0 else -(-a // b)


class Voxel:
    def __init__(self, x, y, z):
        self.x, self.y, self.z = x, y, z
        self.u = self.v = 0
        self.c, self.m = 128, 64
        self.turned = self.changed = 3
        self.around = [None] * 6

    def place(self):
        return (self.x, self.y, self.z)


def link(voxels):
    places = {voxel.place(): voxel for voxel in voxels}
    for voxel in voxels:
        for side in range(6):
            at = list(voxel.place())
            at[side // 2] += 1 if side % 2 else -1
            voxel.around[side] = places.get(tuple(at))


def expected_direction(parent, n, d, values, value, lengths, turn, trust):
    vector = [3 * p for p in n]
    for a in range(3):
        beside = parent.around[2 * a + (d >> a & 1)]
        if beside:
            m = normal(beside.u, beside.v)
            turned = -1 if sum(p * q for p, q in zip(m, n)) < 0 else 1
            vector = [p + turned * q for p, q in zip(vector, m)]
    if trust:
        norm = sum(abs(p) for p in vector)
        for a in range(3):
            sibling = values.get(d ^ 1 << a)
            if sibling is None:
                continue
            difference = value - sibling if d >> a & 1 else sibling - value
            seen = clamp(difference * ((turn << 8) // lengths[a]), -1024, 1024) * norm >> 10
            vector[a] += (seen - vector[a]) * trust >> 4
    norm = sum(abs(p) for p in vector)
    if norm == 0:
        return 0, 0
    u, v = towards_zero(vector[0] * 1024, norm), towards_zero(vector[1] * 1024, norm)
    return (u, v) if vector[2] >= 0 else (sign(u) * (1024 - abs(v)), sign(v) * (1024 - abs(u)))


def divide(rans, run, p, lengths):
    masks = []
    for parent in run:
        n, mask = normal(parent.u, parent.v), 0
        for d in range(8):
            odds = -12 + 2 * (p["bias"] - 16)
            for a in range(3):
                side = d >> a & 1
                share = 0 if abs(n[a]) < 200 else 1 if abs(n[a]) < 420 else 2
                sibling = 1 + (mask >> (d ^ 1 << a) & 1) if side else 0
                near, far = parent.around[2 * a + side] is not None, parent.around[2 * a + 1 - side] is not None
                odds += ODDS[share][sibling][2 * near + far]
            e = clamp(odds * S[p["steepness"]] >> 5, -64, 64)
            mask |= rans.bit(d, P[e] if e >= 0 else 4096 - P[-e]) << d
        if mask == 0:
            sys.exit("a divided voxel without a child")
        masks.append(mask)
    children = [(parent, d) for parent, mask in zip(run, masks) for d in range(8) if mask >> d & 1]
    out = [Voxel(2 * q.x + (d & 1), 2 * q.y + (d >> 1 & 1), 2 * q.z + (d >> 2)) for q, d in children]
    residuals = rans.residuals([p["value"][min(2, q.changed)] for q, _ in children])
    for (parent, d), voxel, q in zip(children, out, residuals):
        n = normal(parent.u, parent.v)
        along = sum((n[a] if d >> a & 1 else -n[a]) * lengths[a] for a in range(3))
        expected = clamp(parent.c + ((p["slope"] * along + (1 << 19)) >> 20), 0, 255)
        voxel.c, voxel.changed = clamp(expected + q * p["value_step"], 0, 255), min(3, abs(q))
    for (parent, _), voxel, q in zip(children, out, rans.residuals([p["magnitude"]] * len(children))):
        voxel.m = clamp(parent.m + q * p["magnitude_step"], 0, 127)
    models = [p["direction"][min(2, q.turned)] for q, _ in children]
    du, dv = rans.residuals(models), rans.residuals(models)
    values = {}
    for (parent, d), voxel in zip(children, out):
        values.setdefault(id(parent), {})[d] = voxel.c
    for i, ((parent, d), voxel) in enumerate(zip(children, out)):
        u, v = expected_direction(parent, normal(parent.u, parent.v), d, values[id(parent)], voxel.c, lengths,
                                  p["turn"], p["trust"])
        voxel.u, voxel.v = wrap(u + du[i] * 16 * p["direction_step"], v + dv[i] * 16 * p["direction_step"])
        voxel.turned = min(3, max(abs(du[i]), abs(dv[i])))
    link(out)
    return out


def main():
    data = open(sys.argv[1], "rb").read()
    if data[:8] != b"\x89QNV\r\n\x1a\n" or data[11] != 4:
        sys.exit("no stream of voxels")
    (length,) = struct.unpack_from("<I", data, 12)
    at, lengths = 108, None
    while at + 6 <= length:
        tag, size = struct.unpack_from("<HI", data, at)
        if tag == 6:
            lengths = struct.unpack_from("<3H", data, at + 6 + 66)
        at += 6 + size
    clusters = {}
    for payload in chunks(data, length, 5):
        number, parent, first, count, level, times = struct.unpack_from("<IIHHBB", payload)
        flags, value_step, direction_step, magnitude_step, slope, turn, models = struct.unpack_from("<6BI", payload, 14)
        four = [models >> 4 * i & 15 for i in range(8)]
        p = {"steepness": flags & 7, "bias": flags >> 3, "value_step": value_step, "direction_step": direction_step,
             "magnitude_step": magnitude_step, "slope": slope, "turn": turn, "direction": four[:3], "value": four[3:6],
             "magnitude": four[6], "trust": four[7]}
        rans = Rans(payload[24:])
        if parent == 0xFFFFFFFF:
            voxels = [Voxel(0, 0, 0)]
        else:
            voxels = clusters[parent][1][first:first + count]
            clusters[parent][2].update(range(first, first + count))
        for _ in range(times):
            voxels = divide(rans, voxels, p, lengths)
        if not rans.even():
            sys.exit("cluster %d does not come out even" % number)
        clusters[number] = (level + times, voxels, set())
    for number in sorted(clusters):
        level, voxels, divided = clusters[number]
        for i, q in enumerate(voxels):
            if i not in divided:
                print(level, q.x, q.y, q.z, q.u, q.v, q.c, q.m)


main()
