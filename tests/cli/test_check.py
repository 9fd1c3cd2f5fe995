"""eskel check: what it finds in maps with planted errors, and its exit codes."""
import json
import os
import unittest

import numpy

from support import NOWHERE, Served, ball, hook, side_by_side, write_nifti

try:
    import nibabel
except ImportError:
    nibabel = None

TABLE = "label,name,class,side\n1,hook_left,hook,left\n2,hook_right,hook,right\n3,ball,ball,none\n"
MAPS = os.path.join(os.path.dirname(__file__), "../../../shared/data/maps")
RANK = {"note": 0, "warning": 1, "error": 2}


def findings(run, least="warning"):
    """{label: {code: finding}} of a run with --json, from a severity on."""
    return {label["label"]: {f["code"]: f for f in label["findings"] if RANK[f["severity"]] >= RANK[least]}
            for label in json.loads(run.stdout)["labels"]}


class Hooks(Served):
    """A library of a hook, its mirror image and a ball, all of one person."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.volume, cls.table = cls.path("hooks.nii.gz"), cls.write("labels.csv", TABLE)
        write_nifti(cls.volume, side_by_side(hook(), hook()[::-1], ball(9)))
        cls.rows(cls.eskel("enroll", cls.volume, "--labels", cls.table, "--subject", "S1"))

    def check(self, volume, table, *options):
        return self.eskel("check", volume, "--labels", self.write("checked.csv", table), *options)

    def test_nothing_found_is_exit_code_0(self):
        run = self.check(self.volume, TABLE)
        rows = self.rows(run)
        self.assertEqual([(row["name"], row["says"], row["looks like"], row["findings"]) for row in rows],
                         [("hook_left", "hook", "hook", "-"), ("hook_right", "hook", "hook", "-"),
                          ("ball", "ball", "ball", "-")])
        self.assertIn("\nhooks.nii.gz: labels 3, errors 0, warnings 0, notes 0\n", run.stdout)

    def test_findings_are_exit_code_1(self):
        run = self.check(self.volume, TABLE.replace("1,hook_left,hook,left", "1,hook_right,hook,right"))
        self.assertEqual((run.returncode, run.stderr), (1, ""))
        self.assertRegex(run.stdout, r"(?m)^ +1  hook_right  hook  right .* swapped_side$")
        self.assertRegex(run.stdout, r"(?m)^label 1 \(hook_right\): error swapped_side: the label says right, the shape says left")

    def test_exchanged_labels_name_each_other(self):
        run = self.check(self.volume, "label,name\n1,ball\n2,hook_right\n3,hook_left\n", "--json")
        self.assertEqual(run.returncode, 1)
        found = findings(run)
        self.assertEqual((found[1]["swapped_labels"]["partner"], found[3]["swapped_labels"]["partner"]), (3, 1))
        self.assertEqual(found[2], {})

    def test_notes_alone_are_exit_code_0(self):
        run = self.check(self.volume, "label,name\n1,left hook\n2,Hook (right)\n3,unicorn\n", "--json", "--label", 1, "--label", 2)
        self.assertEqual((run.returncode, findings(run, "note")), (0, {1: {}, 2: {}}))

    def test_of_several_maps_the_worst_is_told(self):
        bad = self.write("none.nii", "no volume")
        run = self.eskel("check", self.volume, bad, "--labels", self.table)
        self.assertEqual(run.returncode, 2)
        self.assertIn("hooks.nii.gz: labels 3", run.stdout)
        self.assertRegex(run.stderr, rf"(?m)^eskel: {bad}: \S")

    def test_what_is_refused_is_exit_code_2_and_nobody_there_is_3(self):
        self.assert_run(self.eskel("check", self.volume, "--mode", "psychic"), 2, "psychic")
        self.assert_run(self.eskel("check", self.volume, "--label", 9), 2, "9")
        self.assert_run(self.eskel("check", "/nonexistent.nii"), 2, "/nonexistent.nii")
        self.assert_run(self.eskel("check"), 2, "eskel check takes FILE...")
        self.assert_run(self.eskel("check", self.volume, "--server", NOWHERE), 3)


@unittest.skipUnless(nibabel and os.path.isdir(MAPS), "there is no nibabel or no " + MAPS)
class Feet(Served):
    """The feet of a woman beside those of a man. Everything planted is found; the clean map has no finding but a note."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        enrolled = cls.eskel("enroll", os.path.join(MAPS, "VHM_feet.nii.gz"), "--subject", "VHM", "--labels",
                             os.path.join(MAPS, "VHM_feet_labels.csv"))
        cls.rows(enrolled)
        cls.image = nibabel.load(os.path.join(MAPS, "VHF_feet.nii.gz"))
        cls.voxels = numpy.asarray(cls.image.dataobj).astype(numpy.int16)
        cls.table = os.path.join(MAPS, "VHF_feet_labels.csv")
        with open(cls.table, encoding="utf-8") as file:
            cls.labels = {line.split(",")[1]: int(line.split(",")[0]) for line in file.readlines()[1:]}

    def check(self, voxels, table=None):
        path = self.path("planted.nii.gz")
        nibabel.save(nibabel.Nifti1Image(voxels, self.image.affine), path)
        return self.eskel("check", path, "--labels", table or self.table, "--json")

    def planted(self, name, voxels, code):
        run = self.check(voxels)
        self.assertEqual(run.returncode, 1)
        self.assertIn(code, findings(run)[self.labels[name]])
        return findings(run)

    def only(self, name, found):
        self.assertEqual({label for label, codes in found.items() if codes}, {self.labels[name]})

    def box(self, name):
        """Where a bone begins and ends on each axis, and the longest axis."""
        places = numpy.argwhere(self.voxels == self.labels[name])
        low, high = places.min(0), places.max(0) + 1
        return low, high, int((high - low).argmax())

    def without(self, name, axis, first, last):
        """A slab of a bone cleared."""
        voxels = self.voxels.copy()
        slab = [slice(None)] * 3
        slab[axis] = slice(first, last)
        part = voxels[tuple(slab)]
        part[part == self.labels[name]] = 0
        return voxels

    def renamed(self, names):
        """The table with other names for some labels."""
        rows = "".join(f"{label},{names.get(name, name)}\n" for name, label in self.labels.items())
        return self.write("renamed.csv", "label,name\n" + rows)

    def test_a_clean_map_has_no_findings(self):
        run = self.check(self.voxels)
        self.assertEqual(run.returncode, 0)
        self.assertEqual(json.loads(run.stdout)["findings"], {"error": 0, "warning": 0, "note": 1})

    def test_exchanged_names_are_found(self):
        for a, b in (("talus_L", "navicular_R"), ("calcaneus_L", "calcaneus_R"), ("cuboid_L", "medial_cuneiform_L"),
                     ("talus_R", "talus_L")):
            with self.subTest(a=a, b=b):
                found = findings(self.check(self.voxels, self.renamed({a: b, b: a})))
                self.assertEqual(found[self.labels[a]]["swapped_labels"]["partner"], self.labels[b])
                self.assertEqual(found[self.labels[b]]["swapped_labels"]["partner"], self.labels[a])
                self.assertEqual(sum(map(len, found.values())), 2)

    def test_a_wrong_name_and_a_wrong_side_are_found(self):
        found = findings(self.check(self.voxels, self.renamed({"talus_L": "cuboid_L", "calcaneus_R": "calcaneus_L"})))
        self.assertIn("wrong_class", found[self.labels["talus_L"]])
        self.assertIn("swapped_side", found[self.labels["calcaneus_R"]])

    def test_a_mirrored_map_is_all_wrong_sides(self):
        """The voxels turned from left to right and the affine left as it is: a common mistake of conversion."""
        found = findings(self.check(numpy.ascontiguousarray(self.voxels[::-1])))
        swapped = [label for label, codes in found.items() if "swapped_labels" in codes or "swapped_side" in codes]
        self.assertGreaterEqual(len(swapped), 12)

    def test_two_bones_under_one_label_are_merged(self):
        voxels = self.voxels.copy()
        voxels[voxels == self.labels["talus_R"]] = self.labels["calcaneus_R"]
        self.only("calcaneus_R", self.planted("calcaneus_R", voxels, "merged"))

    def test_a_bone_that_is_cut_off_touches_the_border(self):
        low, high, axis = self.box("calcaneus_L")
        voxels = self.voxels.copy()
        cut = [slice(None)] * 3
        cut[axis] = slice(low[axis] + (high[axis] - low[axis]) // 3, None)
        self.planted("calcaneus_L", numpy.ascontiguousarray(voxels[tuple(cut)]), "touches_border")

    def test_a_broken_bone_is_fragmented(self):
        low, high, axis = self.box("talus_L")
        middle = (low[axis] + high[axis]) // 2
        self.only("talus_L", self.planted("talus_L", self.without("talus_L", axis, middle, middle + 3), "fragmented"))

    def test_a_hollow_bone_has_holes(self):
        voxels, low, high = self.voxels.copy(), *self.box("calcaneus_L")[:2]
        at = numpy.indices(voxels.shape) - ((low + high) // 2).reshape(3, 1, 1, 1)
        voxels[((at ** 2).sum(0) <= 8 ** 2) & (voxels == self.labels["calcaneus_L"])] = 0
        self.only("calcaneus_L", self.planted("calcaneus_L", voxels, "holes"))

    def test_what_is_left_of_a_bone_is_too_little(self):
        low, high, axis = self.box("navicular_L")
        voxels = self.without("navicular_L", axis, low[axis] + 3, high[axis])
        found = self.planted("navicular_L", voxels, "implausible_volume")
        self.only("navicular_L", found)


if __name__ == "__main__":
    unittest.main()
