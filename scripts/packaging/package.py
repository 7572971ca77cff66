# For Spack: spack repo create R; this file is packages/pdxsolve/package.py of it (Spack 1 names the place), then spack repo add R
# and spack install pdxsolve. Versions are bounded by what the program was built with.
try:
    from spack_repo.builtin.build_systems.cmake import CMakePackage  # Spack 1 and newer
except ImportError:
    pass  # before, it comes with the next line
from spack.package import *


class Pdxsolve(CMakePackage):
    """Brittle fracture with finite elements, bond-based peridynamics and material points, coupled, in parallel."""

    license("BSD-2-Clause")
    # A release or a clone: spack develop --path /place/of/the/clone pdxsolve@main
    version("main", branch="main", git="file:///place/of/the/clone")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("mpi")
    depends_on("petsc@3.18:3.22 +mpi+hypre+metis+hdf5+mumps+suite-sparse ~complex ~int64")
    depends_on("hdf5@1.10:1.14 +mpi")
    depends_on("metis@5:")
    depends_on("eigen@3.4")
    depends_on("fmt@9:10")
    depends_on("nlohmann-json@3.11")
    depends_on("xxhash@0.8:")
    depends_on("python@3.11:", type=("build", "run"))
    depends_on("py-numpy", type="run")
    depends_on("py-h5py", type="run")
    depends_on("py-matplotlib", type="run")

    def cmake_args(self):
        return [self.define("PDX_TESTS", False), self.define("PDX_BUNDLE", True)]
