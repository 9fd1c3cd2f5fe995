"""Every command against a server: what it answers, and with which exit code."""
import gzip
import json
import re
import struct
import subprocess
import unittest
import xml.dom.minidom
import xml.etree.ElementTree

import numpy

from support import ESKELD, Served, ball, hook, side_by_side, write_nifti

TABLE = "label,name,class,side\n1,hook_left,hook,left\n2,hook_right,hook,right\n3,ball,ball,none\n"

OTHER_TABLES = {
    "ITK-SNAP": """\
################################################
# ITK-SnAP Label Description File
# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL
################################################
    0     0    0    0        0  0  0    "Clear Label"
    1   255    0    0        1  1  1    "Left-Hippocampus"
    2     0  255    0      0.5  1  0    "femur_right"
    3     0    0  255        1  0  1    "sacrum"
""",
    "FreeSurfer": """\
#$Id: FreeSurferColorLUT.txt $

#No. Label Name:                            R   G   B   A
0   Unknown                                 0   0   0   0
1   Left-Hippocampus                        220 216 20  0
2   femur_right                             0   255 0   0\r
3   sacrum                                  0   0   255 0""",
    "3D Slicer": """\
# Color table file segmentation.ctbl
# 4 values
0 Background 0 0 0 0
1 Left-Hippocampus 128 174 128 255
2 femur_right 241 214 145 255
3 sacrum 177 122 101 255
""",
    "BIDS": "index\tname\tabbreviation\tcolor\tmapping\n0\tBackground\tn/a\tn/a\t0\n"
            "1\tLeft-Hippocampus\tHL\t#ff0000\t17\n2\tfemur_right\tn/a\tn/a\tn/a\n3\tsacrum\tS\t#00ff00\t1\n",
    "BIDS with sides": "index\tname\tside\n1\tLeft-Hippocampus\tn/a\n2\tfemur_right\tn/a\n3\tsacrum\tnone\n",
}


