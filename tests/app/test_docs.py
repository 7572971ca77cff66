"""The documentation: made without dead links, of what the program itself says; its tutorial runs as it is printed."""

import json
import pathlib
import re
import shutil
import subprocess
import sys

import program
from program import pdxtools

DOCS = program.ROOT / "scripts" / "docs"
MISTAKES = [
    {"-mesh_cells": "0,4"},
    {"-mesh_lower": "2,0"},
    {"-pd_patches": "0.3,0.25,0.75,0.75", "-pd_spacing": "0.125"},
    {"-pd_patches": "0.25,0.25,0.75,0.75", "-pd_spacing": "0.125", "-material_poisson": "0.2"},
    {"-bc_load_on": "rigth"},
    {"-bc_load_box": "5,5,6,6"},
]


class Docs(program.ProgramTest):
    def build(self):
        """Once for all tests."""
        out = pathlib.Path(program.SHARED_SCRATCH.name) / "docs"
        if not out.exists():
            command = [sys.executable, DOCS / "build.py", "--executable", program.PROGRAM, "--out", out]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        return out

    def test_reference_and_messages_are_those_of_the_program(self):
        out = self.build()
        said = subprocess.run([*program.ALONE, program.PROGRAM, "-help", "-json"], capture_output=True, text=True, check=True)
        names = [option["name"] for option in json.loads(said.stdout)]
        page, man = ((out / file).read_text(encoding="utf-8") for file in ("pages/options.md", "pdxsolve.1"))
        for name in names:
            self.assertIn(f"| `{name}` |", page)
            self.assertIn(".B " + name.replace("-", "\\-") + "\n", man)
        completed = lambda words: subprocess.run(
            ["bash", "-c", 'source "$0"; COMP_WORDS=(pdxsolve "$@"); COMP_CWORD=$#; _pdxsolve; echo "${COMPREPLY[*]}"', out / "pdxsolve.bash", *words],
            capture_output=True, text=True, check=True).stdout.split()  # fmt: skip
        self.assertEqual(completed(["-adapt_see"]), ["-adapt_seed"])
        self.assertEqual(completed(["-adapt", "re"]), ["relocate"])
        self.assertEqual(sorted(completed(["-pd_micromodulus", ""])), ["conical", "uniform"])
        listed = re.findall(r"(?m)^- `(.*)` \(error, status 1\)$", (out / "pages" / "messages.md").read_text(encoding="utf-8"))
        patterns = [re.compile(".*".join(map(re.escape, message.split("…")))) for message in listed]
        for mistake in MISTAKES:
            wrong = self.launch(program.SMALL | mistake)
            self.assertEqual(wrong.status, 1)
            self.assertTrue(any(pattern.search(wrong.err.replace("`", "'")) for pattern in patterns), wrong.err)

    def test_the_tutorial_runs_as_printed(self):
        text = (DOCS / "pages" / "tutorial.md").read_text(encoding="utf-8")
        files = dict(re.findall(r"(?m)^`(\w+\.opts)`:\n\n```\n((?:.*\n)*?)```$", text))
        self.assertEqual(sorted(files), ["crack.opts", "plate.opts", "run.opts"])
        for name, options in files.items():
            (self.scratch / name).write_text(options, encoding="utf-8")
        commands = [line for block in re.findall(r"(?m)^```\n((?:.*\n)*?)```$", text) if "pdxsolve" in block
                    for line in block.splitlines() if re.match(r"(mpirun|pdxsolve)", line)]  # fmt: skip
        self.assertEqual(len(commands), 8)
        for line in commands:
            words = line.split()
            if words[0] == "pdxsolve-report":
                command = [sys.executable, program.ROOT / "scripts" / "report.py", *words[1:], "--no-pictures"]
            else:
                ranks = int(words[2]) if words[0] == "mpirun" else 1
                command = [*program.launcher(ranks), program.PROGRAM, *words[words.index("pdxsolve") + 1 :]]
            status, out, err = program.finish(command, self.scratch)
            self.assertEqual((status, err), (0, ""), f"{line}: {out}")
        summaries = {name: pdxtools.read_summary(self.scratch / "out" / name) for name in ("plate", "crack", "snail", "long")}
        self.assertAlmostEqual(summaries["plate"]["results"]["max_displacement_component"] / (1e6 * 0.042 / 72e9), 1, delta=1e-8)
        contours = [j for _, j in summaries["crack"]["results"]["j_by_contour"]]
        self.assertAlmostEqual(contours[0] / contours[1], 1, delta=1e-3)
        self.assertGreater(summaries["snail"]["relocations"], 0)
        self.assertAlmostEqual(1e6 * summaries["snail"]["results"]["time"], 25, delta=1e-9)  # of 25us
        self.assertEqual(summaries["long"]["status"], "done")
        self.assertTrue((self.scratch / "out" / "snail" / "report.html").exists())

    def test_messages_with_a_remedy_are_messages(self):
        table = (DOCS / "pages" / "trouble.md").read_text(encoding="utf-8").split("| it says |")[1].split("\n\n")[0]
        sources = "".join(path.read_text(encoding="utf-8") for path in sorted((program.ROOT / "src").rglob("*.cpp")))
        sources = re.sub(r'"\s*\n\s*"', "", sources)  # texts go on in the next line
        said = re.findall(r"(?m)^\| `(.*?)` \|", table)
        self.assertGreater(len(said), 10)
        for message in said:
            self.assertRegex(sources, r"[^\"]*".join(map(re.escape, message.split("…"))))

    def test_one_version_everywhere(self):
        """That of CMakeLists.txt is what program and packages are called by; the others are written by hand."""
        found = lambda file, pattern: re.search(pattern, (program.ROOT / file).read_text(encoding="utf-8"))[1]
        version = found("CMakeLists.txt", r"project\(pdxsolve VERSION (\S+)")
        said = subprocess.run([*program.ALONE, program.PROGRAM, "-version"], capture_output=True, text=True, check=True)
        self.assertRegex(said.stdout, rf"^pdxsolve {re.escape(version)} ")
        self.assertEqual(found("CITATION.cff", r"(?m)^version: (\S+)"), version)
        self.assertEqual(pdxtools.__version__, version)
        self.assertEqual(found("CHANGELOG.md", r"(?m)^## (\S+)$"), version)  # the newest that is not (unreleased)
        self.assertEqual(found("README.md", r"(?m)^Version (\S+) "), version.rsplit(".", 1)[0])

    def test_every_case_has_a_page(self):
        pages = self.build() / "pages"
        for readme in (program.ROOT / "cases").glob("*/README.md"):
            self.assertIn(f"(cases/{readme.parent.name}.md)", (pages / "cases.md").read_text(encoding="utf-8"))
            self.assertTrue((pages / "cases" / f"{readme.parent.name}.md").exists())
        if shutil.which("mkdocs"):
            self.assertIn("Tutorial", (pages.parent / "site" / "index.html").read_text(encoding="utf-8"))


if __name__ == "__main__":
    program.main()
