#!/usr/bin/python3
"""Compares print_labels with nibabel: voxels, volume, centroid, touched borders and name of every label, in every .nii.gz
below the folders given and in random files with all sorts of orientation, datatype and byte order; of the random ones also
with what they are as MetaImage. Random header extensions name some labels. MGH files likewise, with random tags behind.

volume_oracle.py PRINT_LABELS FOLDER..."""
import gzip
import pathlib
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
import xml.sax.saxutils
import zlib

try:
    import nibabel
    import numpy
except ImportError:
    print("skipped: nibabel is not installed")
    sys.exit(77)

METAIMAGE_TYPES = {"i1": "MET_CHAR", "u1": "MET_UCHAR", "i2": "MET_SHORT", "u2": "MET_USHORT", "i4": "MET_INT", "u4": "MET_UINT",
                   "i8": "MET_LONG_LONG", "u8": "MET_ULONG_LONG", "f4": "MET_FLOAT", "f8": "MET_DOUBLE"}
BAD_VALUE, UNSUPPORTED = "refused 9", "refused 6"  # of eskel_status


def names_in(image):
    """{label: name} of the header extensions, the first where there are several."""
    names = {}
    for extension in getattr(image.header, "extensions", []):
        if extension.get_code() in (0, 30):
            table = xml.etree.ElementTree.fromstring(extension.get_content().rstrip(b"\0")).find(".//LabelTable")
            for label in table:
                names.setdefault(int(label.get("Key")), label.text.strip())
    return names


def expected_labels(path, names=None):
    """{label: (voxels, volume, centroid, sides, name)}, or the refusal. Names that nibabel does not read are given."""
    image = nibabel.load(path)
    if any(n != 1 for n in image.shape[3:]):
        return UNSUPPORTED
    values = numpy.asanyarray(image.dataobj).reshape((image.shape + (1, 1))[:3])
    if not numpy.array_equal(values, numpy.rint(values)):
        return BAD_VALUE
    result = {}
    where = numpy.nonzero(values)
    index = numpy.stack(where, axis=1)
    found = values[where].astype(numpy.int64)
    order = numpy.argsort(found, kind="stable")
    index, found = index[order], found[order]
    labels, first = numpy.unique(found, return_index=True)
    volume = abs(numpy.linalg.det(image.affine[:3, :3]))
    names = names_in(image) if names is None else names
    for label, points in zip(labels, numpy.split(index, first[1:])):
        centroid = image.affine[:3, :3] @ points.mean(axis=0) + image.affine[:3, 3]
        sides = 0
        for axis in range(3):
            sides |= int((points[:, axis] == 0).any()) << 2 * axis
            sides |= int((points[:, axis] == values.shape[axis] - 1).any()) << 2 * axis + 1
        result[int(label)] = (len(points), len(points) * volume, centroid, sides, names.get(int(label), ""))
    return result


def printed_labels(program, path):
    text = subprocess.run([program, str(path)], check=True, capture_output=True, text=True).stdout
    if text.startswith("refused"):
        return text.strip()
    result = {}
    for line in text.splitlines():
        label, voxels, volume, x, y, z, sides, name = line.split(" ", 7)
        result[int(label)] = (int(voxels), float(volume), numpy.array([float(x), float(y), float(z)]), int(sides), name)
    return result


def compare(program, path, reference=None, names=None):
    """Of a path that nibabel cannot read, the reference is the same volume."""
    reference = reference or path
    expected, printed = expected_labels(reference, names), printed_labels(program, path)
    if isinstance(expected, str) or isinstance(printed, str):
        assert expected == printed, f"{path}: {printed}, expected {expected}"
        return 0
    assert sorted(expected) == sorted(printed), f"{path}: labels {sorted(printed)}, expected {sorted(expected)}"
    # The canonical offset is rounded to 1/1024 of less than the largest matrix entry.
    spacing = numpy.abs(nibabel.load(reference).affine[:3, :3]).max()
    for label, (voxels, volume, centroid, sides, name) in expected.items():
        got = printed[label]
        where = f"{path}, label {label}: {got}, expected {expected[label]}"
        assert got[0] == voxels and got[3] == sides, where
        assert abs(got[1] - volume) <= 2e-6 * volume, where
        assert numpy.abs(got[2] - centroid).max() <= spacing / 1024, where
        assert got[4] == name, where
    return len(expected)


def random_extensions(rng):
    """None to two; one of code 6 is a comment, whatever it looks like."""
    extensions = []
    for code in rng.choice([0, 6, 30], rng.integers(3)):
        labels = ""
        for key in rng.permutation(numpy.arange(-2, 121)):
            name = "".join(rng.choice(list("aZ9 _-<>&'\"\u00e9\u20ac\U0001f9b4"), rng.integers(1, 40))).strip() or "x"
            escaped = xml.sax.saxutils.escape(name)
            texts = [f"<![CDATA[{name}]]>", escaped, escaped.encode("ascii", "xmlcharrefreplace").decode()]
            labels += f"<Label Key='{key}' Red=\"1\">{rng.choice(texts)}</Label>\n"
        content = (f'<?xml version="1.0" encoding="UTF-8"?>\n<CaretExtension><Date><![CDATA[2013-07-14T05:45:09]]></Date>'
                   f'<VolumeInformation Index="0"><LabelTable>\n{labels}</LabelTable></VolumeInformation></CaretExtension>')
        extensions.append(nibabel.nifti1.Nifti1Extension(int(code), content.encode()))
    return extensions


