"""Segmentations as the label maps that they were made of, by count, volume, place and hand."""
import gzip
import io
import pathlib
import random
import tempfile
import unittest

from segmentation import *

try:
    import nibabel
except ImportError:
    nibabel = None

MAPS = pathlib.Path(__file__).parents[3] / "shared/data/maps"
PLAIN = numpy.diag([-1.0, -1.0, 1.0, 1.0])


def box(shape, *corners):
    mask = numpy.zeros(shape, bool)
    mask[tuple(slice(low, high) for low, high in corners)] = True
    return mask


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name) / "segmentation.dcm"

    def read(self, made, *tool):
        return Reading(save(made, self.path), *tool)

    def assert_masks(self, reading, masks, affine):
        """A cloud's offset is rounded to a 1/1024 of the power of two below the largest entry of its matrix."""
        self.assertIsNone(reading.refusal)
        self.assertEqual(sorted(masks), sorted(reading.labels))
        for number, mask in masks.items():
            voxels, volume, centroid = expected(mask, affine)
            self.assertEqual(voxels, reading.labels[number][0])
            self.assertAlmostEqual(1, reading.labels[number][1] / volume, 6)
            for got, wanted in zip(reading.labels[number][2], centroid):
                self.assertAlmostEqual(wanted, got, delta=abs(affine[:3, :3]).max() / 1000)


@unittest.skipUnless(nibabel and MAPS.is_dir(), "no real label maps")
class RealMaps(Case):
    def test_label_maps_are_the_same_clouds_as_from_nifti(self):
        for path in sorted(MAPS.glob("*.nii.gz")):
            image = nibabel.load(path)
            labels = numpy.asarray(image.dataobj)
            numbers = [int(n) for n in numpy.unique(labels) if n]
            masks = {n: labels == n for n in numbers}
            frames = [f for n in numbers for f in frames_of(masks[n], image.affine, n)]
            random.Random(1).shuffle(frames)
            reading = self.read(build(frames, [segment(n, f"bone {n}") for n in numbers], image.affine))
            self.assert_masks(reading, masks, image.affine)
            self.assertEqual([], reading.warnings)
            nifti = Reading(path)
            self.assertEqual({n: nifti.labels[n][3] for n in numbers}, {n: reading.labels[n][3] for n in numbers})


