"""Every options file of cases/ is one that the program takes. A scene is built whole, in its own size: in time it takes a step,
at rest it is stopped where its first load begins. By then all that it says has been read and judged, files that it names
too. A file without -case is no scene, but must be part of one.

Usage: test_cases.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import shlex
import shutil
import signal
import subprocess
import time

import program

FILES = sorted(path.relative_to(program.ROOT) for path in program.ROOT.glob("cases/*/*.opts"))
IN_TIME = {"-ts_max_steps": "1"}
AT_REST = {"-output_history": ""}  # its file begins when the scene stands


def words_in(path):
    """The lines of an options file, split."""
    lines = (program.ROOT / path).read_text(encoding="utf-8").splitlines()
    return [words for words in (shlex.split(line, comments=True) for line in lines) if words]


def parts_of(path):
    """The files that an options file names, those that they name, and itself."""
    for name, *value in words_in(path):
        if name == "-options_file":
            yield from parts_of(value[0])
    yield str(path)


def says(path, *words):
    return any(line[: len(words)] == list(words) for part in parts_of(path) for line in words_in(part))


SCENES = [path for path in FILES if any(words[0] == "-case" for words in words_in(path))]


class Cases(program.ProgramTest):
    def begin(self, path, directory):
        """Runs a scene until it ends or its first load begins: exit status, and what it said on stderr."""
        in_time = says(path, "-analysis", "explicit") or says(path, "-analysis", "implicit")
        options = {"-options_file": str(path), **(IN_TIME if in_time else AT_REST), "-quiet": ""}
        words = [*program.words_of(options), "-output_dir", str(directory)]
        with subprocess.Popen([*program.ALONE, program.PROGRAM, *words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True, cwd=program.ROOT) as process:
            end = time.monotonic() + program.TIMEOUT
            stands = directory / "history.csv"
            while process.poll() is None and (in_time or not stands.exists()) and time.monotonic() < end:
                time.sleep(0.005)
            process.send_signal(signal.SIGTERM)
            said = process.communicate(timeout=program.TIMEOUT)[1]
            return process.returncode, said

    def test_every_scene_is_taken(self):
        for path in SCENES:
            with self.subTest(path=str(path)):
                directory = self.scratch / path.stem
                status, said = self.begin(path, directory)
                self.assertEqual((status, [line for line in said.splitlines() if not line.startswith("warning: ")]), (0, []))
                self.assertNotIn("nothing used", said)
                self.assertIn("before_solve", program.Run(status, "", said, directory).summary["memory_mb"])
                shutil.rmtree(directory)

    def test_what_is_no_scene_is_part_of_one(self):
        read = {part for path in SCENES for part in parts_of(path)}
        self.assertEqual([str(path) for path in FILES if str(path) not in read], [])


if __name__ == "__main__":
    program.main()