def random_image(rng):
    shape = rng.integers(1, 30, 3)
    data = numpy.zeros(shape)
    for label in rng.integers(1, 120, 4):
        low = rng.integers(0, shape)
        high = rng.integers(low, shape) + 1
        data[tuple(slice(a, b) for a, b in zip(low, high))] = label
    data[tuple(shape // 2)] = 1
    kind = nibabel.Nifti1Image if rng.integers(2) else nibabel.Nifti2Image
    code = rng.choice(["u1", "i1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"])
    header = kind.header_class(endianness="<>"[rng.integers(2)])
    header.set_data_dtype(code)
    header.set_xyzt_units("mm")
    rotation = numpy.linalg.qr(rng.normal(size=(3, 3)))[0]  # either handedness
    affine = numpy.eye(4)
    affine[:3, :3] = rotation * rng.uniform(0.2, 5, 3)
    affine[:3, 3] = rng.uniform(-300, 300, 3)
    image = kind(data.astype(code), affine, header)
    image.header.extensions.extend(random_extensions(rng))
    image.set_qform(affine, 1)
    image.set_sform(affine, int(rng.integers(2)))  # code 0: only the qform counts
    return image


def random_tags(rng):
    """Behind an MGH file's voxels and scan: tags with a size, one of the two forms of colour table among them. And the names
    of that."""
    tags, names = b"", {}
    for tag in rng.permutation([1, 3, 31, 42, 77])[:rng.integers(6)]:
        if tag != 1:
            content = rng.bytes(rng.integers(50))
            tags += struct.pack(">iq", tag, len(content)) + content
            continue
        numbered = rng.integers(2)
        labels = list(range(121)) if not numbered else sorted(map(int, rng.choice(121, 60, replace=False)))
        tags += struct.pack(">3i", 1, -2, 121) if numbered else struct.pack(">2i", 1, len(labels))
        tags += struct.pack(">i", 9) + b"some.txt\0" + (struct.pack(">i", len(labels)) if numbered else b"")
        for label in labels:
            names[label] = f"Left-structure {label} \u00e9"[:rng.integers(3, 20)].strip()
            name = names[label].encode() + b"\0"
            tags += (struct.pack(">i", label) if numbered else b"") + struct.pack(">i", len(name)) + name
            tags += struct.pack(">4i", *rng.integers(0, 255, 4))
    return tags + rng.choice([b"", b"\0\0", b"\0\0\0\0 what follows is not read"]), names


def save_mgh(rng, nifti, path, reference):
    """The reference, which nibabel wrote, with tags, or without a footer; the names in it. Labels that FreeSurfer names
    itself are not among those without a colour table. Where the header does not say how the voxels lie, they lie as
    FreeSurfer's setDirectionCosine says; nibabel has them upside down."""
    image = nibabel.load(nifti)
    tags, names = random_tags(rng)
    labels = numpy.asarray(image.dataobj).astype(int)
    data = (labels if names else labels * 1000).astype(rng.choice([">i4", ">f4"] + [">i2", "u1"] * bool(names)))
    affine, is_valid = image.affine, rng.integers(4) > 0
    if not is_valid:
        directions = numpy.array([[-1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
        affine = nibabel.affines.from_matvec(directions, -directions @ data.shape / 2)
    nibabel.save(nibabel.MGHImage(data, affine), reference)
    stored = reference.read_bytes()
    if not is_valid:
        stored = stored[:28] + bytes(62) + stored[90:]
    stored = stored + tags if names or rng.integers(2) else stored[:-20]
    path.write_bytes(gzip.compress(stored) if path.suffix == ".mgz" else stored)
    return names


def save_metaimage(nifti, path, compressed):
    """The voxels as they lie in the file, axis by axis, in LPS."""
    image = nibabel.load(nifti)
    voxels = image.dataobj.get_unscaled()
    spacing = numpy.linalg.norm(image.affine[:3, :3], axis=0)
    lps = numpy.diag([-1, -1, 1]) @ image.affine[:3]
    stored = voxels.tobytes(order="F")
    numbers = [" ".join(map(repr, map(float, values))) for values in ((lps[:, :3] / spacing).T.ravel(), lps[:, 3], spacing)]
    header = (f"ObjectType = Image\nNDims = 3\nBinaryData = True\n"
              f"BinaryDataByteOrderMSB = {voxels.dtype.newbyteorder('=') != voxels.dtype}\nCompressedData = {compressed}\n"
              f"TransformMatrix = {numbers[0]}\nOffset = {numbers[1]}\nElementSpacing = {numbers[2]}\n"
              f"DimSize = {' '.join(map(str, voxels.shape))}\nElementType = {METAIMAGE_TYPES[voxels.dtype.str[1:]]}\n"
              f"ElementDataFile = LOCAL\n")
    path.write_bytes(header.encode() + (zlib.compress(stored) if compressed else stored))


def main(program, folders):
    files = sorted(path for folder in folders for path in pathlib.Path(folder).rglob("*.nii.gz"))
    for folder in folders:
        if not pathlib.Path(folder).is_dir():
            print(f"skipped: {folder} is absent")
    labels = sum(compare(program, path) for path in files)
    rng = numpy.random.default_rng(20)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(100):
            path = pathlib.Path(folder, f"random_{number}.nii" + (".gz" if number % 2 else ""))
            nibabel.save(random_image(rng), path)
            labels += compare(program, path)
            metaimage = path.with_name(f"random_{number}.mha")
            save_metaimage(path, metaimage, number % 3 == 0)
            compare(program, metaimage, path, {})
            mgh = path.with_name(f"random_{number}.mg" + "hz"[number % 2])
            reference = path.with_name(f"reference_{number}.mgh")
            names = save_mgh(rng, path, mgh, reference)
            labels += compare(program, mgh, reference, names)
    print(f"{len(files)} files and 200 random ones, {labels} labels agree")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
