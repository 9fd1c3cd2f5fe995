#!/usr/bin/python3
"""Draws binary STL meshes side by side, in one scale and seen from one direction, into a PNG file.

draw_meshes.py PICTURE.png MESH.stl..."""
import struct
import sys
import zlib

import numpy

CELL, MARGIN, SAMPLES = 190, 8, 2  # pixels a mesh, around it, and subpixels along a pixel's edge
SIGHT = numpy.array([[0.80, 0.60, 0.0], [-0.15, 0.20, 0.968], [0.581, -0.774, 0.25]])  # rows: right, up, towards the eye
LIGHT = numpy.array([0.35, 0.45, 0.82])
COLOUR = numpy.array([0.93, 0.88, 0.78])


def read_stl(path):
    data = open(path, "rb").read()
    count, = struct.unpack_from("<I", data, 80)
    rows = numpy.frombuffer(data, numpy.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("spare", "<u2")]), count, 84)
    return rows["corners"].reshape(count, 3, 3).astype(float)


def draw(triangles, centre, scale, size):
    """Brightness by pixel, and whether anything is there, of triangles in view coordinates."""
    depth = numpy.full((size, size), -numpy.inf)
    shade = numpy.zeros((size, size))
    edges = triangles[:, 1:] - triangles[:, :1]
    normals = numpy.cross(edges[:, 0], edges[:, 1])
    lengths = numpy.linalg.norm(normals, axis=1)
    facing = (normals[:, 2] > 0) & (lengths > 0)
    bright = (normals[facing] / lengths[facing, None]) @ (LIGHT / numpy.linalg.norm(LIGHT))
    points = (triangles[facing] - centre) * scale
    points[:, :, :2] += size / 2
    for (a, b, c), value in zip(points, bright):
        low = numpy.maximum(numpy.floor(numpy.min([a, b, c], axis=0)[:2]).astype(int), 0)
        high = numpy.minimum(numpy.ceil(numpy.max([a, b, c], axis=0)[:2]).astype(int) + 1, size)
        if (low >= high).any():
            continue
        x, y = numpy.meshgrid(numpy.arange(low[0], high[0]) + 0.5, numpy.arange(low[1], high[1]) + 0.5)
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        v = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
        w = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
        z = a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])
        view = (slice(low[1], high[1]), slice(low[0], high[0]))
        nearer = (v >= 0) & (w >= 0) & (v + w <= 1) & (z > depth[view])
        depth[view][nearer] = z[nearer]
        shade[view][nearer] = 0.25 + 0.75 * max(value, 0)
    return shade[::-1], numpy.isfinite(depth[::-1])


def write_png(path, pixels):
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def main(picture, *paths):
    meshes = [read_stl(path) @ SIGHT.T for path in paths]
    corners = numpy.concatenate([mesh.reshape(-1, 3) for mesh in meshes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = CELL * SAMPLES
    scale = (CELL - 2 * MARGIN) * SAMPLES / (high - low)[:2].max()
    cells = []
    for mesh in meshes:
        shade, there = draw(mesh, (low + high) / 2, scale, size)
        colours = numpy.where(there[..., None], shade[..., None] * COLOUR, 1.0)
        cells.append(colours.reshape(CELL, SAMPLES, CELL, SAMPLES, 3).mean(axis=(1, 3)))
    write_png(picture, (numpy.concatenate(cells, axis=1) * 255).round().astype(numpy.uint8))


if __name__ == "__main__":
    main(*sys.argv[1:])
