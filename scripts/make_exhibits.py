#!/usr/bin/env python3
"""make_exhibits.py GHOSTSPACE FOLDER: computes the streams of the demo world and encodes them with GHOSTSPACE:
demo-pod.qnv, a surface; demo-orbital.qnv, a volume; demo-rock.qnv, outline groups. Needs only Python."""
import math
import os
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


main()
