"""GhostSpace in situ: a simulation in Python passes its arrays, and viewers see each step.

    import ghostspace_insitu

    with ghostspace_insitu.Session(serve=True, title="heat") as session:
        print("ghostspace --follow http://127.0.0.1:%d/" % session.port)
        for step in range(1000):
            if session.begin_step(step, step * dt):
                session.block({"temperature": u}, spacing=(h, h, h))
                session.end_step()
            u = advance(u)

Arrays are objects with the buffer protocol, such as arrays of NumPy, `array.array` and `memoryview`. They are not
copied, also if they are not contiguous. The module needs neither NumPy nor mpi4py. docs/insitu.md has more examples.
"""

import ctypes
import ctypes.util
import math
import os
import struct

__all__ = ["Error", "Parameter", "Session", "library_path"]

_OK, _SKIPPED = 1, 0
_POINTS, _CELLS = 0, 1
_FLOAT32, _FLOAT64, _INT32, _INT64 = 1, 2, 7, 9
# Types of the buffer protocol (struct): kind and size.
_TYPES = {("f", 4): 1, ("f", 8): 2, ("i", 1): 3, ("u", 1): 4, ("i", 2): 5, ("u", 2): 6, ("i", 4): 7, ("u", 4): 8,
          ("i", 8): 9, ("u", 8): 10}
_KINDS = {**dict.fromkeys("fd", "f"), **dict.fromkeys("bhilqn", "i"), **dict.fromkeys("BHILQN?", "u")}


class Error(Exception):
    """Failure of the library, with its message."""


class Parameter:
    """Parameter that viewers may change: a number from `minimum` to `maximum`."""

    def __init__(self, name, minimum, maximum, value, label=None, unit=None, integer=False):
        self.name, self.minimum, self.maximum, self.value = name, minimum, maximum, value
        self.label, self.unit, self.integer = label, unit, integer


class _Buffer(ctypes.Structure):
    """Py_buffer of the C interface of Python."""
    _fields_ = [("buf", ctypes.c_void_p), ("obj", ctypes.py_object), ("len", ctypes.c_ssize_t),
                ("itemsize", ctypes.c_ssize_t), ("readonly", ctypes.c_int), ("ndim", ctypes.c_int),
                ("format", ctypes.c_char_p), ("shape", ctypes.POINTER(ctypes.c_ssize_t)),
                ("strides", ctypes.POINTER(ctypes.c_ssize_t)), ("suboffsets", ctypes.POINTER(ctypes.c_ssize_t)),
                ("internal", ctypes.c_void_p)]


class _Field(ctypes.Structure):
    _fields_ = [("name", ctypes.c_char_p), ("unit", ctypes.c_char_p), ("data", ctypes.c_void_p),
                ("type", ctypes.c_int32), ("association", ctypes.c_int32), ("components", ctypes.c_int32),
                ("reserved", ctypes.c_int32), ("strides", ctypes.c_int64 * 4)]


class _Block(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("whole_extent", ctypes.c_int64 * 6), ("extent", ctypes.c_int64 * 6),
                ("origin", ctypes.c_double * 3), ("spacing", ctypes.c_double * 3), ("ghost", ctypes.c_int32 * 6),
                ("fields", ctypes.POINTER(_Field)), ("field_count", ctypes.c_size_t)]


class _Cells(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("points", ctypes.c_void_p), ("point_type", ctypes.c_int32),
                ("index_type", ctypes.c_int32), ("point_count", ctypes.c_size_t), ("connectivity", ctypes.c_void_p),
                ("connectivity_count", ctypes.c_size_t), ("offsets", ctypes.c_void_p), ("types", ctypes.c_void_p),
                ("cell_count", ctypes.c_size_t), ("ghosts", ctypes.c_void_p), ("fields", ctypes.POINTER(_Field)),
                ("field_count", ctypes.c_size_t)]


class _Particles(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("positions", ctypes.c_void_p), ("position_type", ctypes.c_int32),
                ("reserved", ctypes.c_int32), ("count", ctypes.c_size_t), ("radius", ctypes.c_double),
                ("fields", ctypes.POINTER(_Field)), ("field_count", ctypes.c_size_t)]


_Broadcast = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
_Gather = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,
                           ctypes.c_int)
_Barrier = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)
_Transfer = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int,
                             ctypes.c_int)
_Log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p)