class Geometry(Case):
    def random_masks(self, generator, shape):
        values = generator.integers(0, 8, shape)
        return {1: values > 5, 2: (values > 4) & (values < 7), 700: values == 0}

    def test_any_orientation_spacing_and_hand_gives_the_same_places(self):
        generator = numpy.random.default_rng(5)
        for _ in range(25):
            shape = generator.integers(1, 21, 3) + [0, 0, 1]
            rotation, _ = numpy.linalg.qr(generator.normal(size=(3, 3)))  # of either hand
            affine = numpy.eye(4)
            affine[:3, :3] = rotation * generator.uniform(0.2, 3, 3)
            affine[:3, 3] = generator.uniform(-300, 300, 3)
            masks = {n: m for n, m in self.random_masks(generator, shape).items() if m.any()}
            frames = [f for n, m in masks.items() for f in frames_of(m, affine, n, empty=True)]
            generator.shuffle(frames)
            shared = bool(generator.integers(2))
            reading = self.read(build(frames, [segment(n, "s") for n in masks], affine, shared=shared))
            self.assert_masks(reading, masks, affine)

    def test_a_rotated_affine_is_found_again(self):
        turn = numpy.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
        affine = numpy.eye(4)
        affine[:3, :3] = turn @ numpy.diag([-0.5, -0.75, 2])
        affine[:3, 3] = [10, 20, 30]
        reading = self.read(build(frames_of(box((7, 5, 4), (1, 6), (0, 3), (0, 4)), affine, 1), [segment(1, "s")], affine))
        numpy.testing.assert_allclose(reading.affine, affine, atol=1e-9)
        self.assertEqual([7, 5, 4], reading.extent)

    def test_segments_may_overlap(self):
        masks = {1: box((9, 9, 9), (0, 6), (0, 6), (0, 6)), 2: box((9, 9, 9), (3, 9), (3, 9), (3, 9)),
                 3: box((9, 9, 9), (4, 5), (0, 9), (0, 9))}
        frames = [f for n, m in masks.items() for f in frames_of(m, PLAIN, n)]
        self.assert_masks(self.read(build(frames, [segment(n, "s") for n in masks], PLAIN)), masks, PLAIN)

    def test_slices_left_out_leave_a_gap(self):
        mask = box((6, 6, 30), (1, 5), (1, 5), (0, 30))
        mask[:, :, [3, 4, 5, 6, 7, 20]] = False
        affine = numpy.diag([-1, -1, 0.703125, 1])
        for options in ({}, {"without": ("SpacingBetweenSlices",)}):
            reading = self.read(build(frames_of(mask, affine, 1), [segment(1, "s")], affine, **options))
            self.assert_masks(reading, {1: mask}, affine)
            self.assertEqual([], reading.warnings)

    def test_the_spacing_that_is_said_counts_where_it_divides_every_distance(self):
        mask = box((6, 6, 9), (1, 5), (1, 5), (0, 9))
        mask[:, :, 1::2] = False
        reading = self.read(build(frames_of(mask, PLAIN, 1), [segment(1, "s")], PLAIN))
        self.assert_masks(reading, {1: mask}, PLAIN)
        reading = self.read(build(frames_of(mask, PLAIN, 1), [segment(1, "s")], PLAIN, without=("SpacingBetweenSlices",)))
        self.assertEqual(5 * 16 * 2, reading.labels[1][1])
        self.assertEqual(["slice_distance slices are 2 mm apart and 1 mm thick: if some are left out, objects are too thick"],
                         reading.warnings)

    def test_a_spacing_that_positions_contradict_is_a_warning(self):
        mask = box((6, 6, 9), (1, 5), (1, 5), (0, 9))
        reading = self.read(build(frames_of(mask, PLAIN, 1), [segment(1, "s")], PLAIN, SpacingBetweenSlices=5))
        self.assert_masks(reading, {1: mask}, PLAIN)
        self.assertEqual(["slice_distance SpacingBetweenSlices is 5 mm, but the slices are 1 mm apart, which is taken"],
                         reading.warnings)

    def test_a_single_slice_is_as_thick_as_it_says(self):
        mask, affine = box((6, 6, 1), (1, 5), (1, 5), (0, 1)), numpy.diag([-1, -1, 2.5, 1])
        reading = self.read(build(frames_of(mask, affine, 1), [segment(1, "s")], affine))
        self.assert_masks(reading, {1: mask}, affine)
        self.assertEqual(["slice_distance all frames are in one slice: its thickness is taken from the file, 2.5 mm"],
                         reading.warnings)

    def test_frames_may_lie_anywhere_in_one_grid(self):
        mask = box((20, 16, 5), (2, 9), (3, 8), (0, 2)) | box((20, 16, 5), (11, 18), (9, 15), (2, 5))
        affine = numpy.diag([-0.5, -0.8, 2, 1])
        frames = []
        for z in range(5):
            x, y = (1, 2) if z < 2 else (10, 7)
            place = LPS @ affine @ [x, y, z, 1]
            frames.append(Frame(mask[x:x + 9, y:y + 9, z].T.astype(numpy.uint8), place[:3], 1))
        reading = self.read(build(frames, [segment(1, "s")], affine))
        self.assert_masks(reading, {1: mask}, affine)
        self.assertEqual([18, 14, 5], reading.extent)


