"""What eskel says to wrong usage, and what it does without a server."""
import json
import unittest

from support import NOWHERE, Folder, ball, eskel, hook, side_by_side, write_nifti

COMMANDS = ("enroll", "recognize", "distances", "evaluate", "mesh", "reconstruct", "jobs", "job", "show", "skeleton")


class Usage(Folder):
    def test_help_names_every_command_and_every_command_has_help(self):
        overview = eskel("--help")
        self.assertEqual(overview.returncode, 0)
        for command in COMMANDS:
            self.assertIn(f"\n  {command} ", overview.stdout)
            run = eskel(command, "--help")
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            self.assertIn(f"usage: eskel {command}", run.stdout)
            self.assertIn("  --json", run.stdout)

    def test_without_arguments_the_help_goes_to_standard_error(self):
        run = eskel()
        self.assertEqual((run.returncode, run.stdout), (2, ""))
        self.assertIn("usage: eskel", run.stderr)

    def test_the_version_is_one_line(self):
        self.assertRegex(eskel("--version").stdout, r"\Aeskel \d+\.\d+\.\d+\n\Z")

    def test_wrong_usage_is_told_in_one_line(self):
        for arguments, said in (
            (["enrol"], "enrol is not a command"),
            (["enroll"], "eskel enroll takes FILE|DIR..., 0 given"),
            (["evaluate", "a"], "eskel evaluate takes no operand, 1 given"),
            (["evaluate", "--html", "/nonexistent/page.html"], "/nonexistent/page.html: No such file"),
            (["show", "a", "b"], "eskel show takes [ID], 2 given"),
            (["job"], "eskel job takes ID, 0 given"),
            (["show", "--shoe"], "--shoe is not an option of show"),
            (["skeleton", "f", "--server=x"], "--server=x is not an option of skeleton"),
            (["show", "--class"], "--class needs a value: CLASS"),
            (["show", "--json=yes"], "--json takes no value"),
            (["show", "--attr", "scanner"], "--attr needs KEY=VALUE, not scanner"),
            (["skeleton", "f", "--levels", "65"], "--levels is 65, expected 1 to 64"),
            (["skeleton", "f", "--spacing", "0"], "--spacing is 0, expected millimetres, 0.001 to 1000"),
            (["skeleton", "f", "--label", "0x1"], "--label is 0x1, expected a whole number other than 0"),
            (["show", "--token-file", "/nonexistent"], "/nonexistent: No such file"),
        ):
            with self.subTest(arguments):
                self.assert_run(eskel(*arguments), 2, said)

    def test_an_argument_after_two_dashes_is_no_option(self):
        self.assert_run(eskel("skeleton", "--", "--levels"), 2, "--levels: No such file")

    def test_a_token_file_without_a_token_is_refused(self):
        for text in ("", "\n", "two words\n", "\x07\n"):
            with self.subTest(text):
                self.assert_run(eskel("show", "--token-file", self.write("token", text)), 2, "not a token")

    def test_an_unreachable_server_is_exit_code_3(self):
        volume = self.path("ball.nii")
        write_nifti(volume, side_by_side(ball(4)))
        for arguments in (["show"], ["distances"], ["evaluate", "--all"], ["recognize", volume], ["enroll", volume, volume]):
            with self.subTest(arguments):
                self.assert_run(eskel(*arguments, "--server", NOWHERE), 3, NOWHERE + " does not answer")

    def test_the_server_of_the_environment_is_overruled_by_the_option(self):
        run = eskel("show", "--server", NOWHERE, environment={"ESKEL_SERVER": "http://127.0.0.1:1"})
        self.assert_run(run, 3, NOWHERE)