class _Communicator(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("rank", ctypes.c_int32), ("ranks", ctypes.c_int32),
                ("context", ctypes.c_void_p), ("broadcast", _Broadcast), ("gather", _Gather), ("barrier", _Barrier),
                ("send", _Transfer), ("receive", _Transfer)]


class _Options(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("title", ctypes.c_char_p), ("folder", ctypes.c_char_p),
                ("serve", ctypes.c_int32), ("port", ctypes.c_int32), ("bind", ctypes.c_char_p),
                ("token_file", ctypes.c_char_p), ("field", ctypes.c_char_p), ("error", ctypes.c_double),
                ("relative_error", ctypes.c_double), ("max_share", ctypes.c_double), ("every", ctypes.c_int64),
                ("max_memory", ctypes.c_uint64), ("threads", ctypes.c_int32), ("background", ctypes.c_int32),
                ("thin", ctypes.c_int32), ("reserved", ctypes.c_int32), ("log", _Log),
                ("log_context", ctypes.c_void_p), ("live_file", ctypes.c_char_p)]


class _Parameter(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("name", ctypes.c_char_p), ("label", ctypes.c_char_p),
                ("unit", ctypes.c_char_p), ("minimum", ctypes.c_double), ("maximum", ctypes.c_double),
                ("value", ctypes.c_double), ("integer", ctypes.c_int32), ("reserved", ctypes.c_int32)]


class _Statistics(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("steps", ctypes.c_uint64), ("taken", ctypes.c_uint64),
                ("skipped", ctypes.c_uint64), ("run_seconds", ctypes.c_double), ("own_seconds", ctypes.c_double),
                ("last_seconds", ctypes.c_double), ("stream_bytes", ctypes.c_uint64), ("sent_bytes", ctypes.c_uint64),
                ("peak_bytes", ctypes.c_uint64), ("max_error", ctypes.c_double), ("thinning", ctypes.c_uint32),
                ("reserved", ctypes.c_uint32), ("processor_seconds", ctypes.c_double)]


def library_path():
    """Returns the path of the shared library: GHOSTSPACE_INSITU_LIBRARY, else the installed one."""
    chosen = os.environ.get("GHOSTSPACE_INSITU_LIBRARY")
    if chosen:
        return chosen
    # Installed in PREFIX/lib/python3/dist-packages/ghostspace_insitu, or PREFIX/share/ghostspace/python/...
    here = os.path.dirname(os.path.abspath(__file__))
    for up in range(2, 6):
        prefix = os.path.normpath(os.path.join(here, *[".."] * up))
        for folder in ("lib", os.path.join("lib", os.uname().machine + "-linux-gnu"), "lib64"):
            path = os.path.join(prefix, folder, "libghostspace-insitu.so.1")
            if os.path.exists(path):
                return path
    return ctypes.util.find_library("ghostspace-insitu") or "libghostspace-insitu.so.1"


_library = None


def _loaded():
    global _library
    if _library is None:
        try:
            library = ctypes.CDLL(library_path())
        except OSError as problem:
            raise Error("libghostspace-insitu cannot be loaded: %s; install it, or set GHOSTSPACE_INSITU_LIBRARY"
                        % problem) from None
        handle = ctypes.c_void_p
        for name, result, arguments in (
                ("options_init", None, [ctypes.POINTER(_Options), ctypes.c_size_t]),
                ("open", handle, [ctypes.POINTER(_Options), ctypes.POINTER(_Communicator), ctypes.c_char_p,
                                  ctypes.c_size_t]),
                ("add_parameter", ctypes.c_int, [handle, ctypes.POINTER(_Parameter)]),
                ("value", ctypes.c_double, [handle, ctypes.c_char_p]),
                ("begin_step", ctypes.c_int, [handle, ctypes.c_int64, ctypes.c_double]),
                ("pass_block", ctypes.c_int, [handle, ctypes.POINTER(_Block)]),
                ("pass_cells", ctypes.c_int, [handle, ctypes.POINTER(_Cells)]),
                ("pass_particles", ctypes.c_int, [handle, ctypes.POINTER(_Particles)]),
                ("end_step", ctypes.c_int, [handle]),
                ("port", ctypes.c_int, [handle]),
                ("error", ctypes.c_char_p, [handle]),
                ("get_statistics", ctypes.c_int, [handle, ctypes.POINTER(_Statistics)]),
                ("flush", ctypes.c_int, [handle]),
                ("close", None, [handle])):
            function = getattr(library, "gs_insitu_" + name)
            function.restype, function.argtypes = result, arguments
        _library = library
    return _library


