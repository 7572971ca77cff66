"""The benchmark against LAMMPS: whole explicit steps of one plate of particles in both programs, side by side."""
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from bench_machine import Bench
from bench_motion import directed_bonds

SIDE, SPACING = 320, 1e-3  # particles; [m]
PEER_STEPS, OUR_STEPS = 40, 300  # a second or more of either
# Reach of a bond in spacings, and what of it we are told: our families go half a spacing beyond the horizon.
FAMILIES = {"48 neighbours": 4.1, "68 neighbours": 4.6}
PLATE = ["-case", "peer", "-analysis", "explicit", "-ts_max_time", "1", "-ts_max_steps", str(OUR_STEPS), "-kinematics", "finite",
         "-mesh_lower", "0,0", "-mesh_upper", f"{SIDE * SPACING},{SIDE * SPACING}", "-material_young", "192e9",
         "-material_poisson", "0.33333333333333333", "-material_plane", "stress", "-material_thickness", str(SPACING),
         "-material_density", "2440", "-pd_patches", "all", "-pd_spacing", str(SPACING), "-pd_micromodulus", "uniform",
         "-pd_critical_stretch", "0.01", "-pd_skip_tolerance", "-1", "-bc_names", "top", "-bc_top_on", "top",
         "-bc_top_traction", "0,1e6"]
PEER = """units si
boundary s s f
atom_style peri
atom_modify map array
neighbor {skin} bin
lattice sc {spacing} origin 0.5 0.5 0
region plate block -{half} {half} -{half} {half} -{thin} {thin} units box
region room block -{half} {half} -{half} {half} -{room} {room} units box
create_box 1 room
create_atoms 1 region plate
pair_style peri/pmb
pair_coeff * * 1.0e20 {reach} 0.01 0.0
set group all density 2440
set group all volume {volume}
velocity all ramp vy -0.1 0.1 y -{half} {half} units box
fix motion all nve
compute broken all damage/atom
timestep 1.0e-8
thermo {steps}
run {steps}
"""


class PeerBench(Bench):
    def peers(self):
        """Directed bonds per second of whole steps, breaking watched, one core of either."""
        peer = shutil.which("lmp") or shutil.which("lmp_serial")
        if not peer:
            print("peers: LAMMPS is not installed (Debian and Ubuntu: apt install lammps); left out", flush=True)
            return
        rows = []
        for name, reach in FAMILIES.items():
            ours, others, family = [], [], 0.0
            for _ in range(self.rounds):
                run = self.run([*PLATE, "-pd_horizon_ratio", repr(reach - 0.5)])
                ours.append(run["wall_seconds"]["solve"] / run["steps"])
                seconds, family = self.peer_step(peer, reach)
                others.append(seconds)
            bonds = directed_bonds((SIDE, SIDE), reach)
            rates = [bonds / statistics.median(ours), SIDE**2 * family / statistics.median(others)]
            ratio = statistics.median(theirs / mine * bonds / (SIDE**2 * family) for mine, theirs in zip(ours, others))
            self.results[f"peers {name}"] = {"bonds_per_second": rates, "ratio": ratio, "bonds_per_particle": family}
            rows.append([name, f"{rates[0] / 1e6:.0f}", f"{rates[1] / 1e6:.1f}", f"{SIDE**2 / statistics.median(ours) / 1e6:.2f}",
                         f"{SIDE**2 / statistics.median(others) / 1e6:.2f}", f"**{ratio:.1f}** (goal 36)"])
        self.table(f"Whole steps of {SIDE} x {SIDE} particles against LAMMPS peri/pmb ({self.version(peer)}), one core",
                   ["particles", "ours [1e6 bonds/s]", "LAMMPS [1e6 bonds/s]", "ours [1e6 particle-steps/s]",
                    "LAMMPS [1e6 particle-steps/s]", "bonds per second, ours over LAMMPS"], rows)

    def peer_step(self, peer, reach):
        """Processor time of a step [s] and bonds of a particle, both as LAMMPS tells them."""
        words = {"spacing": SPACING, "half": 0.5 * SIDE * SPACING - 0.25 * SPACING, "thin": 0.25 * SPACING, "room": 10 * SPACING,
                 "reach": reach * SPACING, "volume": SPACING**3, "skin": SPACING, "steps": PEER_STEPS}
        with tempfile.TemporaryDirectory() as directory:
            script = os.path.join(directory, "in.plate")
            with open(script, "w", encoding="utf-8") as file:
                file.write(PEER.format(**words))
            command = [peer, "-in", script, "-log", "none"]
            if hasattr(os, "sched_setaffinity"):
                command = ["taskset", "-c", str(max(os.sched_getaffinity(0))), *command]
            before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            done = subprocess.run(command, cwd=directory, capture_output=True, text=True,
                                  env={**os.environ, "OMP_NUM_THREADS": "1"})
            after, elapsed = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - begin
        loop = re.search(r"Loop time of (\S+) on .* for (\d+) steps with (\d+) atoms", done.stdout)
        family = re.search(r"bonds/atom = (\S+)", done.stdout)
        if done.returncode or not loop or not family or int(loop[3]) != SIDE**2:
            sys.exit(f"{' '.join(command)}\nfailed: {done.stdout[-2000:]}{done.stderr}")
        busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return min(1.0, busy / elapsed) * float(loop[1]) / int(loop[2]), float(family[1])

    @staticmethod
    def version(peer):
        return subprocess.run([peer, "-h"], capture_output=True, text=True).stdout.strip().splitlines()[0].split(" - ", 1)[-1]