class Encodings(Case):
    def setUp(self):
        super().setUp()
        generator = numpy.random.default_rng(2)
        self.masks = {1: generator.random((13, 11, 7)) > 0.5, 2: generator.random((13, 11, 7)) > 0.8}
        self.frames = [f for n, m in self.masks.items() for f in frames_of(m, PLAIN, n)]
        self.segments = [segment(1, "one"), segment(2, "two")]
        self.other = pathlib.Path(self.folder.name) / "other.dcm"

    def test_every_uncompressed_and_the_deflated_transfer_syntax(self):
        save(build(self.frames, self.segments, PLAIN), self.path)
        for option in ("+te", "+tb", "+ti", "+td"):
            for lengths in ("+e", "-e"):
                reading = Reading(convert("dcmconv", self.path, self.other, option, lengths))
                self.assert_masks(reading, self.masks, PLAIN)

    def test_gzipped_files(self):
        plain = save(build(self.frames, self.segments, PLAIN), self.path)
        whole = plain.read_bytes()
        long_name = io.BytesIO()
        with gzip.GzipFile("n" * 700, "wb", fileobj=long_name) as file:
            file.write(whole)
        for gzipped in gzip.compress(whole), gzip.compress(whole, 0), long_name.getvalue():
            self.other.write_bytes(gzipped)
            self.assertEqual(Reading(plain).labels, Reading(self.other).labels)

    def fractional(self, most, value):
        frames = [Frame(f.pixels * value, f.place, f.number) for f in self.frames]
        return build(frames, self.segments, PLAIN, "FRACTIONAL", 8, SegmentationFractionalType="PROBABILITY",
                     MaximumFractionalValue=most)

    def test_run_lengths(self):
        save(self.fractional(255, 255), self.path)
        self.assert_masks(Reading(convert("dcmcrle", self.path, self.other)), self.masks, PLAIN)

    def test_fractions_of_0_and_1_only(self):
        self.assert_masks(self.read(self.fractional(100, 100)), self.masks, PLAIN)
        self.assertIn("has the fraction 99 of 100, expected 0 or 100", self.read(self.fractional(100, 99)).refusal)

    def test_label_maps_of_8_and_16_bits(self):
        for bits, numbers in ((8, (1, 200)), (16, (1, 700))):
            values = numpy.random.default_rng(3).choice([0, *numbers], (13, 11, 7))
            frames = [Frame(values[:, :, z].T, (0, 0, z), 0) for z in range(7)]
            segments = [segment(0, "background")] + [segment(n, f"label {n}") for n in numbers]
            reading = self.read(build(frames, segments, PLAIN, "LABELMAP", bits))
            self.assert_masks(reading, {n: values == n for n in numbers}, PLAIN)
            self.assertEqual(f"label {numbers[1]}", reading.names[numbers[1]])

    def test_a_file_of_a_hundred_megabytes(self):
        shape = (512, 512, 3200)
        frame = numpy.zeros(shape[:2], numpy.uint8)
        frame[100:200, 50:400] = 1
        frames = [Frame(frame.T, (0, 0, z), 1) for z in range(shape[2])]
        reading = self.read(build(frames, [segment(1, "s")], PLAIN))
        self.assertEqual(100 * 350 * 3200, reading.labels[1][0])
        self.assertGreater(self.path.stat().st_size, 100 << 20)


class Names(Case):
    LEFT = [("G-A101", "SRT", "Left"), ("7771000", "SCT", "Left"), ("x", "99X", "left")]
    RIGHT = [("G-A100", "SRT", "Right"), ("24028007", "SCT", "Right"), ("24028007", "SCT", "Dexter")]

    def name(self, label, character_set="ISO_IR 192", **more):
        mask = box((6, 6, 2), (1, 5), (1, 5), (0, 2))
        return self.read(build(frames_of(mask, PLAIN, 1), [segment(1, label, **more)], PLAIN,
                               SpecificCharacterSet=character_set)).names[1]

    def type(self, meaning, *modifier):
        modifiers = {"SegmentedPropertyTypeModifierCodeSequence": nested(code(*modifier))} if modifier else {}
        return {"SegmentedPropertyTypeCodeSequence": nested(code("T-1", "SRT", meaning, **modifiers))}

    def region(self, meaning, *modifier):
        modifiers = {"AnatomicRegionModifierSequence": nested(code(*modifier))} if modifier else {}
        return {"AnatomicRegionSequence": nested(code("T-2", "SRT", meaning, **modifiers))}

    def test_a_label_is_the_name(self):
        self.assertEqual("Talus", self.name("Talus", **self.type("Bone"), **self.region("Foot")))

    def test_the_side_is_added_unless_the_name_says_it(self):
        for modifier in self.LEFT:
            self.assertEqual("Talus left", self.name("Talus", **self.type("Bone", *modifier)))
            self.assertEqual("Talus left", self.name("Talus", **self.region("Foot", *modifier)))
        for modifier in self.RIGHT:
            self.assertEqual("Talus right", self.name("Talus", **self.type("Bone", *modifier)))
            self.assertEqual("Right talus", self.name("Right talus", **self.type("Bone", *modifier)))
        self.assertEqual("Lungs", self.name("Lungs", **self.type("Lung", "51440002", "SCT", "Right and left")))

    def test_what_nobody_named_is_called_by_region_or_type(self):
        self.assertEqual("Kidney left", self.name("Segment_1", **self.type("Organ"), **self.region("Kidney", *self.LEFT[0])))
        self.assertEqual("Femur", self.name("", **self.type("Femur")))
        self.assertEqual("", self.name("Segment 12", **self.type("Tissue")))

    def test_character_sets(self):
        self.assertEqual("Schädel", self.name("Schädel"))
        self.assertEqual("Schädel", self.name("Schädel", "ISO_IR 100"))

    def test_long_names_are_cut_before_a_character(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.assertEqual("ä" * 95, self.name("ä" * 150))


if __name__ == "__main__":
    unittest.main()
