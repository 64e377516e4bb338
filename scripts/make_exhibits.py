#!/usr/bin/env python3
"""make_exhibits.py GHOSTSPACE FOLDER: computes the streams of the demo world and encodes them with GHOSTSPACE:
demo-pod.qnv, a surface; demo-orbital.qnv, a volume; demo-rock.qnv, outline groups; demo-bonsai.qnv, Gaussian splats.
Needs only Python."""
import math
import os
import random
import struct
import subprocess
import sys
import tempfile


def write_obj(path, vertices, faces):
    with open(path, 'w') as f:
        f.writelines('v %.5f %.5f %.5f\n' % v for v in vertices)
        f.writelines('f %s\n' % ' '.join(str(i + 1) for i in face) for face in faces)


def pod(path, rows=150, around=300):
    """Returns a closed seed pod: a ball with a long top, with grained ridges that wind around it."""
    def at(across, up):  # across: angle around the axis; up: 0 (bottom) to pi (top)
        wind = across + 1.1 * math.sin(up) - 0.5 * up
        ridges = abs(math.cos(4.5 * wind)) ** 0.7
        grain = math.sin(34 * up) * math.sin(36 * wind)
        radius = 0.62 * math.sin(up) ** 0.8 * (0.8 + 0.28 * ridges * math.sin(up)) + 0.012 * grain * math.sin(up) ** 2
        lip = 0.25 * math.exp(-((up - math.pi) / 0.35) ** 2)
        return radius * math.cos(across), 0.9 - 0.9 * math.cos(up) + lip, radius * math.sin(across)
    vertices = [at(2 * math.pi * j / around, math.pi * i / rows) for i in range(1, rows) for j in range(around)]
    below, above = len(vertices), len(vertices) + 1
    vertices += [at(0, 0), at(0, math.pi)]
    faces = []
    for j in range(around):
        k = (j + 1) % around
        faces.append((below, j, k))
        faces.append((above, (rows - 2) * around + k, (rows - 2) * around + j))
        for i in range(rows - 2):
            a, b = i * around + j, i * around + k
            faces.append((a, a + around, b + around, b))
    write_obj(path, vertices, faces)


def orbital(path, n=64, reach=24.0):
    """Returns the wave function of hydrogen's electron, n = 3, l = 2, m = 0, in Bohr radii. 128 means zero."""
    def wave(x, y, z):
        r = math.sqrt(x * x + y * y + z * z)
        return (3 * z * z - r * r) * math.exp(-r / 3)
    values = []
    for k in range(n):
        for j in range(n):
            for i in range(n):
                values.append(wave(*(((2 * c + 1) / n - 1) * reach for c in (i, j, k))))
    most = max(abs(v) for v in values)
    data = bytes(max(0, min(255, round(128 + 127 * math.copysign(abs(v / most) ** 0.7, v)))) for v in values)
    with open(path, 'wb') as f:
        f.write(('NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nspacings: %g %g %g\nencoding: raw\n\n'
                 % ((n, n, n) + (2 * reach / n,) * 3)).encode() + data)


def rock(path, n=26):
    """Returns basalt: hexagonal columns with flat tops, each as high as a hill at its position."""
    def hill(x, y):
        peaks = ((0, 0, 1.0, 0.34), (-0.42, 0.25, 0.55, 0.22), (0.45, -0.2, 0.62, 0.2), (0.2, 0.55, 0.3, 0.18))
        high = max(h * math.exp(-((x - a) ** 2 + (y - b) ** 2) / (2 * s * s)) for a, b, h, s in peaks)
        noise = math.sin(127.1 * x + 311.7 * y) * 43758.5453
        return high + 0.16 * ((noise - math.floor(noise)) - 0.5) * min(1, 3 * high) - 0.05
    vertices, faces = [], []
    step = 2 / n * 1.5
    for row in range(-n, n + 1):
        for column in range(-n, n + 1):
            x, y = step * (column + 0.5 * (row % 2)), step * 0.866 * row
            high = hill(x, y)
            if x * x + y * y > 1.3 or high < 0.02:
                continue
            corners = [(x + step * 0.5774 * math.sin(math.pi / 3 * k), y + step * 0.5774 * math.cos(math.pi / 3 * k))
                       for k in range(6)]
            lean = 0.03 * math.sin(7 * x + 5 * y)
            top = [(a, high + lean * (a - x) / step, -b) for a, b in reversed(corners)]
            foot = [(a, -0.05, -b) for a, b in reversed(corners)]
            for face in [top] + [[foot[k], foot[(k + 1) % 6], top[(k + 1) % 6], top[k]] for k in range(6)]:
                faces.append(tuple(range(len(vertices), len(vertices) + len(face))))  # own vertices, for sharp edges
                vertices += face
    write_obj(path, vertices, faces)


