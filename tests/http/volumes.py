"""Small label volumes as NIfTI-1 files in memory."""
import gzip
import random
import struct


def nifti(size, values, spacing=1.0):
    """values: one byte a voxel, x fastest."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *size, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 2, 8)  # uint8, 8 bits
    struct.pack_into("<8f", header, 76, 1, spacing, spacing, spacing, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352)
    struct.pack_into("<b", header, 123, 2)  # mm
    struct.pack_into("<2h", header, 252, 0, 1)  # sform
    for row in range(3):
        axis = [0.0] * 4
        axis[row] = spacing
        struct.pack_into("<4f", header, 280 + 16 * row, *axis)
    header[344:348] = b"n+1\0"
    return bytes(header) + bytes(values)


def blob(seed, labels=1, compressed=False):
    """An irregular lump for each label, another for each seed: some thousand voxels of three blended ellipsoids."""
    dice = random.Random(seed)
    nx, ny, nz = 24, 18, 14
    values = bytearray(nx * labels * ny * nz)
    for label in range(1, labels + 1):
        parts = [
            [(dice.uniform(0.3, 0.7) * n, dice.uniform(0.12, 0.3) * n) for n in (nx, ny, nz)] for _ in range(3)
        ]
        for z in range(nz):
            for y in range(ny):
                start = (z * ny + y) * nx * labels + (label - 1) * nx
                for x in range(nx):
                    if any(sum(((p - c) / r) ** 2 for p, (c, r) in zip((x, y, z), part)) < 1 for part in parts):
                        values[start + x] = label
    volume = nifti((nx * labels, ny, nz), values)
    return gzip.compress(volume, 1) if compressed else volume
