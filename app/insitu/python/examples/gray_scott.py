"""Gray-Scott reaction in a periodic cube, with NumPy: python3 gray_scott.py --serve"""
import numpy

import ghostspace_insitu
from options import parse, session_options

options = parse(__doc__, 48)
n = options.size
u, v = numpy.ones((n, n, n)), numpy.zeros((n, n, n))
middle = slice(3 * n // 8, 5 * n // 8)
u[middle, middle, middle], v[middle, middle, middle] = 0.5, 0.25


def laplacian(a):
    return sum(numpy.roll(a, shift, axis) for axis in range(3) for shift in (-1, 1)) / 6 - a


parameters = [ghostspace_insitu.Parameter("feed", 0, 0.1, 0.02, label="Feed rate"),
              ghostspace_insitu.Parameter("kill", 0, 0.1, 0.048, label="Kill rate")]
with ghostspace_insitu.Session(parameters=parameters, log=print, **session_options(options, "Gray-Scott")) as session:
    if options.serve:
        print("ghostspace --follow http://127.0.0.1:%d/" % session.port, flush=True)
    for step in range(options.steps):
        if session.begin_step(step, float(step)):
            session.block({"V": v, "U": u})
            session.end_step()
        feed, kill = session["feed"], session["kill"]
        reaction = u * v * v
        u += 0.2 * laplacian(u) - reaction + feed * (1 - u)
        v += 0.1 * laplacian(v) + reaction - (feed + kill) * v
    session.flush()
    print(session.statistics)
