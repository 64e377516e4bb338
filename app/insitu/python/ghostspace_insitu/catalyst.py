"""Adaptor for codes with ParaView Catalyst: a script that they load instead of a script of ParaView.

    export PYTHONPATH=/usr/local/lib/python3/dist-packages
    export GHOSTSPACE_CATALYST="serve=1 port=8123 max_share=0.02"
    python3 -m paraview.demos.wavelet_miniapp -s /usr/local/lib/python3/dist-packages/ghostspace_insitu/catalyst.py
    ghostspace http://127.0.0.1:8123/

GHOSTSPACE_CATALYST has options of ghostspace_insitu.Session; without it, the script serves on any free port and prints it.
The simulation makes its grids only for steps that the library takes. Under MPI, mpi4py must be installed.
"""

import atexit
import os

import ghostspace_insitu
from ghostspace_insitu.vtk import pass_dataset

_session = None
_decided = None  # step and time of the last decision, and whether the step is taken


def _options():
    options = {"title": "Catalyst", "serve": True}
    for word in os.environ.get("GHOSTSPACE_CATALYST", "").split():
        name, equals, value = word.partition("=")
        if not equals:
            raise ValueError("GHOSTSPACE_CATALYST: %r has no '='; expected NAME=VALUE with blanks between them" % word)
        if name in ("title", "folder", "bind", "token_file", "field"):
            options[name] = value
        elif name in ("error", "relative_error", "max_share"):
            options[name] = float(value)
        else:
            options[name] = int(value)
    return options


def _opened():
    global _session
    if _session is None:
        comm = None
        try:
            from mpi4py import MPI
            comm = MPI.COMM_WORLD if MPI.COMM_WORLD.size > 1 else None
        except ImportError:
            pass
        _session = ghostspace_insitu.Session(comm=comm, log=print, **_options())
        if _session.port:
            print("ghostspace http://127.0.0.1:%d/" % _session.port, flush=True)
    return _session


def RequestDataDescription(description):
    """Called by Catalyst before each step: asks for all arrays if the library takes the step."""
    global _decided
    now = (description.GetTimeStep(), description.GetTime())
    if _decided is None or _decided[:2] != now:  # Catalyst asks twice for each step
        _decided = now + (_opened().begin_step(*now),)
    wanted = _decided[2]
    for i in range(description.GetNumberOfInputDescriptions()):
        channel = description.GetInputDescription(i)
        if wanted:
            channel.AllFieldsOn()
            channel.GenerateMeshOn()
        else:
            channel.AllFieldsOff()
            channel.GenerateMeshOff()


def DoCoProcessing(description):
    """Called by Catalyst with the grids of a step."""
    session = _opened()
    for i in range(description.GetNumberOfInputDescriptions()):
        channel = description.GetInputDescription(i)
        extent = channel.GetWholeExtent()
        pass_dataset(session, channel.GetGrid(), extent if extent[0] <= extent[1] else None)
    session.end_step()


def Finalize():
    """Called by Catalyst at the end."""
    global _session
    if _session is not None:
        _session.close()
        _session = None


atexit.register(Finalize)  # some versions of Catalyst do not call it
