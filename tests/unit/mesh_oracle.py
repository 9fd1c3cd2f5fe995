#!/usr/bin/python3
"""Reads with VTK and assimp the meshes that print_mesh writes, in every format: mesh_oracle.py PRINT_MESH

Each file must hold a closed surface of the volume and area that eskel says, where its frame has it; glTF upright, in metres."""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def read(path):
    """A polydata with shared vertices. glTF is read with its node's transform."""
    reader = {".stl": vtk.vtkSTLReader, ".ply": vtk.vtkPLYReader, ".obj": vtk.vtkOBJReader, ".glb": vtk.vtkGLTFReader}[path.suffix]()
    reader.SetFileName(str(path))
    reader.Update()
    surface = reader.GetOutput()
    if path.suffix == ".glb":
        flat = vtk.vtkCompositeDataGeometryFilter()
        flat.SetInputConnection(reader.GetOutputPort())
        flat.Update()
        surface = flat.GetOutput()
    return surface


def open_edges(surface):
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.FeatureEdgesOff()
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


def count_intersections(surface):
    """Triangles that another one, with which it has no corner in common, cuts: by VTK's own test of two triangles."""
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    corners = points[cells]
    low, high = corners.min(axis=1), corners.max(axis=1)
    found = 0
    for i in range(len(cells)):
        near = numpy.flatnonzero(((low[i + 1 :] <= high[i]) & (low[i] <= high[i + 1 :])).all(axis=1)) + i + 1
        for j in near[~numpy.isin(cells[near], cells[i]).any(axis=1)]:
            found += vtk.vtkTriangle.TrianglesIntersect(*corners[i], *corners[j])
    return found


def check(condition, what):
    if not condition:
        sys.exit(f"mesh_oracle: {what}")


def check_file(path, frame, volume, area, triangles, box):
    surface = read(path)
    unit = 1e-3 if path.suffix == ".glb" else 1
    check(surface.GetNumberOfPolys() == triangles, f"{path.name}: {surface.GetNumberOfPolys()} triangles, not {triangles}")
    # STL has no vertices, and voxels that touch would be merged.
    check(path.suffix == ".stl" or open_edges(surface) == 0, f"{path.name} is not closed")
    # VTK's own estimate is rough for small meshes: the sum of tetrahedra is exact, and signed.
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    corners = points[vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
    corners -= points.mean(axis=0)
    found = numpy.einsum("ij,ij", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])) / 6
    check(abs(found / unit**3 / volume - 1) < 1e-4, f"{path.name}: volume {found}, not {volume * unit**3}")
    mass = vtk.vtkMassProperties()
    mass.SetInputData(surface)
    mass.Update()
    check(abs(mass.GetSurfaceArea() / unit**2 / area - 1) < 1e-4, f"{path.name}: area {mass.GetSurfaceArea()}, not {area}")
    low, high = box
    if path.suffix == ".glb":  # left, up, front
        low, high = numpy.array([-high[0], low[2], low[1]]) / 1e3, numpy.array([-low[0], high[2], high[1]]) / 1e3
    elif frame == "lps":
        low, high = numpy.array([-high[0], -high[1], low[2]]), numpy.array([-low[0], -low[1], high[2]])
    check(numpy.allclose(points.min(axis=0), low, atol=1e-4 * unit), f"{path.name} begins at {points.min(axis=0)}, not {low}")
    check(numpy.allclose(points.max(axis=0), high, atol=1e-4 * unit), f"{path.name} ends at {points.max(axis=0)}, not {high}")


def check_frame(path, frame):
    content = path.read_bytes()
    if path.suffix == ".glb":
        size = struct.unpack("<I", content[12:16])[0]
        found = json.loads(content[20 : 20 + size])["asset"]["extras"]
        check(found == {"space": frame.upper(), "unit": "mm"}, f"{path.name} says {found}")
    else:
        check(b"SPACE=" + frame.upper().encode() in content[:300], f"{path.name} does not say its frame")


def check_assimp(path, triangles):
    shown = subprocess.run(["assimp", "info", str(path)], capture_output=True, text=True)
    check(shown.returncode == 0, f"assimp refuses {path.name}: {shown.stdout}{shown.stderr}")
    found = next(int(line.split()[-1]) for line in shown.stdout.splitlines() if line.startswith("Faces:"))
    check(found == triangles, f"assimp finds {found} triangles in {path.name}, not {triangles}")


count = 0
with tempfile.TemporaryDirectory() as folder:
    printed = subprocess.run([sys.argv[1], folder], check=True, capture_output=True, text=True).stdout
    for name, volume, area, triangles in (line.split() for line in printed.splitlines()):
        # The box of the PLY in RAS stands for all: PLY is read by its header, without any transform.
        points = vtk_to_numpy(read(pathlib.Path(folder, f"{name}-ras.ply")).GetPoints().GetData())
        for frame in ("ras", "lps"):
            for format in ("stl", "ply", "obj", "glb"):
                path = pathlib.Path(folder, f"{name}-{frame}.{format}")
                check_file(path, frame, float(volume), float(area), int(triangles), (points.min(axis=0), points.max(axis=0)))
                check_frame(path, frame)
                check_assimp(path, int(triangles))
                count += 1
        union = read(pathlib.Path(folder, f"{name}-ras.ply"))
        check(name != "union" or count_intersections(union) == 0, "the union intersects itself")
        if name == "ellipsoid":
            check(numpy.allclose(points.min(axis=0), [12, -40, 26], atol=0.1), "the ellipsoid lies elsewhere")
print(f"{count} files")