class _View:
    """Address, shape and strides of an object with the buffer protocol. Keeps the object until release()."""

    def __init__(self, array):
        self._buffer = _Buffer()
        # PyBUF_RECORDS_RO: strides and format, read-only.
        flags = 0x0010 | 0x0008 | 0x0004
        ctypes.pythonapi.PyObject_GetBuffer.argtypes = [ctypes.py_object, ctypes.POINTER(_Buffer), ctypes.c_int]
        ctypes.pythonapi.PyObject_GetBuffer(array, ctypes.byref(self._buffer), flags)
        view = self._buffer
        self.address = view.buf
        self.itemsize = view.itemsize
        self.shape = tuple(view.shape[i] for i in range(view.ndim))
        self.strides = tuple(view.strides[i] for i in range(view.ndim))
        text = (view.format or b"B").decode()
        self.kind = _KINDS.get(text[-1])
        foreign = text[0] in (">!" if struct.pack("=H", 1) == b"\1\0" else "<") and view.itemsize > 1
        self.type = None if foreign or len(text.lstrip("@=<>!")) != 1 else _TYPES.get((self.kind, view.itemsize))

    def release(self):
        if self._buffer is not None:
            ctypes.pythonapi.PyBuffer_Release.argtypes = [ctypes.POINTER(_Buffer)]
            ctypes.pythonapi.PyBuffer_Release(ctypes.byref(self._buffer))
            self._buffer = None

    def is_packed(self):
        """Reports whether the array has no gaps, with the last index fastest."""
        expected = self.itemsize
        for size, stride in zip(reversed(self.shape), reversed(self.strides)):
            if size > 1 and stride != expected:
                return False
            expected *= size
        return True


def _bytes(text):
    return None if text is None else str(text).encode()


class _Mpi:
    """Table of functions for a communicator of mpi4py."""

    _PIECE = 1 << 30

    def __init__(self, comm):
        from mpi4py import MPI
        self._mpi, self.comm = MPI, comm.Dup()

        def pieces(address, size):
            for at in range(0, size, self._PIECE):
                count = min(self._PIECE, size - at)
                yield [(ctypes.c_char * count).from_address(address + at), MPI.BYTE]

        def guarded(function):
            def call(*arguments):
                try:
                    function(*arguments)
                    return 0
                except Exception:  # an exception cannot cross C
                    return 1
            return call

        def broadcast(_, data, size, root):
            for piece in pieces(data, size):
                self.comm.Bcast(piece, root)

        def gather(_, data, size, all_data, root):
            send = [(ctypes.c_char * size).from_address(data), MPI.BYTE]
            if self.comm.rank != root:
                self.comm.Gather(send, None, root)
            else:
                whole = size * self.comm.size
                self.comm.Gather(send, [(ctypes.c_char * whole).from_address(all_data), MPI.BYTE], root)

        def send(_, data, size, to, tag):
            for piece in pieces(data, size):
                self.comm.Send(piece, to, tag)

        def receive(_, data, size, source, tag):
            for piece in pieces(data, size):
                self.comm.Recv(piece, source, tag)

        self.table = _Communicator(
            ctypes.sizeof(_Communicator), self.comm.rank, self.comm.size, None, _Broadcast(guarded(broadcast)),
            _Gather(guarded(gather)), _Barrier(guarded(lambda _: self.comm.Barrier())), _Transfer(guarded(send)),
            _Transfer(guarded(receive)))

    def close(self):
        if self.comm is not None:
            self.comm.Free()
            self.comm = None


