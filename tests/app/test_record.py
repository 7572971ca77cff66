"""What a run leaves about itself: options that give it again, what made its files, what to cite."""

import re
import socket
import subprocess

import program
from torn import TORN

import h5py

SHORT = TORN | {"-ts_max_steps": "60", "-output_fields": "", "-checkpoint_interval": "60"}


class Record(program.ProgramTest):
    def test_options_as_used_give_the_run_again(self):
        file = self.scratch / "case.opts"
        file.write_text("-ts_max_steps 60\n-case 'a name # with marks'\n", encoding="utf-8")
        first = self.solve(SHORT | {"-ts_max_steps": None, "-case": None, "-options_file": str(file), "-ksp_rtol": "1e-9"})
        again = self.solve({"-options_file": str(first.directory / "options.opts")}, directory=self.scratch / "again")
        for name in ("history.csv", "checkpoint.h5", "crack_path.csv"):
            self.assertEqual((first.directory / name).read_bytes(), (again.directory / name).read_bytes(), name)
        self.assertEqual(again.summary["case"], "a name # with marks")
        text = (first.directory / "options.opts").read_text(encoding="utf-8")
        self.assertRegex(text, rf"(?m)^-ts_max_steps 60 +# {re.escape(str(file))}, line 1$")
        self.assertRegex(text, r"(?m)^-pd_spacing 0\.001 +# command line$")
        self.assertRegex(text, r"(?m)^-ksp_rtol 1e-9 ")
        self.assertRegex(text, r"(?m)^# -pd_micromodulus conical$")  # left at its default
        kept = lambda text: [line.split(" # ")[0].rstrip() for line in text.splitlines() if line.startswith("-") and "-output_dir" not in line]
        self.assertEqual(kept(text), kept((again.directory / "options.opts").read_text(encoding="utf-8")))

    def test_every_file_says_what_made_it(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.solve(SHORT, ranks)
                made = run.summary["provenance"]
                self.assertEqual((made["ranks"], made["hosts"]), (ranks, 1))
                self.assertRegex(made["git"], r"^([0-9a-f]{12}(-dirty)?|unknown)$")
                self.assertEqual(made["host"].split(".")[0], socket.gethostname().split(".")[0])
                self.assertIn(made["mpi"].split("v")[-1], subprocess.run(["mpirun", "--version"], capture_output=True, text=True, check=True).stdout)
                self.assertEqual(made["petsc"], run.summary["petsc_version"])
                self.assertRegex(made["compiler"], r"^\w+ \d+\.\d+")
                self.assertRegex(made["hdf5"], r"^1\.\d+\.\d+$")
                for name in ("fields.h5", "checkpoint.h5"):
                    with h5py.File(run.directory / name) as file:
                        attributes = {key: value.decode() if isinstance(value, bytes) else value for key, value in file.attrs.items()}
                    self.assertEqual(attributes, {key: str(value) for key, value in made.items() if key != "hosts"}, name)

    def test_papers_are_those_of_what_is_used(self):
        keys = lambda run: re.findall(r"^@\w+\{(\w+),", (run.directory / "citations.bib").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(keys(self.solve(program.SMALL)), ["petsc", "pdxsolve"])
        coupled = self.solve(program.SMALL_PATCH | {"-quiet": None})
        self.assertEqual(keys(coupled), ["giannakeas2020part1", "petsc", "pdxsolve"])
        self.assertRegex(coupled.out.splitlines()[-1], r"^please cite .*10\.1007/s00466-020-01843-z")

    def test_a_file_of_that_name_that_no_run_wrote_stays(self):
        directory = self.scratch / "mine"
        directory.mkdir()
        (directory / "options.opts").write_text("# my own\n", encoding="utf-8")
        self.solve(program.SMALL, directory=directory)
        self.assertEqual((directory / "options.opts").read_text(encoding="utf-8"), "# my own\n")


if __name__ == "__main__":
    program.main()
