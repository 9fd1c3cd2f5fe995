"""VTK's FlyingEdges and scikit-image's marching cubes on values that bench_mesh wrote: meshing.py FIGURE FILE. Only the
surface: the field is there already."""
import sys

import numpy
import vtk
from skimage.measure import marching_cubes
from vtk.util.numpy_support import numpy_to_vtk

from measure import least_milliseconds, show

figure, path = sys.argv[1:]
extents = numpy.fromfile(path, numpy.uint32, 3)
values = numpy.fromfile(path, numpy.float32, offset=12).reshape(extents[::-1])

image = vtk.vtkImageData()
image.SetDimensions(*(int(n) for n in extents))
image.GetPointData().SetScalars(numpy_to_vtk(values.ravel()))
vtk.vtkSMPTools.SetBackend("Sequential")


def flying_edges():
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0)
    edges.ComputeNormalsOn()
    edges.Update()


show(figure, "VTK FlyingEdges, surface alone", least_milliseconds(flying_edges), "ms")
show(figure, "scikit-image, surface alone", least_milliseconds(lambda: marching_cubes(values, 0)), "ms")
