"""What a run does when the machine fails it: status 3 within seconds, one line that names the file and the cause, the
same on one rank and on two; what was there before stays."""

import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import threading
import time

import program
from torn import TORN

LIMIT = 5.0  # [s] from the failure to the end
# Every kind of file in the first steps.
ALL_FILES = TORN | {
    "-ts_max_steps": "60",
    "-output_fields": "",
    "-output_interval": "20",
    "-output_history_interval": "1",
    "-checkpoint_interval": "10",
}
# Sizes at which another file, or another part of it, is the first that has no room. [kB]
SIZES = (12, 40, 100, 200, 400, 600, 800, 1200, 1600, 2000)
TARGETS = ("history.csv", "fields.h5", "fields.xdmf.part", "checkpoint.h5.part", "summary.json.part")


class Disk(program.ProgramTest):
    def mount(self, name, kilobytes):
        """A small disk of its own, or None where that is not allowed."""
        directory = self.scratch / name
        directory.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(directory)]
        if subprocess.run(command, capture_output=True, check=False).returncode != 0:
            return None
        self.addCleanup(subprocess.run, ["umount", "-l", str(directory)], check=False)
        return directory

    def timed(self, options, ranks, directory):
        """A run, and how long it went on after its first word on stderr [s]."""
        command = [*program.launcher(ranks), program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)]
        pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        with subprocess.Popen(command, **pipes, text=True, cwd=program.ROOT) as process:
            watch = threading.Timer(program.TIMEOUT, process.kill)
            watch.start()
            said = process.stderr.readline()
            begin = time.monotonic()
            said += process.stderr.read()
            process.wait()
            took = time.monotonic() - begin
            watch.cancel()
        return program.Run(process.returncode, "", program.without_launcher(said), directory), took

    def assert_machine_failed(self, run, cause, directory):
        self.assertEqual(run.status, 3, run.err)
        self.assertEqual(run.err.count("\n"), 1, run.err)
        self.assertTrue(run.err.startswith("error: "), run.err)
        self.assertIn(str(directory), run.err)
        self.assertIn(cause, run.err)
        self.assertLess(len(run.err), 400)
        if not directory.exists():
            return
        left = {path.name for path in directory.iterdir()}
        self.assertFalse({name for name in left if name.endswith(".part")}, left)
        self.assertNotIn("run.lock", left)
        if "summary.json" in left:
            summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
            self.assertEqual(summary["status"], "failed")
            self.assertIn(summary["message"], run.err)

    def test_a_full_disk_at_any_moment(self):
        failed = 0
        cases = [(ranks, size, self.mount(f"disk_{size}_{ranks}", size)) for ranks in (1, 2) for size in SIZES]
        if cases[0][2] is None:
            self.skipTest("no mount here: the test with /dev/full takes its place")
        runs = program.in_pairs(lambda case: self.timed(ALL_FILES, case[0], case[2] / "o"), cases)  # they mostly wait for mpirun
        for (ranks, size, disk), (run, took) in zip(cases, runs):
            with self.subTest(size=size, ranks=ranks):
                if run.status == 0:  # there was room
                    continue
                failed += 1
                self.assert_machine_failed(run, "No space left on device", disk / "o")
                self.assertLess(took, LIMIT)
        self.assertGreaterEqual(failed, 16)

    def runs_with(self, names, prepare):
        """Runs on 1 and 2 ranks in directories where something was prepared under a name: ranks, name, run, seconds."""
        cases = [(ranks, name, self.scratch / f"prepared_{ranks}_{name}") for ranks in (1, 2) for name in names]
        for _, name, directory in cases:
            directory.mkdir()
            prepare(directory / name)
        runs = program.in_pairs(lambda case: self.timed(ALL_FILES, case[0], case[2]), cases)
        return [(ranks, name, *run) for (ranks, name, _), run in zip(cases, runs)]

    def test_a_file_that_cannot_be_written(self):
        for ranks, name, run, took in self.runs_with(TARGETS, lambda path: path.symlink_to("/dev/full")):
            with self.subTest(name, ranks=ranks):
                self.assert_machine_failed(run, "No space left on device", run.directory)
                self.assertIn(name.removesuffix(".part"), run.err)
                self.assertLess(took, LIMIT)

    def test_a_pipe_in_the_place_of_a_file_is_not_waited_for(self):
        for ranks, name, run, took in self.runs_with(("crack_path.csv", *TARGETS), os.mkfifo):
            with self.subTest(name, ranks=ranks):
                self.assertIn((run.status, run.err.count("\n")), ((1, 1), (3, 1)), run.err)
                self.assertIn(name.removesuffix(".part"), run.err)
                self.assertLess(took, LIMIT)

    def test_the_old_checkpoint_stays(self):
        first = {"-ts_max_steps": "20", "-output_history": None, "-checkpoint_interval": "20"}
        directory = self.scratch / "run"
        self.solve(TORN | first, directory=directory)
        before = (directory / "checkpoint.h5").read_bytes()
        (directory / "checkpoint.h5.part").symlink_to("/dev/full")
        again = {"-restart": str(directory / "checkpoint.h5"), "-ts_max_steps": "60", "-checkpoint_interval": "20"}
        for ranks in (1, 2):
            (directory / "checkpoint.h5.part").unlink(missing_ok=True)
            (directory / "checkpoint.h5.part").symlink_to("/dev/full")
            run = self.launch(TORN | first | again, ranks, directory=directory)
            self.assert_machine_failed(run, "No space left on device", directory)
            self.assertEqual((directory / "checkpoint.h5").read_bytes(), before)
        self.solve(TORN | first | again, directory=directory)

    def test_a_file_limit_of_the_system(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (32 << 20, 32 << 20))  # Open MPI 5 needs a file of 16 MB itself

        directory = self.scratch / "limited"
        options = ALL_FILES | {"-output_interval": "1", "-ts_max_steps": "1000", "-checkpoint_interval": "500"}
        command = [program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=program.ROOT, preexec_fn=limit, check=False)
        self.assert_machine_failed(program.Run(done.returncode, done.stdout, done.stderr, directory), "File too large", directory)

    def start(self, options, directory, ranks=1):
        command = [*program.launcher(ranks), program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=program.ROOT)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        for _ in range(2000):
            path = directory / "history.csv"
            if process.poll() is not None or (path.exists() and path.read_bytes().count(b"\n") > 3):
                return process
            time.sleep(0.01)
        self.fail("the run did not begin")

    def test_a_directory_that_disappears(self):
        long = TORN | {"-ts_max_steps": "100000", "-output_history_interval": "1"}
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                directory = self.scratch / f"gone_{ranks}"
                process = self.start(long, directory, ranks)
                shutil.rmtree(directory)
                begin = time.monotonic()
                out, err = process.communicate(timeout=60)
                self.assertLess(time.monotonic() - begin, LIMIT)
                self.assert_machine_failed(program.Run(process.returncode, out, program.without_launcher(err), directory), "No such file or directory", directory)

    def test_a_disk_that_is_read_only(self):
        disk = self.mount("read_only", 400)
        if disk is None:
            self.skipTest("no mount here")
        subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
        for ranks in (1, 2):
            run = self.launch(TORN, ranks, directory=disk / "o")
            self.assert_machine_failed(run, "Read-only file system", disk / "o")

    def test_memory_that_runs_out(self):
        shell = ("bash", "-c", 'ulimit -v "$0"; exec "$@"')
        big = TORN | {"-pd_spacing": "3.125e-5", "-output_history": None}  # 3,276,800 particles
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.launch(big, ranks, before=(*shell, "500000"))
                self.assertEqual(run.status, 3, run.err)
                self.assertIn("memory ran out on ", run.err)
                self.assertIn("the limit of its address space (ulimit -v) is 512 MB", run.err)
                self.assertEqual(run.err.count("\n"), 1, run.err)

    def test_one_directory_belongs_to_one_run(self):
        directory = self.scratch / "shared"
        process = self.start(TORN | {"-ts_max_steps": "100000", "-output_history_interval": "1"}, directory)
        for ranks in (1, 2):
            second = self.launch(TORN, ranks, directory=directory)
            self.assertEqual(second.status, 1)
            self.assertIn(f"the directory '{directory}' is in use: process {process.pid} on ", second.err)
            self.assertEqual(second.err.count("\n"), 1, second.err)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0)
        self.assertNotIn("run.lock", os.listdir(directory))

    def test_a_killed_run_leaves_a_lock_that_is_taken_over(self):
        directory = self.scratch / "killed"
        process = self.start(TORN | {"-ts_max_steps": "100000", "-output_history_interval": "1"}, directory)
        process.kill()
        process.communicate()
        self.assertIn("run.lock", os.listdir(directory))
        run = self.solve(TORN | {"-ts_max_steps": "20"}, directory=directory)
        self.assertEqual(run.files, ["citations.bib", "crack_path.csv", "history.csv", "options.opts", "summary.json"])

    def test_files_of_an_earlier_run_are_not_left_beside_new_ones(self):
        directory = self.scratch / "twice"
        self.solve(ALL_FILES, directory=directory)
        mine = pathlib.Path(directory, "notes.txt")
        mine.write_text("mine", encoding="utf-8")
        bad = self.launch(ALL_FILES | {"-bc_top_on": "nowhere"}, directory=directory)
        self.assertEqual(bad.status, 1)
        self.assertIn("fields.h5", bad.files)  # nothing is lost by a mistake
        self.assertIn("checkpoint.h5", bad.files)
        run = self.solve(TORN | {"-output_history": None, "-ts_max_steps": "20"}, directory=directory)
        self.assertEqual(run.files, ["checkpoint_before.h5", "citations.bib", "crack_path.csv", "notes.txt", "options.opts", "summary.json"])


if __name__ == "__main__":
    program.main()