class Tables(Folder):
    """A label table is read before anything is sent."""

    def test_a_wrong_table_is_refused_by_line_and_column(self):
        for text, said in (
            ("", "line 1: there is no column called label"),
            ("name,side\n", "line 1: there is no column called label"),
            ("label,name,name\n", "line 1, column 3: name is a column already"),
            ("label,name\nx,a\n", 'line 2, column 1 (label): "x" is not a whole number other than 0'),
            ("name,label\na,0\n", 'line 2, column 2 (label): "0" is not'),
            ("label\n99999999999\n", 'line 2, column 1 (label): "99999999999" is not'),
            ("label\n 1\n", 'line 2, column 1 (label): " 1" is not'),
            ("label,side\n1,lift\n", 'line 2, column 2 (side): "lift" is not left, right or none'),
            ("label,name\n1\n", "line 2, column 1: 1 fields, expected 2 as in the header"),
            ("label,name\n\n1,a,b\n", "line 3, column 3: 3 fields, expected 2 as in the header"),
            ("label,name\n1,a\n2,b\n1,c\n", "line 4: the label 1 stands in line 2 already"),
            ('label,name\n1,"a\n', "line 2, column 2: a quote is not closed"),
            ('label,name\n1,a"b\n', "line 2, column 2: a quote stands inside a field"),
            ('label,name\n1,"a"b\n', "line 2, column 2: expected a comma or the line's end"),
            ('label,name\n1,"a\nb"\nx,c\n', "line 4, column 1 (label)"),
            ('la"bel\n', "line 1, column 1: a quote stands inside a field"),
            ("label,name\r1,a\r", "line 1, column 2: expected a comma or the line's end"),
            (",".join(["c"] * 4097), "line 1, column 4097: there are more than 4096 columns"),
            (b"label\n1\0\n", "it is not a table of text"),
            ("index\tname\n1\ta\tb\n", "line 2, column 3: 3 fields, expected 2 as in the header"),
            ("index\tname\n1\t\"a\"b\n", "line 2, column 2: expected a tab or the line's end"),
            ("# colours\n\n1 a 0 0 0 0\n2 a 0 0 0\n", "line 4: expected a label, its name, red, green, blue and opacity"),
            ("1 0 0 0 0\n", "line 1: expected a label, its name"),
            ("1 a 0 0 0 x\n", "line 1: expected a label, its name"),
            ('1 0 0 0 1 1 "a"\n', "line 1: expected a label, its name"),
            ('1 2 0 0 0 1 1 1 "a"\n', "line 1: expected a label, its name"),
            ('1 0 0 0 1 1 1 a"\n', "line 1: expected a label, its name"),
            ("1 a 0 0 0 0\n1.5 b 0 0 0 0\n", 'line 2: "1.5" is not a whole number'),
            ("1 a 0 0 0 0\n2 b 0 0 0 0\n1 c 0 0 0 0\n", "line 3: the label 1 stands in line 1 already"),
        ):
            with self.subTest(text):
                table = self.write("table.csv", text)
                run = eskel("enroll", "volume.nii", "--labels", table, "--server", NOWHERE)
                self.assert_run(run, 2, table, said)

    def test_a_table_of_another_volume_is_refused(self):
        volume = self.path("ball.nii")
        write_nifti(volume, side_by_side(ball(4)))
        table = self.write("other.csv", "label,name\n2,a\n3,b\n")
        self.assert_run(eskel("enroll", volume, "--labels", table, "--server", NOWHERE), 2, "names none of its labels")

    def test_a_missing_table_is_refused(self):
        self.assert_run(eskel("enroll", "volume.nii", "--labels", "/nonexistent"), 2, "/nonexistent: No such file")


class Skeleton(Folder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.volume = cls.path("two.nii.gz")
        write_nifti(cls.volume, side_by_side(hook(), ball(6)))

    def test_levels_and_classes_of_every_label_are_shown(self):
        run = eskel("skeleton", self.volume, "--levels", 3)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("two.nii.gz:1\nlevel  intraclass ratio", run.stdout)
        self.assertIn("\ntwo.nii.gz:2\n", run.stdout)
        self.assertEqual(run.stdout.count("the classes of level 3"), 2)

    def test_json_is_a_line_a_label(self):
        run = eskel("skeleton", self.volume, "--levels", 3, "--json")
        self.assertEqual(run.returncode, 0, run.stderr)
        for line, voxels in zip(run.stdout.splitlines(), (int(hook().sum()), int(ball(6).sum())), strict=True):
            skeleton = json.loads(line)
            self.assertEqual([level["level"] for level in skeleton["levels"]], [1, 2, 3])
            self.assertEqual(len(skeleton["nodes"]), 6)
            self.assertEqual(skeleton["nodes"][0]["voxels"], voxels)

    def test_one_label_can_be_chosen(self):
        run = eskel("skeleton", self.volume, "--levels=2", "--label", 2)
        self.assertNotIn(":1\n", run.stdout)
        self.assertIn(":2\n", run.stdout)

    def test_what_is_no_volume_is_refused_by_name(self):
        self.assert_run(eskel("skeleton", self.write("text.nii", "hello")), 1, "text.nii: ")
        self.assert_run(eskel("skeleton", self.volume, "--label", 7), 1, self.volume)
        with open(self.volume, "rb") as file:
            self.assert_run(eskel("skeleton", self.write("cut.nii.gz", file.read()[:-20])), 1, "cut.nii.gz: ")


if __name__ == "__main__":
    unittest.main()