def unit(v):
    length = math.sqrt(sum(c * c for c in v)) or 1
    return tuple(c / length for c in v)


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def along(a, v, t):
    return tuple(p + q * t for p, q in zip(a, v))


def turn_of(tangent, normal):
    """Returns the rotation of x to the tangent and of z to the normal, as a quaternion w, x, y, z."""
    n = unit(normal)
    t = unit(along(tangent, n, -dot(tangent, n)))
    b = cross(n, t)
    m = [[t[i], b[i], n[i]] for i in range(3)]
    trace = m[0][0] + m[1][1] + m[2][2]
    if trace > 0:
        w = math.sqrt(1 + trace) / 2
        return w, (m[2][1] - m[1][2]) / (4 * w), (m[0][2] - m[2][0]) / (4 * w), (m[1][0] - m[0][1]) / (4 * w)
    i = max(range(3), key=lambda k: m[k][k])
    j, k = (i + 1) % 3, (i + 2) % 3
    q = [0.0] * 3
    q[i] = math.sqrt(max(0, 1 + m[i][i] - m[j][j] - m[k][k])) / 2
    q[j], q[k] = (m[j][i] + m[i][j]) / (4 * q[i]), (m[k][i] + m[i][k]) / (4 * q[i])
    return ((m[k][j] - m[j][k]) / (4 * q[i]), *q)


class Splats:
    """Gaussian splats with harmonics of degree 1, lit by the sun and the sky of the demo world. Y is up."""
    SUN, SKY = unit((0.8, 0.4, 0.28)), unit((-0.5, 0.6, 0.5))

    def __init__(self):
        self.rows = []

    def lit(self, albedo, normal, wrap=0.35, open_sky=1.0):
        """Returns the light that a soft surface reflects. `open_sky` is the share of the sky that it sees."""
        sun = max(0, (dot(normal, self.SUN) + wrap) / (1 + wrap)) * open_sky
        sky = max(0, (dot(normal, self.SKY) + 1) / 2) * open_sky
        light = (0.20 + 1.0 * sun + 0.20 * sky, 0.19 + 0.74 * sun + 0.23 * sky, 0.24 + 0.48 * sun + 0.36 * sky)
        return tuple(a * l for a, l in zip(albedo, light))

    def add(self, place, scales, tangent, normal, opacity, color, gloss=0.0, toward=(0, 1, 0)):
        """Adds a splat. It is brighter by `gloss` for a viewer in the direction `toward`, and darker from behind."""
        self.rows.append((place, scales, turn_of(tangent, normal), opacity, color, gloss, unit(toward)))

    def write(self, path):
        """Writes a PLY file of 3DGS, with x to the right, y down and z forward."""
        names = ['x', 'y', 'z', 'f_dc_0', 'f_dc_1', 'f_dc_2'] + ['f_rest_%d' % i for i in range(9)] + [
            'opacity', 'scale_0', 'scale_1', 'scale_2', 'rot_0', 'rot_1', 'rot_2', 'rot_3']
        with open(path, 'wb') as f:
            f.write(('ply\nformat binary_little_endian 1.0\nelement vertex %d\n' % len(self.rows) +
                     ''.join('property float %s\n' % name for name in names) + 'end_header\n').encode())
            for (x, y, z), scales, (w, i, j, k), opacity, color, gloss, to in self.rows:
                rest = [-gloss * to[1] / 0.4886, gloss * to[2] / 0.4886, gloss * to[0] / 0.4886]
                f.write(struct.pack(
                    '<23f', x, -y, -z, *((c - 0.5) / 0.28209479 for c in color), *(rest * 3),
                    math.log(opacity / (1 - opacity)), *(math.log(s) for s in scales), w, i, -j, -k))


