"""Particles on circles, without NumPy: python3 particles.py --serve"""
import array
import math

import ghostspace_insitu
from options import parse, session_options

options = parse(__doc__, 10)
count = options.size ** 3
radii = array.array("f", (0.3 + 3 * ((i + 0.5) * 0.8191725133961645 % 1) for i in range(count)))
phases = array.array("f", (math.tau * ((i + 0.5) * 0.6710436067037893 % 1) for i in range(count)))
heights = array.array("f", (0.4 * ((i + 0.5) * 0.5497004779019703 % 1) - 0.2 for i in range(count)))
speeds = array.array("f", (1 / math.sqrt(r) for r in radii))
positions = array.array("f", bytes(12 * count))
with ghostspace_insitu.Session(log=print, **session_options(options, "particles")) as session:
    if options.serve:
        print("ghostspace --follow http://127.0.0.1:%d/" % session.port, flush=True)
    for step in range(options.steps):
        for i in range(count):
            angle = phases[i] + 0.02 * step * speeds[i] / radii[i]
            positions[3 * i:3 * i + 3] = array.array(
                "f", (radii[i] * math.cos(angle), heights[i], radii[i] * math.sin(angle)))
        if session.begin_step(step, 0.02 * step):
            session.particles(positions, {"speed": speeds}, radius=0.03, units={"speed": "m/s"})
            session.end_step()
    session.flush()
    print(session.statistics)
