#!/usr/bin/python3
"""Compares print_labels with VTK: surfaces that VTK makes and writes in every format, and the STL files of the folders
given, by the volume and centroid that VTK's reading of the same file encloses.

solid_oracle.py PRINT_LABELS FOLDER..."""
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
except ImportError:
    print("skipped: numpy or VTK is not installed")
    sys.exit(77)


def writer(kind, binary=None):
    def write(surface, path):
        made = kind()
        made.SetFileName(str(path))
        made.SetInputData(surface)
        if binary is not None:
            made.SetFileType(vtk.VTK_BINARY if binary else vtk.VTK_ASCII)
        made.Write()
    return write


FORMATS = {"binary.stl": (writer(vtk.vtkSTLWriter, True), vtk.vtkSTLReader),
           "text.stl": (writer(vtk.vtkSTLWriter, False), vtk.vtkSTLReader),
           "binary.ply": (writer(vtk.vtkPLYWriter, True), vtk.vtkPLYReader),
           "text.ply": (writer(vtk.vtkPLYWriter, False), vtk.vtkPLYReader),
           "text.obj": (writer(vtk.vtkOBJWriter), vtk.vtkOBJReader)}


def blobs(seed):
    """Where a sum of bells is 1/2: closed triangles, turned and away from the origin."""
    random = numpy.random.default_rng(seed)
    place = numpy.stack(numpy.meshgrid(*[numpy.arange(40.0)] * 3, indexing="ij"))
    field = sum(numpy.exp(-(((place - random.uniform(13, 27, 3)[:, None, None, None]) / width) ** 2).sum(axis=0))
                for width in random.uniform(3, 5, 4))
    image, contour = vtk.vtkImageData(), vtk.vtkFlyingEdges3D()
    image.SetDimensions(40, 40, 40)
    image.SetSpacing(*random.uniform(1, 3, 3))
    image.GetPointData().SetScalars(numpy_to_vtk(field.ravel(order="F"), deep=True))
    contour.SetInputData(image)
    contour.SetValue(0, 0.5)
    move, transform = vtk.vtkTransformPolyDataFilter(), vtk.vtkTransform()
    transform.Translate(*random.uniform(-300, 300, 3))
    transform.RotateWXYZ(random.uniform(0, 360), *random.normal(size=3))
    move.SetInputConnection(contour.GetOutputPort())
    move.SetTransform(transform)
    move.Update()
    return move.GetOutput()


def enclosed(path, reader):
    """Volume and centroid of VTK's reading, by tetrahedra to the first corner."""
    made = reader()
    made.SetFileName(str(path))
    made.Update()
    surface = made.GetOutput()
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    origin = points[corners[0, 0]]
    tetrahedra = points[corners] - origin
    volumes = numpy.linalg.det(tetrahedra) / 6
    centroids = tetrahedra.sum(axis=1) / 4
    return abs(volumes.sum()), origin + volumes @ centroids / volumes.sum()


def compare(program, path, reader):
    printed = subprocess.run([program, str(path)], check=True, capture_output=True, text=True).stdout.split()
    volume, centroid = enclosed(path, reader)
    assert len(printed) == 7 and printed[0] == "1", f"{path}: {' '.join(printed)}"
    got, found = float(printed[2]), numpy.array([float(number) for number in printed[3:6]])
    assert abs(got - volume) < 0.005 * volume, f"{path}: the volume is {got}, VTK has {volume}"
    assert abs(int(printed[1]) - 100000) < 500, f"{path}: {printed[1]} voxels"
    assert numpy.abs(found - centroid).max() < 0.002 * volume ** (1 / 3), f"{path}: centroid {found}, VTK has {centroid}"


def main():
    compared = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(8):
            surface = blobs(seed)
            for name, (write, reader) in FORMATS.items():
                path = pathlib.Path(folder) / name
                write(surface, path)
                compare(sys.argv[1], path, reader)
                compared += 1
    for folder in sys.argv[2:]:
        for path in sorted(pathlib.Path(folder).glob("*.stl")):
            compare(sys.argv[1], path, vtk.vtkSTLReader)
            compared += 1
    print(f"{compared} meshes, as VTK reads them")


main()
