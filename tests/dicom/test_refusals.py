"""Every bad file has its sentence."""
import gzip
import pathlib
import tempfile
import unittest

from segmentation import *

PLAIN = numpy.diag([-1.0, -1.0, 1.0, 1.0])
MASK = numpy.ones((5, 4, 3), bool)


def good(**more):
    return build(frames_of(MASK, PLAIN, 1), [segment(1, "s")], PLAIN, **more)


def groups(made, frame):
    return made.PerFrameFunctionalGroupsSequence[frame]


class Refusals(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name) / "segmentation.dcm"

    def refusal(self, made):
        return Reading(save(made, self.path)).refusal

    def assert_refused(self, sentence, change, **more):
        made = good(**more)
        change(made)
        self.assertEqual(sentence, self.refusal(made))

    def test_a_good_one_is_read(self):
        self.assertIsNone(self.refusal(good()))

    def test_other_classes(self):
        def become_an_image(made):
            made.SOPClassUID = made.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
        self.assert_refused(
            "the DICOM file is of class 1.2.840.10008.5.1.4.1.1.2, expected a segmentation, 1.2.840.10008.5.1.4.1.1.66.4 "
            "or 1.2.840.10008.5.1.4.1.1.66.7", become_an_image)

    def test_what_is_missing(self):
        for change, sentence in (
                (lambda m: groups(m, 1).pop("PlanePositionSequence"), "frame 2 has no position (ImagePositionPatient)"),
                (lambda m: m.SharedFunctionalGroupsSequence[0].pop("PlaneOrientationSequence"),
                 "frame 1 has no orientation (ImageOrientationPatient)"),
                (lambda m: m.SharedFunctionalGroupsSequence[0].pop("PixelMeasuresSequence"),
                 "frame 1 has no spacing (PixelSpacing)"),
                (lambda m: m.pop("PixelData"), "the DICOM file has no pixel data"),
                (lambda m: m.pop("PerFrameFunctionalGroupsSequence"),
                 "the segmentation has 3 frames and the places of 0, expected as many, and one at least"),
                (lambda m: groups(m, 2).pop("SegmentIdentificationSequence"),
                 "frame 3 is of segment 0, which is not described"),
                (lambda m: m.SegmentSequence[0].pop("SegmentNumber"),
                 "segment 1 of the segmentation has no number from 1 on")):
            self.assert_refused(sentence, change)

    def test_what_contradicts_itself(self):
        def orient(made, values):
            made.SharedFunctionalGroupsSequence[0].PlaneOrientationSequence[0].ImageOrientationPatient = values

        def space(made, values):
            made.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0].PixelSpacing = values

        def move(made, frame, place):
            groups(made, frame).PlanePositionSequence[0].ImagePositionPatient = place

        def turn_one(made):
            groups(made, 2).PlaneOrientationSequence = nested(data_set(ImageOrientationPatient=[0, 1, 0, 1, 0, 0]))
        for change, sentence in (
                (lambda m: setattr(m, "NumberOfFrames", 4),
                 "the segmentation has 4 frames and the places of 3, expected as many, and one at least"),
                (lambda m: setattr(m, "Rows", 5), "the pixels of 3 frames of 5 x 5 have 8 bytes, expected 10"),
                (lambda m: setattr(m, "Rows", 0), "the segmentation has 0 rows and 5 columns"),
                (lambda m: setattr(m, "BitsAllocated", 8),
                 "the segmentation has pixels of 1 x 8 bits, expected one of 1 bit"),
                (lambda m: setattr(m, "SamplesPerPixel", 3),
                 "the segmentation has pixels of 3 x 1 bits, expected one of 1 bit"),
                (lambda m: setattr(m, "SegmentationType", "SURFACE"),
                 'the segmentation is of type "SURFACE", expected BINARY, FRACTIONAL or LABELMAP'),
                (lambda m: m.SegmentSequence.append(m.SegmentSequence[0]), "two segments have the number 1"),
                (lambda m: orient(m, [1, 0, 0, 1, 0, 0]),
                 "ImageOrientationPatient has vectors of length 1 and 1 and product 1, expected 1, 1 and 0"),
                (lambda m: orient(m, [2, 0, 0, 0, 1, 0]),
                 "ImageOrientationPatient has vectors of length 2 and 1 and product 0, expected 1, 1 and 0"),
                (lambda m: space(m, [0, 1]), "PixelSpacing is 0 and 1, expected positive numbers"),
                (lambda m: space(m, [1]), "DICOM element (0028,0030) is no list of numbers"),
                (lambda m: move(m, 2, [0, 0, 2e6]), "frame 3 is at 2e+06 mm, expected a place within 1e+06"),
                (lambda m: move(m, 2, [0, 0, 1]),
                 "frames 2 and 3 are of the same segment in the same slice, expected one"),
                (lambda m: move(m, 2, [0, 0, 2.4]),
                 "the slice of frame 2 is at 1 mm, expected slices that are evenly 1.2 mm apart"),
                (lambda m: move(m, 2, [0.5, 0, 2]),
                 "frame 3 lies 0.5 pixels beside frame 1, expected a whole number: slices that shift, as of a tilted gantry, are "
                 "to be resampled first"),
                (lambda m: move(m, 2, [1e5, 0, 2]),
                 "the frames reach over 100005 x 4 x 3 voxels, expected at most 65535 each way"),
                (turn_one, "frame 3 has an orientation or spacing other than frame 1, expected one grid")):
            self.assert_refused(sentence, change)

    def test_a_single_slice_without_thickness(self):
        made = build(frames_of(MASK[:, :, :1], PLAIN, 1), [segment(1, "s")], PLAIN,
                     without=("SliceThickness", "SpacingBetweenSlices"))
        self.assertEqual("all frames are in one slice, which has neither SpacingBetweenSlices nor SliceThickness",
                         self.refusal(made))

    def test_nothing_in_it(self):
        def empty(made):
            made.PixelData = bytes(8)
        self.assert_refused("no voxel has a wanted label", empty)

    def test_damaged_files(self):
        save(good(), self.path)
        whole = self.path.read_bytes()
        for size in [*range(132, len(whole), 97), len(whole) - 1]:
            self.path.write_bytes(whole[:size])
            reading = Reading(self.path)
            self.assertRegex(reading.refusal, "could not decode the DICOM file|has no pixel data|breaks off", size)

    def test_damaged_gzip(self):
        whole = gzip.compress(save(good(), self.path).read_bytes())
        for damaged in whole[:-9], whole[:-5] + b"\0" + whole[-4:], whole + b"more":
            self.path.write_bytes(damaged)
            self.assertIn("/usr/bin/gzip could not decode the DICOM file: it is damaged", Reading(self.path).refusal)

    def test_a_gzip_bomb(self):
        with gzip.open(self.path, "wb") as file:
            file.write(bytes(128) + b"DICM")
            for _ in range(257):
                file.write(bytes(1 << 20))
        self.assertEqual("the DICOM file is gzipped and has more than 268435456 bytes, expected it without gzip",
                         Reading(self.path).refusal)

    def test_flipped_bytes_never_do_harm(self):
        save(good(), self.path)
        whole = bytearray(self.path.read_bytes())
        generator = numpy.random.default_rng(1)
        for _ in range(150):
            damaged = bytearray(whole)
            for place in generator.integers(132, len(whole), 3):
                damaged[place] = generator.integers(256)
            self.path.write_bytes(damaged)
            Reading(self.path)

    def test_other_compression(self):
        made = good()
        made.file_meta.TransferSyntaxUID = pydicom.uid.JPEG2000Lossless
        made.PixelData = pydicom.encaps.encapsulate([b"\xff\x4f\xff\x51" * 4] * 3)
        made["PixelData"].is_undefined_length = True
        self.assert_compressed(made)

    def test_run_lengths_of_bits(self):
        made = good()
        made.file_meta.TransferSyntaxUID = pydicom.uid.RLELossless
        made.PixelData = pydicom.encaps.encapsulate([b"\1\0\0\0\x40" + bytes(59) + b"\0\xff\0\xff"] * 3)
        made["PixelData"].is_undefined_length = True
        self.assert_compressed(made)

    def test_jpeg(self):
        plain = save(build(frames_of(MASK, PLAIN, 1), [segment(1, "s")], PLAIN, kind="LABELMAP", bits=8), self.path)
        for there, back in (("dcmcjpeg", "dcmdjpeg"), ("dcmcjpls", "dcmdjpls")):
            compressed = convert(there, plain, self.path.with_suffix(".compressed"))
            self.assertIn("which dcmdjpeg or dcmdjpls of DCMTK may undo", Reading(compressed).refusal)
            undone = convert(back, compressed, self.path.with_suffix(".undone"))
            self.assertEqual(Reading(plain).labels, Reading(undone).labels)

    def assert_compressed(self, made):
        self.assertIn("is compressed other than by deflation, or by run lengths of whole bytes", self.refusal(made))


if __name__ == "__main__":
    unittest.main()
