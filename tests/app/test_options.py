"""Options and tables as people write them, through the program: what is right is taken, what is not ends with one line
that names file, line and word, on 1 and 2 ranks.

Usage: test_options.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import dataclasses
import os
import pathlib
import tempfile
import unittest

import program
import test_bad_input as mistakes

BASE = {key: value for key, value in mistakes.PLATE.items() if key != "-mesh_lower"}
MARK = "\ufeff"


def lines(options):
    return "".join(f"{key} {value}\n" for key, value in options.items())


PLATE = lines(mistakes.PLATE)
CLOUD = "x,y,volume,set\n" + "".join(f"{x},{y},0.01,{int(x < 0.1)}\n" for x, y in mistakes.POINTS)


@dataclasses.dataclass(frozen=True)
class Case:
    """A run with a file `case.opts`, or with `words` instead; `pattern` None means that it must succeed."""

    name: str
    text: str
    pattern: str | None = None
    words: tuple = ("-options_file", "case.opts")
    files: dict = dataclasses.field(default_factory=dict)
    environment: dict = dataclasses.field(default_factory=dict)


def plate(name, first, pattern=None, **more):
    """The plate with a line in place of -mesh_lower 0,0."""
    return Case(name, first + "\n" + lines(BASE), pattern, **more)


def words(name, more, pattern=None, **other):
    """The plate with words behind it."""
    return Case(name, PLATE, pattern, ("-options_file", "case.opts", *more), **other)


def environment(name, value, pattern=None, variable="PETSC_OPTIONS"):
    return Case(name, PLATE, pattern, environment={variable: value})


def cloud(name, text, pattern=None):
    return Case(name, lines(mistakes.CLOUD | {"-pd_cloud": "cloud.csv"}), pattern, files={"cloud.csv": text})


def cracks(name, text, pattern=None):
    return Case(name, PLATE + "-crack_file a.cracks\n", pattern, files={"a.cracks": text})


def shaken(name, text, pattern=None):
    options = {"-material_density": "1000", "-analysis": "explicit", "-ts_max_steps": "3",
               "-bc_right_history": "table", "-bc_right_history_file": "a.csv"}
    return Case(name, PLATE + lines(options), pattern, files={"a.csv": text})


AT = r"^error: case\.opts, line 1: "
CASES = [
    # --- lines
    plate("blank behind a comma", "-mesh_lower 0, 0"),
    plate("blank before a comma", "-mesh_lower 0 ,0"),
    plate("a note", "-mesh_lower 0,0 # m"),
    plate("quotes", "-mesh_lower '0,0'\n-case \"two words\""),
    plate("a number with a plus", "-mesh_lower +0,+0.0e0"),
    Case("Windows", PLATE.replace("\n", "\r\n")),
    Case("old Macintosh", PLATE.replace("\n", "\r")),
    Case("mark", MARK + PLATE),
    Case("old Macintosh with a mistake", PLATE.replace("\n", "\r").replace("1e5,0", "1e5,0 N"),
         r"^error: case\.opts, line 11: \"N\" is one word too many after -bc_right_traction 1e5,0"),
    plate("a third word", "-mesh_lower 0,0 junk", AT + r"\"junk\" is one word too many after -mesh_lower 0,0"),
    plate("a list without commas", "-mesh_lower 0 0", AT + r"\"0\" is one word too many"),
    plate("a unit", "-mesh_lower 0,0 [m]", AT + r"\"\[m\]\" is one word too many.*notes begin with #"),
    plate("a note of another kind", "-mesh_lower 0,0 ! m", AT + r"\"!\" is one word too many"),
    plate("a note of a third kind", "-mesh_lower 0,0 % m", AT + r"\"%\" is one word too many"),
    plate("two options on a line", "-mesh_lower 0,0 -quiet", AT + r"\"-quiet\" is a second option on the line"),
    plate("an equals sign", "-mesh_lower = 0,0", AT + r"-mesh_lower = \.\.\.: drop the sign ="),
    plate("an equals sign without blanks", "-mesh_lower=0,0", AT + r"\"-mesh_lower=0,0\": write a blank instead of ="),
    plate("a colon", "-mesh_lower: 0,0", AT + r"\"-mesh_lower:\" is no option: a plain blank belongs"),
    plate("a blank that is none", "-mesh_lower\u00a00,0", AT + r"\"-mesh_lower\\u\{00a0\}0,0\" is no option: a plain blank belongs"),
    plate("no dash", "mesh_lower 0,0", AT + r"\"mesh_lower\" is no option"),
    plate("a typeset dash", "\u2013mesh_lower 0,0", AT + r"\"\\u\{2013\}mesh_lower\" is no option"),
    plate("a quote without end", "-mesh_lower '0,0", AT + r".*quote that does not end"),
    plate("NUL", "-mesh_lower 0,0\0", AT + r"has the control character \\x00"),
    plate("a bell", "-mesh_lower 0,\a0", AT + r"has the control character \\x07"),
    plate("a value that is too long", "-mesh_lower " + 5000 * "x", AT + r"-mesh_lower has 1 values"),
    plate("a word that is too long", "-mesh_lower 0," + 5000 * "x", AT + r"-mesh_lower is \"x{60}\.\.\.\""),
    plate("an empty item", "-mesh_lower 0,", AT + r"-mesh_lower is \"0,\": an item is empty"),
    plate("a name that is too long", "-mesh_lower" + 5000 * "x" + " 0,0", AT + r"\"-mesh_lowerx{40}"),
    plate("a value that is wrong", "-mesh_lower 0,zero", AT + r"-mesh_lower is \"zero\": must be a number"),
    plate("no value", "-mesh_lower", AT + r"-mesh_lower has no value"),
    plate("an unknown name", "-mesh_lower 0,0\n-mesh_cels 1", r"^error: case\.opts, line 2: -mesh_cels is no option.*-mesh_cells"),
    plate("a name in capitals", "-MESH_LOWER 0,0\n-mesh_lower 0,0", AT + r"-MESH_LOWER is no option.*did you mean -mesh_lower"),
    plate("a place that does not exist", "-mesh_lower 0,0\n-bc_left_box 5,5,6,6", r"^error: case\.opts, line 2: -bc_left_box\b"),
    Case("nothing of a condition's", "-bc_none_on top\n" + PLATE.replace("left,right", "left,right,none"),
         AT + "-bc_none: nothing is prescribed"),
    # --- files
    Case("no option at all", "", r"^error: there is no mesh: give.*-mpm_bodies or -pd_cloud"),
    Case("an empty file beside others", PLATE, None, ("-options_file", "empty.opts", "-options_file", "case.opts"),
         {"empty.opts": ""}),
    plate("a file in a file", "-options_file 'in ner.opts'", files={"in ner.opts": "-mesh_lower 0,0\n"}),
    Case("a file beside and one above the file that names them", "", None, ("-options_file", "a/b/case.opts"),
         {"a/b/case.opts": "-options_file beside.opts\n-options_file above.opts\n",
          "a/b/beside.opts": "-case beside\n", "a/above.opts": PLATE}),
    Case("a file here before one beside the file that names it", "", None, ("-options_file", "a/case.opts"),
         {"a/case.opts": "-options_file plate.opts\n", "a/plate.opts": "-no_such_option 1\n", "plate.opts": PLATE}),
    Case("a file that is nowhere", "", r"^error: a/case\.opts, line 1: -options_file plate\.opts: there is no such file",
         ("-options_file", "a/case.opts"), {"a/case.opts": "-options_file plate.opts\n", "b/plate.opts": PLATE}),
    Case("a table beside the file that names it", PLATE, None, ("-options_file", "case.opts", "-options_file", "a/more.opts"),
         {"a/more.opts": "-material_file mine.txt\n-material clay\n", "a/mine.txt": "clay 1GPa 0.3 - -\n"}),
    plate("a fault in a file in a file", "-options_file inner.opts", r"^error: inner\.opts, line 2: \"0\" is one word",
          files={"inner.opts": "\n-mesh_lower 0 0\n"}),
    plate("a path with a blank but no quotes", "-options_file in ner.opts", AT + r"\"ner\.opts\" is one word.*quotes",
          files={"in ner.opts": "-mesh_lower 0,0\n"}),
    plate("a file that is not there", "-options_file nowhere", AT + r"-options_file nowhere: there is no such file"),
    plate("a file without a name", "-options_file", AT + r"-options_file has no value"),
    plate("YAML", "-options_file_yaml nowhere", AT + r"-options_file_yaml: YAML is not read"),
    plate("a bomb", "-mesh_lower 0,0\n-options_file bomb", r"^error: bomb, line 1: -options_file bomb: more than 16",
          files={"bomb": 40 * "-options_file bomb\n"}),
    Case("a directory", "", r"-options_file \.: is a directory", ("-options_file", ".")),
    Case("a device", "", r"-options_file /dev/zero: .*device", ("-options_file", "/dev/zero")),
    Case("a pipe", "", r"-options_file pipe: .*pipe", ("-options_file", "pipe")),
    Case("a file of YAML", "", r"-options_file a\.yaml: YAML is not read", ("-options_file", "a.yaml"), {"a.yaml": "a: [\n"}),
    Case("a mesh that is a pipe", lines(mistakes.FILE | {"-mesh_file": "pipe"}), r"-mesh_file pipe"),
    Case("a file that fails while it is read", "", r"^error: /proc/self/mem: cannot be read beyond line \d+ \(",
         ("-options_file", "/proc/self/mem")),
    Case("cracks that fail while they are read", PLATE + "-crack_file /proc/self/mem\n", r"-crack_file /proc/self/mem: cannot be read"),
    Case("a cloud that the run would write over", lines(mistakes.CLOUD | {"-pd_cloud": "history.csv", "-output_dir": "."}),
         r"-pd_cloud is history\.csv: a run with -output_dir \. writes a file of that name", files={"history.csv": CLOUD}),
    Case("cracks from a pipe", PLATE + "-crack_file pipe\n", r"-crack_file pipe: .*pipe"),
    # --- the command line
    words("a list with blanks", ("-mesh_lower", "0,", "0")),
    words("a later value", ("-mesh_upper", "2,1")),
    words("stray", ("stray",), r"-quiet is \"stray\"|\"stray\" is one word too many|\"stray\" on the command line"),
    words("stray behind a value", ("-load_steps", "1", "stray"), r"^error: \"stray\" is one word too many after -load_steps 1"),
    words("a second file", ("-options_file", "case.opts", "case.opts"),
          r"^error: \"case\.opts\" is one word too many.*its own -options_file"),
    words("misspelt -options_file", ("-options_fil", "x"), r"^error: -options_fil is no option.*-options_file"),
    words("misspelt in another way", ("-options_file_", "x"), r"^error: -options_file_ is no option.*-options_file"),
    words("-options_file without a file", ("-options_file",), r"^error: -options_file has no value"),
    words("YAML by name", ("-options_file_yaml", "nowhere"), r"^error: -options_file_yaml: YAML"),
    words("a misspelt log", ("-log_vieww",), r"^error: -log_vieww is no option"),
    words("a flag of PETSc that is none", ("-malloc_debug", "perhaps"), r"^error: -malloc_debug perhaps: .*PETSc option"),
    words("a number of PETSc that is none", ("-ksp_rtol", "tight"), r"^error: -ksp_rtol tight: .*PETSc option"),
    words("a log that cannot be written", ("-log_view", ":/nowhere/log.txt"), r"^error: -log_view :/nowhere/log\.txt: "),
    words("help with a mistake", ("-help", "-bc_names", "a,,b"), r"^error: -bc_names is \"a,,b\""),
    # --- the environment
    environment("a solver from the environment", "-ksp_type cg -ksp_rtol 1e-11"),
    environment("a stray in the environment", "ksp_type cg", r"^error: PETSC_OPTIONS: \"ksp_type\" is no option"),
    environment("a third word in the environment", "-ksp_rtol 1e-8 note", r"^error: PETSC_OPTIONS: \"note\" is one word"),
    environment("an unknown name in the environment", "-ksptype cg", r"^error: PETSC_OPTIONS: -ksptype is no option"),
    environment("YAML in the environment", "a: [", r"^error: PETSC_OPTIONS_YAML\b", "PETSC_OPTIONS_YAML"),
    Case("a solver from .petscrc", PLATE, None, files={".petscrc": "-ksp_rtol 1e-11 # fine\n"}),
    Case("a mistake in .petscrc", PLATE, r"^error: \./\.petscrc, line 2: \"cg\" is no option", files={".petscrc": "\ncg\n"}),
    words("a mistake in .petscrc that is skipped", ("-skip_petscrc",), files={".petscrc": "cg\n"}),
    # --- many
    Case("600 boundary conditions' worth of options",
         PLATE.replace("left,right", "left,right," + ",".join(f"n{k}" for k in range(256)))
         + "".join(f"-bc_n{k}_on top\n-bc_n{k}_traction 0,{k}\n" for k in range(256))),
    words("more options than PETSc has room for", tuple(word for k in range(500) for word in (f"-ksp_{k}x", "1")),
          r"^error: more than 400 options of PETSc"),
    # --- tables
    cloud("cloud with a mark", MARK + CLOUD),
    cloud("cloud of Windows", CLOUD.replace("\n", "\r\n")),
    cloud("cloud of an old Macintosh", CLOUD.replace("\n", "\r")),
    cloud("cloud whose sets have a point", CLOUD.replace(",1\n", ",1.0\n").replace(",0\n", ",0.0\n")),
    cloud("cloud with a plus", CLOUD.replace("0.01", "+1e-2")),
    cloud("cloud with half a set", CLOUD.replace(",1\n", ",1.5\n"), r"cloud\.csv, line 2: \"1\.5\" is not a whole number"),
    cloud("cloud with a word", CLOUD.replace("0.01", "big", 1), r"cloud\.csv, line 2: \"big\" is not a number"),
    cloud("cloud with nan", CLOUD.replace("0.01", "nan", 1), r"cloud\.csv, line 2: \"nan\" is not a finite number"),
    cloud("cloud with an overlong word", CLOUD.replace("0.01", 10000 * "1", 1), r"cloud\.csv, line 2: \"1{60}\.\.\.\""),
    cloud("cloud with NUL", CLOUD.replace("0.01", "0\0", 1), r"cloud\.csv, line 2: has the control character \\x00"),
    cracks("cracks with a mark", MARK + "0 0.55 1 0.55\n"),
    cracks("cracks of an old Macintosh", "# one\r0 0.55 1 0.55\r"),
    cracks("cracks with a comma too many", "0,0.55,,1,0.55\n", r"a\.cracks, line 1: an item is empty"),
    shaken("history with a mark", MARK + "time,factor\n0,0\n1e-3,1\n"),
    shaken("history with units", "time [s],factor [-]\n0,0\n1e-3,1\n"),
    shaken("history of an old Macintosh", "time,factor\r0,0\r+1e-3,1\r"),
    shaken("history with its columns exchanged", "factor,time\n0,0\n1,1e-3\n", r"a\.csv, line 1: .*first must be the time"),
    shaken("history with a third column", "0,0,0\n", r"a\.csv, line 1: has 3 items"),
]


def run(case, ranks):
    with tempfile.TemporaryDirectory() as directory:
        here = pathlib.Path(directory)
        for name, text in ({"case.opts": case.text} | case.files).items():
            (here / name).parent.mkdir(parents=True, exist_ok=True)
            (here / name).write_bytes(text.replace("{dir}", directory).encode())
        os.mkfifo(here / "pipe")
        settings = [f"{key}={value}" for key, value in case.environment.items()]
        command = ["env", *settings, *program.launcher(ranks), program.PROGRAM, *case.words]
        status, out, err = program.finish(command, directory, mistakes.TIMEOUT, program.NO_WAIT)
    return status, out, [line for line in err.splitlines() if line.strip()]


class Options(unittest.TestCase):
    def test_each_is_taken_or_refused_in_one_line(self):
        for case, ranks, (status, out, messages) in mistakes.run_all(CASES, run):
            with self.subTest(case=case.name, ranks=ranks):
                if case.pattern is None:
                    self.assertEqual((status, messages), (0, []))
                    continue
                self.assertEqual((status, len(messages)), (1, 1), f"stderr: {messages}")
                self.assertNotIn("PETSC ERROR", out)
                self.assertRegex(messages[0], case.pattern)
                self.assertLess(len(messages[0]), 400)


if __name__ == "__main__":
    program.main()
