"""Writes DICOM segmentations with pydicom, and reads files with print_segments (PRINT_SEGMENTS names it)."""
import os
import subprocess
import sys
import warnings

try:
    import numpy
    import pydicom
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.sequence import Sequence
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)

warnings.filterwarnings("ignore", module="pydicom")
PRINT_SEGMENTS = os.environ["PRINT_SEGMENTS"]
SEGMENTATION, LABEL_MAP = "1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7"
LPS = numpy.diag([-1, -1, 1, 1])


def nested(*items):
    return Sequence(list(items))


def data_set(**elements):
    made = Dataset()
    for keyword, value in elements.items():
        setattr(made, keyword, value)
    return made


def code(value, scheme, meaning, **more):
    return data_set(CodeValue=value, CodingSchemeDesignator=scheme, CodeMeaning=meaning, **more)


def segment(number, label, **more):
    return data_set(SegmentNumber=number, SegmentLabel=label, SegmentAlgorithmType="MANUAL", **more)


def decimal(number):
    """At most 16 characters, as a decimal string has."""
    return pydicom.valuerep.DSfloat(float(number), auto_format=True)


class Frame:
    """One frame: pixels by (row, column), a place in LPS, a segment's number."""

    def __init__(self, pixels, place, number):
        self.pixels, self.place, self.number = pixels, place, number

    def groups(self):
        made = data_set(PlanePositionSequence=nested(data_set(ImagePositionPatient=[decimal(c) for c in self.place])))
        if self.number:
            made.SegmentIdentificationSequence = nested(data_set(ReferencedSegmentNumber=self.number))
        return made


def frames_of(mask, affine, number, empty=False):
    """The slices of a mask by (x, y, z), those without a voxel only if they are wanted."""
    lps = LPS @ affine
    return [Frame(mask[:, :, z].T.astype(numpy.uint8), (lps @ [0, 0, z, 1])[:3], number)
            for z in range(mask.shape[2]) if empty or mask[:, :, z].any()]


def pack(frames, bits):
    pixels = numpy.concatenate([frame.pixels.ravel() for frame in frames])
    packed = numpy.packbits(pixels, bitorder="little") if bits == 1 else pixels.astype(f"<u{bits // 8}")
    data = packed.tobytes()
    return data + b"\0" * (len(data) % 2)


def build(frames, segments, affine, kind="BINARY", bits=1, shared=True, **more):
    """A data set; shared: what is the same for all frames is said once. Options None leave an element out."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = LABEL_MAP if kind == "LABELMAP" else SEGMENTATION
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    lps = (LPS @ affine)[:3, :3]
    lengths = numpy.linalg.norm(lps, axis=0)
    directions = lps / lengths
    rows, columns = frames[0].pixels.shape
    made = data_set(
        file_meta=meta, is_little_endian=True, is_implicit_VR=False, preamble=b"\0" * 128,
        SOPClassUID=meta.MediaStorageSOPClassUID, SOPInstanceUID=meta.MediaStorageSOPInstanceUID, Modality="SEG",
        PatientName="Nobody^Knows", PatientID="4711-0815", StudyDescription="Private matters",
        SpecificCharacterSet="ISO_IR 192", SamplesPerPixel=1, PhotometricInterpretation="MONOCHROME2",
        NumberOfFrames=len(frames), Rows=rows, Columns=columns, BitsAllocated=bits, BitsStored=bits, HighBit=bits - 1,
        PixelRepresentation=0, SegmentationType=kind, SegmentSequence=nested(*segments))
    orientation = nested(data_set(
        ImageOrientationPatient=[decimal(c) for c in (*directions[:, 0], *directions[:, 1])]))
    measures = data_set(PixelSpacing=[decimal(lengths[1]), decimal(lengths[0])], SliceThickness=decimal(lengths[2]),
                        SpacingBetweenSlices=decimal(lengths[2]))
    for keyword in ("SliceThickness", "SpacingBetweenSlices", "PixelSpacing"):
        if keyword in more and (value := more.pop(keyword)) is not None:
            setattr(measures, keyword, value)
        elif keyword not in more and keyword in more.get("without", ()):
            delattr(measures, keyword)
    without = more.pop("without", ())
    groups = [frame.groups() for frame in frames]
    common = data_set()
    for target in [common] if shared else groups:
        target.PlaneOrientationSequence = orientation
        target.PixelMeasuresSequence = nested(measures)
    made.SharedFunctionalGroupsSequence = nested(common)
    made.PerFrameFunctionalGroupsSequence = nested(*groups)
    made.PixelData = pack(frames, bits)
    made["PixelData"].VR = "OB" if bits <= 8 else "OW"
    for keyword, value in more.items():
        setattr(made, keyword, value)
    for keyword in without:
        if keyword in made:
            delattr(made, keyword)
    return made


def save(made, path):
    made.save_as(str(path), write_like_original=False)
    return path


def convert(tool, source, target, *options):
    subprocess.run([tool, *options, str(source), str(target)], check=True, capture_output=True)
    return target


class Reading:
    """What print_segments says of a file."""

    def __init__(self, path, *tool, **limited):
        run = subprocess.run([PRINT_SEGMENTS, str(path), *map(str, tool)], capture_output=True, timeout=300, **limited)
        assert run.returncode == 0, run.stderr.decode()
        self.labels, self.names, self.warnings, self.refusal = {}, {}, [], None
        for line in run.stdout.decode("utf-8", "replace").splitlines():
            word, rest = line.split(" ", 1)
            if word == "refused":
                self.refusal = rest.split(" ", 1)[1]
            elif word == "extent":
                self.extent = [int(n) for n in rest.split()]
            elif word == "affine":
                self.affine = numpy.vstack([numpy.array([float(n) for n in rest.split()]).reshape(3, 4), [0, 0, 0, 1]])
            elif word == "warning":
                self.warnings.append(rest)
            else:
                voxels, volume, x, y, z, digest, name = rest.split(" ", 6)
                self.labels[int(word)] = (int(voxels), float(volume), (float(x), float(y), float(z)), digest)
                self.names[int(word)] = name


def expected(mask, affine):
    """Voxels, volume and centroid of a mask by (x, y, z)."""
    index = numpy.argwhere(mask)
    return (len(index), len(index) * abs(numpy.linalg.det(affine[:3, :3])),
            tuple(affine[:3, :3] @ index.mean(axis=0) + affine[:3, 3]))
