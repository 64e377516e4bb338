"""Datasets of VTK for a Session, without copying their arrays. Needs the modules of VTK and NumPy.

    from ghostspace_insitu.vtk import pass_dataset

    if session.begin_step(step, time):
        pass_dataset(session, grid)
        session.end_step()

Takes vtkImageData, vtkUnstructuredGrid, vtkPolyData, and composite datasets of these. Returns the number of datasets that
were passed. Other types are left out.
"""

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy

_MAX_FIELDS = 16  # of the library


def _arrays(data, count):
    """Returns the arrays of point or cell data as NumPy views, by name. Leaves out those of other lengths."""
    found = {}
    for i in range(data.GetNumberOfArrays()):
        array, name = data.GetArray(i), data.GetArrayName(i)
        if array is None or not name or name.startswith("vtk") or len(found) >= _MAX_FIELDS:
            continue
        values = vtk_to_numpy(array)
        if len(values) == count and (values.ndim == 1 or values.shape[1] <= 9):
            found[name[:63]] = values
    return found


def _ghosts(data):
    array = data.GetArray("vtkGhostType")
    return None if array is None else vtk_to_numpy(array)


def _pass_image(session, image, whole_extent):
    extent = image.GetExtent()
    sizes = [extent[2 * a + 1] - extent[2 * a] + 1 for a in range(3)]
    if min(sizes) < 1:
        return 0
    cells = [max(n - 1, 1) for n in sizes]

    def shaped(arrays, n):
        return {name: values.reshape((n[2], n[1], n[0]) + values.shape[1:]) for name, values in arrays.items()}

    points = shaped(_arrays(image.GetPointData(), image.GetNumberOfPoints()), sizes)
    others = shaped(_arrays(image.GetCellData(), image.GetNumberOfCells()), cells)
    if not points and not others:
        return 0
    session.block(points, cell_fields=dict(list(others.items())[:_MAX_FIELDS - len(points)]), extent=extent,
                  whole_extent=whole_extent or extent, origin=image.GetOrigin(), spacing=image.GetSpacing())
    return 1


def _pass_cells(session, dataset, cells, types):
    points = dataset.GetPoints()
    if points is None or cells is None or cells.GetNumberOfCells() == 0:
        return 0
    count = cells.GetNumberOfCells()
    others = _arrays(dataset.GetCellData(), count)
    fields = _arrays(dataset.GetPointData(), dataset.GetNumberOfPoints())
    ghosts = _ghosts(dataset.GetCellData())
    session.cells(vtk_to_numpy(points.GetData()), vtk_to_numpy(cells.GetConnectivityArray()),
                  vtk_to_numpy(cells.GetOffsetsArray()), types, fields=fields,
                  cell_fields=dict(list(others.items())[:_MAX_FIELDS - len(fields)]),
                  ghosts=ghosts if ghosts is not None and len(ghosts) == count else None)
    return 1


def pass_dataset(session, dataset, whole_extent=None):
    """Passes a dataset to a session, in a step that has begun. `whole_extent` is that of an image of all ranks."""
    if dataset is None:
        return 0
    if dataset.IsA("vtkCompositeDataSet"):
        walk, count = dataset.NewIterator(), 0
        walk.InitTraversal()
        while not walk.IsDoneWithTraversal():
            count += pass_dataset(session, walk.GetCurrentDataObject(), whole_extent)
            walk.GoToNextItem()
        return count
    if dataset.IsA("vtkImageData"):
        return _pass_image(session, dataset, whole_extent)
    if dataset.IsA("vtkUnstructuredGrid"):
        if dataset.GetNumberOfCells() == 0:
            return 0
        return _pass_cells(session, dataset, dataset.GetCells(), vtk_to_numpy(dataset.GetCellTypesArray()))
    if dataset.IsA("vtkPolyData"):
        if dataset.GetNumberOfPolys() > 0:
            types = numpy.full(dataset.GetNumberOfPolys(), 7, numpy.uint8)
            return _pass_cells(session, dataset, dataset.GetPolys(), types)
        if dataset.GetNumberOfPoints() > 0:
            session.particles(vtk_to_numpy(dataset.GetPoints().GetData()),
                              _arrays(dataset.GetPointData(), dataset.GetNumberOfPoints()))
            return 1
    return 0
