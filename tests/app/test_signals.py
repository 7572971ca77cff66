"""Signals end any run with status 0 and what is done on disk: at rest, in explicit and in implicit steps, in the set-up.

Usage: test_signals.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import json
import os
import pathlib
import signal
import subprocess
import time

import program

MOVING = {"-material_density": "1000", "-ts_max_steps": "1000000", "-output_history": "", "-output_history_interval": "1"}
SCENES = {
    "static": program.SMALL_PATCH | {"-load_steps": "1000000", "-output_history": ""},
    "explicit": program.SMALL_PATCH | MOVING | {"-analysis": "explicit"},
    "implicit": program.SMALL | MOVING | {"-analysis": "implicit", "-ts_dt": "1e-6"},
}
SIGNALS = (signal.SIGTERM, signal.SIGUSR1, signal.SIGINT, signal.SIGHUP)


class Signals(program.ProgramTest):
    def start(self, options, directory, ranks=1, before=()):
        command = [*before, *program.launcher(ranks), program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)]
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, cwd=program.ROOT)

    def wait_for_rows(self, process, directory, rows=3):
        path = directory / "history.csv"
        while process.poll() is None and not (path.exists() and path.read_bytes().count(b"\n") > rows):
            time.sleep(0.005)

    def judge(self, process, directory, sig):
        out, err = process.communicate(timeout=program.TIMEOUT)
        self.assertEqual((process.returncode, err), (0, ""))
        summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual(summary["status"], "stopped")
        self.assertIn(f"stopped by {sig.name}", summary["message"])
        self.assertIn(summary["message"], out)
        return summary

    def test_any_signal_ends_any_run(self):
        for name, options in SCENES.items():
            for sig in SIGNALS:
                with self.subTest(scene=name, sig=sig.name):
                    directory = self.scratch / f"{name}_{sig.name}"
                    process = self.start(options, directory)
                    self.wait_for_rows(process, directory)
                    process.send_signal(sig)
                    summary = self.judge(process, directory, sig)
                    rows = program.rows_of(directory / "history.csv")
                    self.assertLessEqual(rows[-1]["step"], summary["steps"])
                    self.assertIn("strain_energy", summary["results"])
                    self.assertEqual((directory / "checkpoint.h5").exists(), name != "implicit")
                    if name == "static":
                        self.assertEqual(rows[-1]["step"], summary["steps"])

    def test_ranks_agree_though_one_alone_is_told(self):
        for name, options in SCENES.items():
            with self.subTest(scene=name):
                directory = self.scratch / name
                process = self.start(options, directory, 2)
                self.wait_for_rows(process, directory)
                ranks = children_of(process.pid)
                self.assertEqual(len(ranks), 2)
                os.kill(ranks[1], signal.SIGINT)
                self.judge(process, directory, signal.SIGINT)

    def test_a_long_solve_ends_in_the_midst_of_it(self):
        endless = program.PATCH | {"-ksp_rtol": "1e-300", "-ksp_atol": "0", "-ksp_max_it": "1000000000",
                                   "-ksp_norm_type": "unpreconditioned", "-ksp_type": "richardson"}
        directory = self.scratch / "long"
        process = self.start(endless, directory)
        time.sleep(1.5)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGTERM)
        summary = self.judge(process, directory, signal.SIGTERM)
        self.assertEqual(summary["steps"], 0)

    def test_before_the_first_step_there_is_nothing_but_a_summary(self):
        directory = self.scratch / "early"
        process = self.start(program.PLATE | {"-mesh_cells": "500,500"}, directory)
        while process.poll() is None and not directory.exists():
            time.sleep(0.002)
        process.send_signal(signal.SIGTERM)
        summary = self.judge(process, directory, signal.SIGTERM)
        self.assertEqual(summary["steps"], 0)
        self.assertNotIn("strain_energy", summary["results"] or {})

    def test_nohup_runs_on(self):
        directory = self.scratch / "nohup"
        process = self.start(program.SMALL | {"-load_steps": "2000", "-output_history": ""}, directory, before=["nohup"])
        self.wait_for_rows(process, directory)
        process.send_signal(signal.SIGHUP)
        process.communicate(timeout=program.TIMEOUT)
        summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual((process.returncode, summary["status"], summary["steps"]), (0, "done", 2000))


def children_of(pid):
    """The ranks of an mpirun, by rank."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            environment = dict(word.split("=", 1) for word in (entry / "environ").read_text().split("\0") if "=" in word)
        except (OSError, ValueError):
            continue
        if parent == pid and "OMPI_COMM_WORLD_RANK" in environment:
            found.append((int(environment["OMPI_COMM_WORLD_RANK"]), int(entry.name)))
    return [child for _, child in sorted(found)]


if __name__ == "__main__":
    program.main()
