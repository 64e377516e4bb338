"""Heat equation in a cube, with NumPy and perhaps mpi4py: python3 heat.py --serve, mpirun -n 2 python3 heat.py --mpi --serve"""
import numpy

import ghostspace_insitu
from options import communicator, parse, session_options

options = parse(__doc__, 64)
comm, rank, ranks = communicator(options)
nobody = __import__("mpi4py.MPI").MPI.PROC_NULL if comm else None
n = options.size
first, end = n * rank // ranks, n * (rank + 1) // ranks
z, y, x = numpy.meshgrid(numpy.arange(first - 1, end + 1) / n, numpy.arange(n) / n, numpy.arange(n) / n, indexing="ij")
u = 100 * numpy.exp(-60 * ((x - 0.35) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2))
if rank == 0:
    u[0] = 0
if rank == ranks - 1:
    u[-1] = 0
session = ghostspace_insitu.Session(comm=comm, parameters=[ghostspace_insitu.Parameter(
    "diffusivity", 0, 0.16, 0.1, label="Diffusivity")], log=print, **session_options(options, "heat equation"))
with session:
    if options.serve and rank == 0:
        print("ghostspace --follow http://127.0.0.1:%d/" % session.port, flush=True)
    for step in range(options.steps):
        if session.begin_step(step, float(step)):
            session.block({"temperature": u}, extent=(0, n - 1, 0, n - 1, first - 1, end),
                          whole_extent=(0, n - 1, 0, n - 1, 0, n - 1), spacing=(1 / n, 1 / n, 1 / n),
                          ghost=(0, 0, 0, 0, 1, 1), units={"temperature": "K"})
            session.end_step()
        a = session["diffusivity"]
        if comm:
            below, above = (rank - 1 if rank > 0 else nobody), (rank + 1 if rank < ranks - 1 else nobody)
            comm.Sendrecv(u[1].copy(), below, recvbuf=u[-1], source=above)
            comm.Sendrecv(u[-2].copy(), above, recvbuf=u[0], source=below)
        inner = u[1:-1, 1:-1, 1:-1]
        change = (u[2:, 1:-1, 1:-1] + u[:-2, 1:-1, 1:-1] + u[1:-1, 2:, 1:-1] + u[1:-1, :-2, 1:-1] + u[1:-1, 1:-1, 2:]
                  + u[1:-1, 1:-1, :-2] - 6 * inner)
        inner += a * change
    session.flush()
    print("rank %d: %s" % (rank, session.statistics))
