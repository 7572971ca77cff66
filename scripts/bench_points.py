"""The benchmark of material points: rates of the kernels and of whole steps, in the plane and in space."""
import platform
import statistics

from bench_machine import Bench

KARAMELO = 2.2e6  # point-steps per second of one core: Karamelo, updated, MUSL, hats, linear elastic, on a machine like CI's
BODY = ["-case", "bench", "-analysis", "explicit", "-material_young", "1e9", "-material_poisson", "0.3", "-material_density",
        "1000", "-mpm_spacing", "1e-3", "-mpm_bodies", "body"]
SIZES = {
    "plane, 640 x 640 points": ("plate700_ratio2", 640**2, 300,
                                [*BODY, "-mpm_body_box", "0,0,0.64,0.64", "-mpm_body_spin", "10"]),
    "space, 80 x 80 x 80 points": ("cube60_ratio2", 80**3, 60,
                                   [*BODY, "-material_plane", "solid", "-mpm_body_box", "0,0,0,0.08,0.08,0.08",
                                    "-mpm_body_spin", "10,20,30"]),
}
GRIDS = {
    "plane, 320 x 320 points": ("grid320", 320**2, 300, [*BODY, "-mpm_body_box", "0,0,0.32,0.32", "-mpm_body_velocity", "20,0"]),
    "space, 48 x 48 x 48 points": ("grid48cube", 48**3, 60,
                                   [*BODY, "-material_plane", "solid", "-mpm_body_box", "0,0,0,0.048,0.048,0.048",
                                    "-mpm_body_velocity", "20,0,0"]),
}


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
    return names[0] if names else platform.machine()


class PointBench(Bench):
    def points(self):
        """Both formulations, interleaved with plain loops that scatter; steps of the program on 1 and 2 ranks."""
        self.total()
        self.updated()

    def updated(self):
        """`updated`: a whole step of lanes with each shape function against a plain loop with hats."""
        rates = self.kernel_rates("bench_grid_points", "grid(320|48cube)/")
        rows = []
        for name, (size, points, steps, scene) in GRIDS.items():
            seconds = self.seconds_of_steps([*scene, "-mpm_formulation", "updated", "-ts_safety", "0.3", "-ts_max_steps",
                                             str(steps)])
            rate = {kernel: rates[f"{size}/{kernel}"] for kernel in ("hat", "gimp", "bspline", "plain_scatter")}
            whole = points * steps / seconds["core"]
            self.results[f"points updated {name}"] = {"kernels": rate, "program": whole, "seconds": seconds}
            rows.append([name, *(f"{rate[kernel] / 1e6:.0f}" for kernel in ("hat", "gimp", "bspline")),
                         f"**{rate['hat'] / KARAMELO:.0f}** (goal 20)",
                         f"**{rate['hat'] / rate['plain_scatter']:.1f}** (goal 3.5)", f"{whole / 1e6:.0f}",
                         f"{rate['hat'] / whole:.2f} (goal 1.3)", f"**{seconds[1] / seconds[2]:.2f}** (goal 1.8)"])
        self.table(f"Material points, updated, MUSL, 4 or 8 a cell, million point-steps/s of a core ({processor()})",
                   ["body", "hats", "uGIMP", "B-splines", "hats over Karamelo", "hats over a plain scatter",
                    "steps of the program, hats", "over its lanes", "2 ranks over 1"], rows)

    def total(self):
        """`total`: forces against a plain scatter and a whole step."""
        rates = self.kernel_rates("bench_point_kernel", "(plate700|cube60)_ratio2/(runs|plain_scatter|whole_step|viscous)$")
        rows = []
        for name, (size, points, steps, scene) in SIZES.items():
            seconds = self.seconds_of_steps([*scene, "-ts_max_steps", str(steps)])
            rate = {kernel: rates[f"{size}/{kernel}"] for kernel in ("runs", "plain_scatter", "whole_step", "viscous")}
            whole = points * steps / seconds["core"]
            self.results[f"points {name}"] = {"kernels": rate, "program": whole, "seconds": seconds}
            rows.append([name, f"{rate['runs'] / 1e6:.0f}", f"**{rate['runs'] / rate['plain_scatter']:.1f}** (goal 3.5)",
                         f"{rate['runs'] / rate['whole_step']:.2f} (goal 1.3)", f"{whole / 1e6:.0f}",
                         f"**{whole / KARAMELO:.0f}** (goal 60)", f"{rate['runs'] / whole:.2f} (goal 1.3)",
                         f"**{seconds[1] / seconds[2]:.2f}** (goal 1.8)"])
        self.table(f"Material points, total, 4 or 8 a cell, million point-steps/s of a core ({processor()}); Karamelo: "
                   f"{KARAMELO / 1e6:.1f}, a fixed figure of another run",
                   ["body", "forces", "over a plain scatter", "forces and step, over forces", "steps of the program",
                    "over Karamelo", "steps of the program, over forces", "2 ranks over 1"], rows)

    def seconds_of_steps(self, scene):
        """Processor time of all steps on a core, and wall time on one and two ranks; medians of interleaved rounds."""
        sides = {"core": (1, False), 1: (1, True), 2: (2, True)}
        samples = {side: [] for side in sides}
        for _ in range(self.rounds):
            for side, (ranks, wall) in sides.items():
                samples[side].append(self.run(scene, ranks, wall=wall)["wall_seconds"]["solve"])
        return {side: statistics.median(runs) for side, runs in samples.items()}