class Session:
    """Session of a simulation. Methods marked "collective" must be called by all ranks in the same order.

    The keyword arguments are the members of gs_insitu_options (ghostspace/insitu.h): title, folder, serve, port, bind,
    token_file, field, error, relative_error, max_share, every, max_memory, threads, background, thin, live_file.
    `comm` is a communicator of mpi4py, `parameters` a list of Parameter, and `log` a function that receives messages.
    """

    def __init__(self, comm=None, parameters=(), log=None, **options):
        library = _loaded()
        self._library, self._handle, self._views = library, None, []
        values = _Options()
        library.gs_insitu_options_init(ctypes.byref(values), ctypes.sizeof(values))
        known = {name for name, _ in _Options._fields_} - {"size", "reserved", "log", "log_context"}
        for name, value in options.items():
            if name not in known:
                raise TypeError("unknown option %r; expected one of %s" % (name, ", ".join(sorted(known))))
            if isinstance(value, (str, os.PathLike)):
                value = os.fsencode(value)
            setattr(values, name, int(value) if isinstance(value, bool) else value)
        self._log = _Log(lambda _, message: log(message.decode(errors="replace"))) if log else _Log()
        values.log = self._log
        self._mpi = _Mpi(comm) if comm is not None else None
        error = ctypes.create_string_buffer(256)
        table = ctypes.byref(self._mpi.table) if self._mpi else None
        self._handle = library.gs_insitu_open(ctypes.byref(values), table, error, len(error))
        if not self._handle:
            raise Error(error.value.decode(errors="replace"))
        try:
            for one in parameters:
                made = _Parameter(ctypes.sizeof(_Parameter), _bytes(one.name), _bytes(one.label), _bytes(one.unit),
                                  one.minimum, one.maximum, one.value, int(one.integer), 0)
                self._check(library.gs_insitu_add_parameter(self._handle, ctypes.byref(made)))
        except Exception:
            self.close()  # nobody else can
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __getitem__(self, name):
        """Returns the value of a parameter."""
        value = self._library.gs_insitu_value(self._open(), name.encode())
        if math.isnan(value):
            raise KeyError(name)
        return value

    @property
    def port(self):
        """Port of the server on rank 0, or 0."""
        return self._library.gs_insitu_port(self._open())

    @property
    def statistics(self):
        """Numbers about the session so far, as a dictionary (gs_insitu_statistics)."""
        numbers = _Statistics(ctypes.sizeof(_Statistics))
        self._check(self._library.gs_insitu_get_statistics(self._open(), ctypes.byref(numbers)))
        return {name: getattr(numbers, name) for name, _ in _Statistics._fields_ if name not in ("size", "reserved")}

    def begin_step(self, step, time=0.0):
        """Begins a step. Collective. Returns True if the caller should pass its arrays and call end_step()."""
        return self._check(self._library.gs_insitu_begin_step(self._open(), step, time)) == _OK

    def end_step(self):
        """Ends a step. Collective. Afterwards the caller may change its arrays."""
        try:
            self._check(self._library.gs_insitu_end_step(self._open()))
        finally:
            self._release()

    def block(self, fields, extent=None, whole_extent=None, origin=(0, 0, 0), spacing=(1, 1, 1),
              ghost=(0, 0, 0, 0, 0, 0), cell_fields=None, units=None, order="zyx"):
        """Passes a block of a regular grid.

        `fields` has arrays by name for points, `cell_fields` for cells, and `units` their units. An array has the
        indices [z][y][x] (`order` "zyx") or [x][y][z] ("xyz"), and perhaps a last index for components. `extent` is
        x0, x1, y0, y1, z0, z1; without it, the array begins at 0.
        """
        if order not in ("zyx", "xyz"):
            raise ValueError("the order is %r; expected 'zyx' or 'xyz'" % order)
        made, points = [], None
        for association, some in ((_POINTS, fields or {}), (_CELLS, cell_fields or {})):
            for name, array in some.items():
                view = self._view(name, array)
                if len(view.shape) not in (3, 4):
                    raise ValueError("field %r has %d indices; expected 3, or 4 with components"
                                     % (name, len(view.shape)))
                axes = (2, 1, 0) if order == "zyx" else (0, 1, 2)
                sizes = [view.shape[a] for a in axes]
                here = [n if association == _POINTS else n + 1 for n in sizes]
                if points is None:
                    points = here
                if points != here:
                    raise ValueError("field %r has %s points; expected %s" % (name, here, points))
                components = view.shape[3] if len(view.shape) == 4 else 1
                strides = [view.strides[a] for a in axes]
                strides.append(view.strides[3] if components > 1 else view.itemsize)
                made.append(self._field(name, view, association, components, strides, units))
        if points is None:
            raise ValueError("a block has no fields; expected at least one array")
        if extent is None:
            extent = [bound for n in points for bound in (0, n - 1)]
        if [extent[2 * a + 1] - extent[2 * a] + 1 for a in range(3)] != points:
            raise ValueError("the extent %s does not fit arrays with %s points" % (list(extent), points))
        block = _Block(size=ctypes.sizeof(_Block), field_count=len(made))
        for i in range(6):
            block.extent[i] = extent[i]
            block.whole_extent[i] = (extent if whole_extent is None else whole_extent)[i]
            block.ghost[i] = ghost[i]
        for a in range(3):
            block.origin[a], block.spacing[a] = origin[a], spacing[a]
        block.fields = (_Field * len(made))(*made)
        self._check(self._library.gs_insitu_pass_block(self._open(), ctypes.byref(block)))

    def cells(self, points, connectivity, offsets, types, fields=None, cell_fields=None, ghosts=None, units=None):
        """Passes unstructured cells: points [n][3], and connectivity, offsets and types as in VTK."""
        at, joins = self._packed("points", points), self._packed("connectivity", connectivity)
        begins, kinds = self._packed("offsets", offsets), self._packed("types", types)
        if at.type not in (_FLOAT32, _FLOAT64):
            raise ValueError("the points are no floating-point numbers; expected float32 or float64")
        if joins.type != begins.type or joins.type not in (_INT32, _INT64):
            raise ValueError("connectivity and offsets have other types; expected both int32, or both int64")
        if kinds.itemsize != 1:
            raise ValueError("the types have %d bytes each; expected uint8" % kinds.itemsize)
        count = math.prod(kinds.shape)
        if math.prod(begins.shape) != count + 1 or math.prod(at.shape) % 3:
            raise ValueError("the arrays do not fit; expected one offset more than types, and three numbers per point")
        hidden = self._packed("ghosts", ghosts) if ghosts is not None else None
        if hidden and (hidden.itemsize != 1 or math.prod(hidden.shape) != count):
            raise ValueError("the ghosts do not fit; expected one uint8 per cell")
        made = self._lists((_POINTS, fields, math.prod(at.shape) // 3), (_CELLS, cell_fields, count), units)
        cells = _Cells(ctypes.sizeof(_Cells), at.address, at.type, joins.type, math.prod(at.shape) // 3, joins.address,
                       math.prod(joins.shape), begins.address, kinds.address, count,
                       hidden.address if hidden else None, (_Field * max(len(made), 1))(*made), len(made))
        self._check(self._library.gs_insitu_pass_cells(self._open(), ctypes.byref(cells)))

    def particles(self, positions, fields=None, radius=0.0, units=None):
        """Passes particles: positions [n][3], and arrays by name with a value for each."""
        at = self._packed("positions", positions)
        if at.type not in (_FLOAT32, _FLOAT64) or math.prod(at.shape) % 3:
            raise ValueError("the positions are not three floating-point numbers each; expected float32 or float64")
        count = math.prod(at.shape) // 3
        made = self._lists((_POINTS, fields, count), (_CELLS, None, 0), units)
        some = _Particles(ctypes.sizeof(_Particles), at.address, at.type, 0, count, radius,
                          (_Field * max(len(made), 1))(*made), len(made))
        self._check(self._library.gs_insitu_pass_particles(self._open(), ctypes.byref(some)))

    def flush(self):
        """Waits until the streams of all taken steps are complete."""
        self._check(self._library.gs_insitu_flush(self._open()))

    def close(self):
        """Ends the session. Collective. A second call has no effect."""
        if self._handle:
            self._library.gs_insitu_close(self._handle)
            self._handle = None
            if self._mpi:
                self._mpi.close()
        self._release()

    def _open(self):
        if not self._handle:
            raise Error("the session is closed")
        return self._handle

    def _check(self, result):
        if result < 0:
            raise Error(self._library.gs_insitu_error(self._handle).decode(errors="replace"))
        return result

    def _release(self):
        for view in self._views:
            view.release()
        self._views = []

    def _view(self, name, array):
        view = _View(array)
        self._views.append(view)
        if view.type is None:
            raise ValueError("%r has an unknown type; expected numbers of this machine" % name)
        return view

    def _packed(self, name, array):
        view = self._view(name, array)
        if not view.is_packed():
            raise ValueError("%r has gaps; expected a contiguous array" % name)
        return view

    @staticmethod
    def _field(name, view, association, components, strides, units):
        return _Field(_bytes(name), _bytes((units or {}).get(name)), view.address, view.type, association, components,
                      0, (ctypes.c_int64 * 4)(*strides))

    def _lists(self, points, cells, units):
        made = []
        for association, fields, count in (points, cells):
            for name, array in (fields or {}).items():
                view = self._view(name, array)
                if not view.shape or view.shape[0] != count or len(view.shape) > 2:
                    raise ValueError("field %r has the shape %s; expected %d values" % (name, view.shape, count))
                components = view.shape[1] if len(view.shape) == 2 else 1
                strides = [view.strides[0], 0, 0, view.strides[1] if components > 1 else view.itemsize]
                made.append(self._field(name, view, association, components, strides, units))
        return made