class Commands(Served):
    """A library of a hook, its mirror image and a ball."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.volume, cls.table = cls.path("hooks.nii.gz"), cls.write("labels.csv", TABLE)
        write_nifti(cls.volume, side_by_side(hook(), hook()[::-1], ball(9)))
        cls.enrolled = cls.eskel("enroll", cls.volume, "--labels", cls.table, "--subject", "S1")
        cls.ids = {row["name"]: row["id"] for row in cls.rows(cls.enrolled)}

    def test_enrolled_shapes_have_the_names_of_the_table(self):
        rows = self.rows(self.enrolled)
        self.assertEqual([(r["label"], r["name"], r["class"], r["side"], r["subject"]) for r in rows],
                         [("1", "hook_left", "hook", "left", "S1"), ("2", "hook_right", "hook", "right", "S1"),
                          ("3", "ball", "ball", "none", "S1")])
        self.assertEqual(rows[0]["voxels"], str(int(hook().sum())))

    def test_enrolling_again_gives_the_same_shapes(self):
        again = self.eskel("enroll", self.volume)
        self.assertEqual({row["name"]: row["id"] for row in self.rows(again)}, self.ids)

    def test_of_several_files_the_bad_ones_are_told_and_the_others_enrolled(self):
        text = self.write("text.nii", "no volume")
        run = self.eskel("enroll", "/nonexistent.nii", text, self.volume, "--json")
        self.assertEqual(run.returncode, 2)
        self.assertEqual(len(json.loads(run.stdout)["shapes"]), 3)
        self.assertIn("eskel: /nonexistent.nii: No such file or directory\n", run.stderr)
        self.assertRegex(run.stderr, rf"(?m)^eskel: {text}: \S.*$")

    def test_what_the_server_refuses_is_exit_code_1_with_its_reason(self):
        for arguments, said in (
            (["enroll", self.write("empty.nii", "")], "empty.nii: "),
            (["enroll", self.volume, "--side", "up"], "up"),
            (["enroll", self.volume, "--label", "9"], "9"),
            (["recognize", self.volume, "--mode", "psychic"], "psychic"),
            (["recognize", "0" * 32], "0" * 32),
            (["show", "0" * 32], "0" * 32),
            (["show", "not/an?id"], "not/an?id"),
            (["distances", "0" * 32], "0" * 32),
            (["show", "--cursor", "nonsense"], "nonsense"),
        ):
            with self.subTest(arguments):
                self.assert_run(self.eskel(*arguments), 1, said)

    def test_a_folder_is_no_volume(self):
        self.assert_run(self.eskel("recognize", self.folder), 2, "it is not a file")

    def test_a_volume_can_come_through_a_pipe(self):
        with subprocess.Popen(["cat", self.volume], stdout=subprocess.PIPE) as cat:
            run = self.eskel("enroll", "/dev/stdin", "--quiet", stdin=cat.stdout)
        self.assertEqual([row["id"] for row in self.rows(run)], list(self.ids.values()))

    def test_a_stored_shape_is_recognized_by_its_mirrored_twin(self):
        row, = self.rows(self.eskel("recognize", self.ids["hook_left"], "--class", "hook"))
        self.assertEqual((row["query"], row["nearest"], row["chirality"]), ("hook_left", "hook_right", "mirrored"))
        self.assertEqual((row["class"], row["side"], row["agrees"]), ("hook", "left", "yes"))

    def test_a_wrong_label_is_found(self):
        wrong = self.write("wrong.csv", TABLE.replace("hook_left,hook,left", "hook_right,hook,right"))
        run = self.eskel("recognize", self.volume, "--labels", wrong, "--label", 1)
        row, = self.rows(run)
        self.assertEqual((row["query"], row["side"], row["agrees"]), ("hook_right", "left", "no"))

    def test_an_unnamed_object_goes_by_its_file_and_label(self):
        rows = self.rows(self.eskel("recognize", self.volume))
        self.assertEqual([row["query"] for row in rows], [f"hooks.nii.gz:{n}" for n in (1, 2, 3)])
        self.assertEqual([row["nearest"] for row in rows], list(self.ids))

    def test_explain_says_what_differs(self):
        run = self.eskel("recognize", self.ids["hook_left"], "--explain")
        self.assertIn("\nbeside hook_right, matched class by class:\n  no class differs much\n", run.stdout)
        self.assertRegex(run.stdout, r"\nas a whole: of the same size\nthe trees agree down to level \d+; "
                                     r"laid on it mirrored, class centres lie 0\.\d mm off \(rms\)\n")

    def test_neighbours_can_come_in_the_order_of_their_positions(self):
        run = self.eskel("recognize", self.ids["hook_left"], "--order", "position")
        self.assertRegex(run.stdout, r"\n#  name +class +side +subject +position  distance  ")
        self.assertRegex(run.stdout, r"\n1  hook_right +hook +right ")
        self.assertIn("mode exact: proven, no other shape is nearer\n", run.stdout)

    def test_nothing_to_recognize_it_by_is_exit_code_1(self):
        for options in ([], ["--json"]):
            run = self.eskel("recognize", self.volume, "--not-subject", "S1", *options)
            self.assertEqual((run.returncode, run.stderr), (1, ""))
            self.assertTrue(run.stdout)

    def test_json_is_the_servers_answer_a_line_each(self):
        run = self.eskel("recognize", *self.ids.values(), "--json", "--quiet")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        names = [json.loads(line)["results"][0]["query"]["name"] for line in run.stdout.splitlines()]
        self.assertEqual(names, list(self.ids))
        for arguments, member in ((["show"], "shapes"), (["show", self.ids["ball"]], "id"), (["distances"], "ids")):
            self.assertIn(member, json.loads(self.eskel(*arguments, "--json").stdout))

    def test_the_matrix_is_symmetric_with_a_zero_diagonal(self):
        rows = self.rows(self.eskel("distances", *self.ids.values()))
        matrix = numpy.array([[float(row[str(n)]) for n in (1, 2, 3)] for row in rows])
        self.assertEqual([row["name"] for row in rows], list(self.ids))
        self.assertTrue((matrix == matrix.T).all() and (matrix.diagonal() == 0).all(), matrix)
        self.assertGreater(matrix[0, 2], matrix[0, 1])

    def test_csv_passes_through(self):
        run = self.eskel("distances", "--class", "hook", "--format", "csv")
        self.assertEqual(run.returncode, 0, run.stderr)
        heading, *rows = [line.split(",") for line in run.stdout.splitlines()]
        self.assertEqual(heading, ["id", "name", self.ids["hook_left"], self.ids["hook_right"]])
        self.assertEqual([row[0] for row in rows], heading[2:])

    def test_a_mesh_is_of_the_format_that_its_file_is_called(self):
        for name, begins in (("a.glb", b"glTF"), ("a.PLY", b"ply"), ("a.obj", b"#"), ("a", b"glTF")):
            run = self.eskel("mesh", self.ids["hook_left"], "--output", self.path(name), "--step", 2, "--level", 4)
            self.assertEqual((run.returncode, run.stdout, run.stderr), (0, "", ""))
            with open(self.path(name), "rb") as file:
                self.assertEqual(file.read(len(begins)), begins)
        run = self.eskel("mesh", self.ids["ball"], "--format", "obj", "--frame", "lps")
        self.assertIn("SPACE=LPS", run.stdout)
        self.assert_run(self.eskel("mesh", self.ids["ball"], "--step", "0"), 1, "expected millimetres")
        run = self.eskel("mesh", self.ids["ball"], "--format", "obj", "--distance", 1000000)
        self.assertLess(len(run.stdout), len(self.eskel("mesh", self.ids["ball"], "--format", "obj", "--distance", 0).stdout))
        self.assert_run(self.eskel("mesh", self.ids["ball"], "--distance", 100, "--level", 2), 1, "beside level or step")
        self.assert_run(self.eskel("mesh", "0" * 32), 1, "there is no shape")

    def test_a_surface_is_fitted_and_drawn(self):
        run = self.eskel("reconstruct", self.ids["hook_left"], "--level", 3)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        error = {row["error"]: row for row in self.rows(run)}["boundary to surface, mean, mm"]
        self.assertLess(float(error["after"]), float(error["before"]))
        self.assertRegex(run.stdout, r"\nlevel 3, 3 primitives, deformed, fitted by joint\n\d+ bytes: the voxels have \d+ times")
        path = self.path("fitted.stl")
        self.assert_run(self.eskel("mesh", self.ids["hook_left"], "--level", 3, "--primitive", "deformed", "--output", path), 0)
        self.assert_run(self.eskel("mesh", self.ids["hook_left"], "--level", 4, "--primitive", "deformed"), 1, "was fitted")
        self.assert_run(self.eskel("reconstruct", self.ids["hook_left"], "--primitive", "cube"), 1, "cube")
        run = self.eskel("reconstruct", self.ids["hook_left"], "--level", 3, "--primitive", "algebraic")
        self.assertRegex(run.stdout, r"\nlevel 3, 3 primitives, algebraic, fitted by least_squares\n")
        self.assert_run(self.eskel("mesh", self.ids["hook_left"], "--level", 3, "--primitive", "algebraic", "--output", path), 0)
        self.assert_run(self.eskel("reconstruct", self.ids["hook_left"], "--primitive", "algebraic", "--method", "tabu"), 1, "least_squares")
        run = self.eskel("reconstruct", self.ids["hook_left"], "--level", 3, "--method", "tabu", "--seed", 5)
        self.assertIn("fitted by tabu, seed 5\n", run.stdout)
        self.assert_run(self.eskel("reconstruct", "0" * 32), 1, "there is no shape")

    def test_a_matrix_as_a_job_is_waited_for_and_is_what_it_would_be_at_once(self):
        row, = self.rows(self.eskel("distances", "--class", "hook", "--format", "csv", "--job"))
        self.assertEqual((row["path"], len(row["id"])), ("/distances", 32))
        output = self.path("job.csv")
        run = self.eskel("job", row["id"], "--output", output)
        self.assertEqual((run.returncode, run.stdout, run.stderr), (0, "", ""))
        with open(output, newline="") as file:
            self.assertEqual(file.read().splitlines(),
                             self.eskel("distances", "--class", "hook", "--format", "csv").stdout.splitlines())
        self.assertEqual(json.loads(self.eskel("job", row["id"], "--json").stdout)["state"], "done")
        listed = {job["id"]: job for job in self.rows(self.eskel("jobs"))}
        self.assertEqual((listed[row["id"]]["state"], listed[row["id"]]["done"]), ("done", "100.0 %"))
        self.assert_run(self.eskel("job", row["id"], "--cancel"), 0)
        self.assert_run(self.eskel("job", row["id"]), 1, "there is no job")

    def test_a_job_that_failed_is_exit_code_1_with_its_reason(self):
        row, = self.rows(self.eskel("distances", "0" * 32, "--job"))
        self.assert_run(self.eskel("job", row["id"]), 1, "there is no shape " + "0" * 32)

    def test_one_evaluation_has_its_details(self):
        run = self.eskel("evaluate", "--class", "hook")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertIn("shapes: 2, classes: 1, queries: 2, left out: shape\n", run.stdout)
        self.assertRegex(run.stdout, r"(?m)^log +sum +- +manhattan +fixed +1\.000 +1\.000")
        self.assertRegex(run.stdout, r"(?m)^ +0\.05 +2 +1\.000 +2 +1\.000$")

    def test_all_distances_are_evaluated_but_for_what_is_given(self):
        page = self.path("page.html")
        run = self.eskel("evaluate", "--all", "--signature", "paper", "--csv", "--html", page)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(len(run.stderr.splitlines()), 18)
        heading, *rows = [line.split(",") for line in run.stdout.splitlines()]
        self.assertEqual({row[0] for row in rows}, {"paper"})
        self.assertEqual(len({tuple(row[:5]) for row in rows}), 18)
        self.assertEqual(heading[:5], ["signature", "distance", "level", "metric", "size"])
        with open(page, encoding="utf-8") as file:
            text = file.read()
        self.assertTrue(text.startswith("<!DOCTYPE html>") and text.endswith("</html>\n"))
        for svg in re.findall(r"<svg.*?</svg>", text, re.DOTALL):
            xml.dom.minidom.parseString(svg)
        fixed = self.eskel("evaluate", "--all", "--distance", "level", "--level", 3, "--json", "--quiet")
        answers = [json.loads(line) for line in fixed.stdout.splitlines()]
        self.assertEqual([answer["distance"]["level"] for answer in answers], [3] * 12)

    def test_a_subject_can_be_left_out(self):
        answer = json.loads(self.eskel("evaluate", "--leave-out", "subject", "--json").stdout)
        self.assertEqual((answer["leave_out"], answer["shapes"], answer["queries"]), ("subject", 3, 0))
    def test_a_matrix_of_two_sets_lists_its_columns(self):
        run = self.eskel("distances", self.ids["ball"], "--columns-class", "hook")
        self.assertEqual(run.returncode, 0, run.stderr)
        rows, columns = run.stdout.split("\n\n")
        self.assertRegex(rows, r"^#  name      1      2\n1  ball  \d\.\d{3}  \d\.\d{3}$")
        self.assertEqual(columns, "#  column\n1  hook_left\n2  hook_right\n")

    def test_numpy_loads_what_is_written_to_a_file(self):
        path, ids = self.path("matrix.npy"), list(self.ids.values())
        run = self.eskel("distances", *ids, "--format", "npy", "--output", path)
        self.assertEqual((run.returncode, run.stdout, run.stderr), (0, "", ""))
        matrix = numpy.load(path)
        self.assertEqual((matrix.dtype, matrix.shape, matrix.flags.c_contiguous), (numpy.float64, (3, 3), True))
        answer = json.loads(self.eskel("distances", *ids, "--json").stdout)
        numpy.testing.assert_allclose(matrix, answer["distances"], rtol=1e-14)
        run = self.eskel("distances", *ids[:2], "--columns", "--format", "npy", "--output", path)
        numpy.testing.assert_array_equal(numpy.load(path), matrix[:2])

    def test_pictures_are_well_formed_and_stand_alone(self):
        for plot in "heatmap", "map":
            picture = self.eskel("distances", "--format", "svg", "--plot", plot).stdout
            root = xml.etree.ElementTree.fromstring(picture)
            self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
            self.assertIn("3 shapes", root.find("{*}title").text)
            for element in root.iter():
                self.assertNotIn(element.tag.split("}")[1], ("style", "script", "image", "use", "link"))
                self.assertFalse({"style", "class", "href"} & set(element.attrib))

    def test_a_refusal_leaves_the_file_as_it_is(self):
        path = self.write("kept", "as it was")
        run = self.eskel("distances", "--format", "csv", "--plot", "map", "--output", path)
        self.assertEqual(run.returncode, 1)
        self.assertIn("expected format=svg", run.stderr)
        with open(path, encoding="utf-8") as file:
            self.assertEqual(file.read(), "as it was")
        run = self.eskel("distances", "--output", self.path("nowhere/matrix"))
        self.assertEqual((run.returncode, run.stderr),
                         (1, f"eskel: {self.path('nowhere/matrix')}: No such file or directory\n"))

    def test_the_list_is_filtered_and_paged(self):
        self.assertEqual(len(self.rows(self.eskel("show"))), 3)
        row, = self.rows(self.eskel("show", "--class", "hook", "--side=right"))
        self.assertEqual(row["name"], "hook_right")
        first = self.eskel("show", "--limit", 2)
        self.assertEqual(len(self.rows(first)), 2)
        cursor = first.stdout.split("--cursor ")[1].strip()
        row, = self.rows(self.eskel("show", "--limit", 2, "--cursor", cursor))
        self.assertEqual(row["name"], "ball")

    def test_an_empty_list_is_no_failure(self):
        run = self.eskel("show", "--class", "unicorn")
        self.assertEqual((run.returncode, run.stdout, run.stderr), (0, "", ""))

    def test_one_shape_is_shown_in_full(self):
        run = self.eskel("show", self.ids["hook_left"])
        self.assertRegex(run.stdout, rf"(?m)^id +{self.ids['hook_left']}$")
        self.assertRegex(run.stdout, r"(?m)^subject +S1$")

    def test_a_mesh_takes_a_spacing(self):
        mesh = self.write("wedge.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        here = self.eskel("skeleton", mesh, "--spacing", "0.5", "--levels", "1", "--json")
        there = self.eskel("recognize", mesh, "--spacing", "0.5", "--json")
        self.assertEqual(json.loads(here.stdout)["nodes"][0]["voxels"],
                         json.loads(there.stdout)["results"][0]["query"]["voxels"])

    def test_the_skeleton_computed_here_is_the_servers(self):
        here = self.eskel("skeleton", self.volume, "--label", 1, "--json")
        url = f"{self.url}/shapes/{self.ids['hook_left']}/skeleton"
        there = subprocess.run(["curl", "--silent", "--fail", url], capture_output=True, check=True)
        self.assertEqual(json.loads(here.stdout), json.loads(there.stdout))

    def test_a_proxy_does_not_stand_between_this_machine_and_itself(self):
        run = self.eskel("show", environment={"http_proxy": "http://127.0.0.1:9", "all_proxy": "http://127.0.0.1:9"})
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_a_url_may_end_in_a_slash(self):
        self.assertEqual(self.eskel("show", "--server", self.url + "/").returncode, 0)

    def test_what_is_no_eskeld_is_exit_code_3(self):
        for command in (["show"], ["job", "0" * 32]):
            self.assert_run(self.eskel(*command, "--server", self.url + "/healthz#"), 3, "is not one of eskeld's")


class Tables(Served):
    def test_tables_may_be_quoted_reordered_and_come_from_a_spreadsheet(self):
        volume = self.path("balls.nii")
        write_nifti(volume, side_by_side(ball(5), ball(6), ball(7)))
        table = self.write("table.csv", '\ufeffSide,notes,Name,label\r\nL,"a, ""b""","ball, the ""first"" & only",1\r\n\r\n'
                                        'right,"two\r\nlines",größe,2\r\nNONE,,"",3')
        rows = self.rows(self.eskel("enroll", volume, "--labels", table, "--class", "ball"))
        self.assertEqual([(row["label"], row["name"], row["side"]) for row in rows],
                         [("1", 'ball, the "first" & only', "left"), ("2", "größe", "right"), ("3", "balls.nii:3", "none")])
        self.assertEqual({row["class"] for row in rows}, {"ball"})

    def test_tables_of_other_programs_are_read(self):
        volume = self.path("shapes.nii")
        for number, (program, table) in enumerate(OTHER_TABLES.items(), 2):
            with self.subTest(program):
                write_nifti(volume, side_by_side(ball(5), ball(6), ball(7)), spacing=number)  # shapes not stored before
                rows = self.rows(self.eskel("enroll", volume, "--labels", self.write("names.txt", table)))
                self.assertEqual([(row["name"], row["class"], row["side"]) for row in rows], [
                    ("Left-Hippocampus", "hippocampus", "left"), ("femur_right", "femur", "right"),
                    ("sacrum", "sacrum", "none" if "none" in table else "-")])

    def test_names_in_the_file_count_where_no_table_names_the_label(self):
        volume = self.path("named.nii.gz")
        labels = "".join(f'<Label Key="{label}" Red="1.0"><![CDATA[{name}]]></Label>\n'
                         for label, name in enumerate(("femur_left", "no", "Größe &"), 1))
        xml = f"<CaretExtension><VolumeInformation Index='0'><LabelTable>\n{labels}</LabelTable></VolumeInformation></CaretExtension>"
        write_nifti(volume, side_by_side(ball(10), ball(11), ball(12)), extension=xml.encode())
        rows = self.rows(self.eskel("enroll", volume, "--labels", self.write("table.csv", "label,name\n2,talus R\n")))
        self.assertEqual([(row["name"], row["class"], row["side"]) for row in rows],
                         [("femur_left", "femur", "left"), ("talus R", "talus", "right"), ("Größe &", "größe_&", "-")])

    def test_an_mgz_file_names_labels_by_its_colour_table_or_as_aseg_does(self):
        names = {17: b"Femur (L)\0", 53: b"ball\0"}
        table = struct.pack(">3i", 1, -2, 54) + struct.pack(">ici", 1, b"\0", 2) + b"".join(
            struct.pack(">2i", label, len(name)) + name + bytes(16) for label, name in names.items())
        for radius, footer, expected in (
                (13, b"", [("Left-Hippocampus", "hippocampus", "left"), ("Right-Hippocampus", "hippocampus", "right")]),
                (15, bytes(20) + table, [("Femur (L)", "femur", "left"), ("ball", "ball", "-")])):
            with self.subTest(footer):
                labels = numpy.choose(side_by_side(ball(radius), ball(radius + 1)), (0, 17, 53))
                header = struct.pack(">i4i2ih3f9f3f194x", 1, *labels.shape, 1, 4, 0, 1, 1, 1, 1, *numpy.eye(3).ravel(), 0, 0, 0)
                volume = self.path("aseg.mgz")
                with gzip.open(volume, "wb") as file:
                    file.write(header + labels.astype(">i2").tobytes(order="F") + footer)
                rows = self.rows(self.eskel("enroll", volume))
                self.assertEqual([(row["name"], row["class"], row["side"]) for row in rows], expected)

    def test_a_table_may_have_more_rows_than_the_volume_has_labels(self):
        volume = self.path("two.nii")
        write_nifti(volume, side_by_side(ball(4), ball(8)))
        table = self.write("long.csv", "label,name\n" + "".join(f"{n},ball {n}\n" for n in range(2, 300)))
        rows = self.rows(self.eskel("enroll", volume, "--labels", table))
        self.assertEqual([row["name"] for row in rows], ["two.nii:1", "ball 2"])

    def test_more_names_than_fit_one_request_are_posted_in_parts(self):
        count, volume = 1010, self.path("many.nii.gz")
        labels = numpy.zeros((4 * count, 3, 3), numpy.int16)
        for label in range(count):
            labels[4 * label:4 * label + 3, :1 + label % 3, :] = label + 1
        write_nifti(volume, labels)
        for name in ("chip", "a name so long that it is the text that fills a request and not the number of parameters"):
            with self.subTest(name):
                table = self.write("many.csv", "label,name,class,side\n" +
                                   "".join(f"{n},{name} {n},chip,left\n" for n in range(1, count + 1)))
                run = self.eskel("enroll", volume, "--labels", table, "--levels", 1, "--json")
                self.assertEqual(run.returncode, 0, run.stderr)
                answers = [json.loads(line)["shapes"] for line in run.stdout.splitlines()]
                self.assertGreater(len(answers), 1)
                self.assertEqual([shape["label"] for shapes in answers for shape in shapes],
                                 list(range(1, count + 1)))
        chosen = self.eskel("enroll", volume, "--labels", table, "--levels", 1, "--label", 1010, "--label", 3)
        self.assertEqual([row["label"] for row in self.rows(chosen)], ["3", "1010"])


class Tokens(Served):
    """A server whose database has tokens."""

    @classmethod
    def before_start(cls):
        made = subprocess.run([ESKELD, "token", "add", "reader", "--role", "read", "--database", cls.database],
                              capture_output=True, text=True, check=True)
        cls.token = made.stdout

    def test_a_token_comes_from_a_file_only(self):
        token = self.write("token", self.token)
        self.assertEqual(self.eskel("show", "--token-file", token).returncode, 0)
        self.assertEqual(self.eskel("show", environment={"ESKEL_TOKEN_FILE": token}).returncode, 0)

    def test_a_wrong_token_is_refused(self):
        self.assert_run(self.eskel("show", "--token-file", self.write("wrong", "0" * 64 + "\n")), 1, "shapes: ")

    def test_a_reader_cannot_enroll(self):
        volume = self.path("ball.nii")
        write_nifti(volume, side_by_side(ball(5)))
        token = self.write("token", self.token)
        self.assert_run(self.eskel("enroll", volume, "--token-file", token), 1, "ball.nii: ")


if __name__ == "__main__":
    unittest.main()
