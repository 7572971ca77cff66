"""Many runs in one process, by tests/fuzz/harness.cpp: an MPI program starts and stops more slowly than a small scene is solved."""

import dataclasses
import json
import queue
import subprocess
import threading
import time

import program


@dataclasses.dataclass(frozen=True)
class Outcome:
    """How one run ended."""

    status: int  # exit status, -1 if ranks did not agree on it; None if it hung
    message: str  # of the error
    said: str  # on stderr, without the error
    ended: bool = False  # the process itself, which the program's runs do not


def run(executable, commands, ranks, scratch, patience=program.TIMEOUT, preexec_fn=None):
    """Yields the outcomes of command lines, one after the other. The process runs in `scratch`, and is begun anew behind a run that ends it."""
    listed = scratch / f"list_{len(list(scratch.glob('list_*')))}.json"
    listed.write_text(json.dumps(commands), encoding="utf-8")
    command = [*program.launcher(ranks), str(executable), str(listed)]
    first = 0
    while first < len(commands):
        for outcome in run_from(first, len(commands), command, scratch, patience, preexec_fn):
            first += 1
            yield outcome


def run_from(first, end, command, scratch, patience, preexec_fn):
    """From one run until the process ends, which is that run's fault."""
    said = scratch / "said"
    with open(said, "wb") as err:
        process = subprocess.Popen([*command, str(first)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=err, cwd=scratch, preexec_fn=preexec_fn)
    lines = queue.Queue()
    threading.Thread(target=read, args=(process.stdout, lines), daemon=True).start()
    for k in range(first, end):
        result = next_result(lines, patience)
        if result in (None, "hangs"):
            process.terminate()
            process.wait(patience)
            yield Outcome(None, "", "") if result else Outcome(process.returncode, "", said_in(said, k), ended=True)
            return
        if k + 1 == end:
            process.wait(patience)
        yield Outcome(result["status"], result["message"], said_in(said, k, whole=True))
    if process.returncode:
        raise SystemExit(f"the harness ended with {process.returncode}: {said.read_text(errors='replace')[-1000:]}")


def read(stream, lines):
    with stream:
        for line in stream:
            lines.put(line)
    lines.put(None)


def next_result(lines, patience):
    """The harness' next word: a result, "hangs", or None if it ended. Other words on stdout are passed over."""
    while True:
        try:
            line = lines.get(timeout=patience)
        except queue.Empty:
            return "hangs"
        if line is None:
            return None
        if line.startswith(b'{"case"'):
            return json.loads(line)


def said_in(path, k, whole=False):
    """What was said on stderr in run k; the whole of it, which mpirun brings when it likes, for a process that goes on or has ended well."""
    for _ in range(100):
        text = path.read_bytes().decode(errors="replace")
        part, end, _ = text.rpartition(f"\ncase {k}\n")[2].partition(f"\ncase {k + 1}\n")
        if end or not whole:
            break
        time.sleep(0.02)
    return part