def bonsai(path):
    """Returns a small tree in a glazed pot, with blossoms, in thin mist. It stands at 0 0 0 and is 1.2 high."""
    chance = random.Random(4)
    splats = Splats()
    jitter = lambda size: tuple(chance.gauss(0, size) for _ in range(3))

    def pot():
        def rim(angle, wide):
            c, s = math.cos(angle), math.sin(angle)
            power = (abs(c) ** 3 + abs(s) ** 3) ** (-1 / 3)
            return 0.33 * wide * power * c, 0.22 * wide * power * s
        for _ in range(2600):
            angle, up = chance.uniform(0, 2 * math.pi), chance.random() ** 0.8
            wide = 0.86 + 0.14 * up ** 1.5 + (0.05 if up > 0.88 else 0)
            x, z = rim(angle, wide)
            ahead = rim(angle + 0.01, wide)
            tangent = unit((ahead[0] - x, 0, ahead[1] - z))
            normal = unit(along(cross((0, 1, 0), tangent), (0, 1, 0), -0.25))
            normal = normal if dot(normal, (x, 0, z)) > 0 else unit(along(cross(tangent, (0, 1, 0)), (0, 1, 0), -0.25))
            glaze = 0.10 + 0.05 * math.sin(9 * angle + 5 * up) + chance.gauss(0, 0.012)
            color = splats.lit((0.10, 0.22 + glaze, 0.42 + glaze), normal, 0.1, 0.5 + 0.5 * up)
            half = unit(along(splats.SUN, normal, 0.8))
            splats.add((x, 0.03 + 0.15 * up, z), (0.017, 0.010, 0.002), tangent, normal, 0.95, color,
                       0.22 * max(0.1, dot(normal, splats.SUN)), half)
        for _ in range(1500):  # moss
            angle, far = chance.uniform(0, 2 * math.pi), math.sqrt(chance.random()) * 0.97
            x, z = rim(angle, far)
            y = 0.165 + 0.075 * (1 - far * far) + 0.008 * math.sin(40 * x) * math.sin(46 * z)
            normal = unit(along((0.35 * x, 1, 0.35 * z), jitter(0.25), 1))
            shade = 0.5 + 0.5 * min(1, math.hypot(x, z) / 0.2)
            color = splats.lit((0.20 + chance.uniform(0, 0.14), 0.36 + chance.uniform(0, 0.16), 0.10), normal, 0.4, shade)
            splats.add((x, y, z), (0.013, 0.011, 0.006), jitter(1), normal, 0.9, color)

    def spine(up):
        bend = 0.16 * math.sin(4.4 * up) * (1 - 0.35 * up)
        return bend, 0.20 + 0.78 * up, 0.07 * math.sin(3.2 * up + 0.6)

    def wood(curve, thick, count, bark):
        for _ in range(count):
            at, angle = chance.random(), chance.uniform(0, 2 * math.pi)
            place, ahead = curve(at), curve(at + 0.01)
            tangent = unit(along(ahead, place, -1))
            side = unit(cross(tangent, (0.3, 0.2, 1)))
            other = cross(side, tangent)
            normal = unit(along(tuple(c * math.cos(angle) for c in side), other, math.sin(angle)))
            radius = thick(at)
            groove = 0.8 + 0.35 * math.sin(7 * angle + 26 * at) * math.sin(31 * at + 2 * angle) + chance.gauss(0, 0.08)
            color = splats.lit(tuple(max(0.02, b * groove) for b in bark), normal, 0.2, 0.6)
            splats.add(along(place, normal, radius), (0.45 * radius + 0.012, 0.22 * radius + 0.004, 0.003),
                       along(tangent, jitter(0.15), 1), normal, 0.93, color)

    def pad(center, size):
        wide, high, deep = 0.25 * size, 0.10 * size, 0.22 * size
        leaves = int(2100 * size * size)
        for _ in range(leaves // 14):  # twigs and shade inside
            at = tuple(c + r * v * 0.5 for c, r, v in zip(center, (wide, high * 0.8, deep), unit(jitter(1))))
            splats.add(at, (0.03 * size, 0.024 * size, 0.012 * size), jitter(1), along(jitter(0.2), (0, 1, 0), 1), 0.6,
                       splats.lit((0.06, 0.11, 0.05), (0, 1, 0), 0.4, 0.3))
        for _ in range(leaves):
            out = unit(jitter(1))
            far = chance.random() ** 0.28
            lump = 1 + 0.16 * math.sin(5 * out[0] + 3 * center[0] * 9) * math.sin(6 * out[2] + center[1] * 17)
            local = (wide * far * lump * out[0], high * far * lump * (out[1] if out[1] > 0 else 0.45 * out[1]),
                     deep * far * lump * out[2])
            bulge = unit((local[0] / wide ** 2, local[1] / high ** 2 + 2, local[2] / deep ** 2))
            normal = unit(along(bulge, jitter(0.55), 1))
            young = max(0, min(1, 0.45 + 0.55 * out[1] + chance.gauss(0, 0.26)))
            albedo = (0.13 + 0.30 * young, 0.30 + 0.34 * young, 0.08 + 0.06 * young)
            color = splats.lit(albedo, unit(along(normal, bulge, 1)), 0.5, 0.35 + 0.65 * far * (0.6 + 0.4 * out[1]))
            long = chance.uniform(0.013, 0.022) * (0.75 + 0.25 * size)
            splats.add(along(center, local, 1), (long, long * 0.5, 0.0012), along(local, jitter(0.1), 1), normal,
                       chance.uniform(0.7, 0.93), color, 0.05, tuple(-c for c in splats.SUN))  # leaves let light through
        for _ in range(int(13 * size)):  # blossoms
            out = unit(along(jitter(1), (0, 1, 0), 0.6))
            at = along(center, (wide * out[0], high * max(out[1], 0.1) * 1.1, deep * out[2]), 1)
            first = unit(cross(out, (0.2, 0.1, 1)))
            for petal in range(5):
                turn = 2 * math.pi * petal / 5
                toward = unit(along(tuple(c * math.cos(turn) for c in first), cross(out, first), math.sin(turn)))
                color = splats.lit((1.0, 0.62 + chance.uniform(0, 0.12), 0.72), unit(along(out, toward, 0.4)), 0.6)
                splats.add(along(at, toward, 0.013), (0.011, 0.008, 0.0015), toward, along(out, toward, -0.35), 0.9, color)
            splats.add(along(at, out, 0.004), (0.004, 0.004, 0.003), first, out, 0.95, (0.95, 0.75, 0.25))

    pot()
    thick = lambda at: 0.075 * (1 - at) ** 0.75 + 0.012 + 0.05 * math.exp(-at / 0.07)
    wood(spine, thick, 2600, (0.34, 0.24, 0.17))
    branches = ((0.36, 2.6, 0.36), (0.47, -0.5, 0.40), (0.58, 1.3, 0.30), (0.66, 3.6, 0.32), (0.76, 0.2, 0.26),
                (0.86, 2.2, 0.20), (0.93, 4.6, 0.18))
    for at, direction, reach in branches:
        start, over = spine(at), (math.cos(direction), 0, -math.sin(direction))
        curve = lambda t, start=start, over=over, reach=reach: (
            start[0] + over[0] * reach * t, start[1] + 0.16 * t * t - 0.05 * t, start[2] + over[2] * reach * t)
        wood(curve, lambda t: 0.020 * (1 - t) + 0.006, 260, (0.32, 0.22, 0.16))
        pad(along(curve(1.0), (0, 0.03, 0), 1), 0.62 + reach)
    pad(along(spine(1.0), (0, 0.05, 0), 1), 0.95)
    for _ in range(90):  # mist
        angle, far = chance.uniform(0, 2 * math.pi), 0.25 + 0.42 * chance.random()
        place = far * math.cos(angle), chance.uniform(-0.02, 0.22) * (1.2 - far), far * math.sin(angle)
        warm = 0.5 + 0.5 * dot(unit((place[0], 0, place[2])), splats.SUN)
        splats.add(place, (chance.uniform(0.08, 0.17), chance.uniform(0.06, 0.12), chance.uniform(0.02, 0.04)),
                   (-math.sin(angle), 0, math.cos(angle)), (0, 1, 0), chance.uniform(0.03, 0.07),
                   (0.55 + 0.25 * warm, 0.50 + 0.14 * warm, 0.62))
    splats.write(path)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    ghostspace, folder = sys.argv[1:]
    def encode(*arguments):
        subprocess.run([ghostspace, 'encode', *arguments], check=True)
    with tempfile.TemporaryDirectory() as made:
        at = lambda name: os.path.join(made, name)
        to = lambda name: os.path.join(folder, name)
        pod(at('pod.obj'))
        orbital(at('orbital.nrrd'))
        rock(at('rock.obj'))
        encode('--method', 'displaced', '--max-bytes', '40k', at('pod.obj'), to('demo-pod.qnv'))
        encode('--max-bytes', '64k', at('orbital.nrrd'), to('demo-orbital.qnv'))
        encode('--method', 'outlines', at('rock.obj'), to('demo-rock.qnv'))
        bonsai(at('bonsai.ply'))
        encode(at('bonsai.ply'), to('demo-bonsai.qnv'))


main()
