# What is installed beside the library and find_package(pdx): the Python package with its commands, cases, scripts for users, the
# pages of the documentation, man pages and completion made from the program's own words; and cpack, which makes two .deb:
# pdxsolve, and pdxsolve-dev with library, headers and an example.
set(pdx_python_place lib/python3/dist-packages) # Debian's below /usr; commands find it beside them under any prefix
install(DIRECTORY scripts/pdxtools/ DESTINATION ${pdx_python_place}/pdxtools COMPONENT runtime FILES_MATCHING PATTERN "*.py")
foreach(name report plot vtkhdf pack)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/commands/pdxsolve-${name} @ONLY NEWLINE_STYLE UNIX CONTENT [=[
#!/usr/bin/env python3
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "@pdx_python_place@"))
from pdxtools import @name@

@name@.main()
]=])
  install(PROGRAMS ${PROJECT_BINARY_DIR}/commands/pdxsolve-${name} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
endforeach()
install(FILES scripts/paraview_view.py scripts/mpi_env.sh scripts/slurm/pdxsolve.sbatch DESTINATION ${CMAKE_INSTALL_DATADIR}/pdxsolve
        COMPONENT runtime)
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}-dev RENAME copyright COMPONENT development)
install(DIRECTORY scripts/docs/example/ DESTINATION ${CMAKE_INSTALL_DOCDIR}-dev/example COMPONENT development)
install(DIRECTORY cases DESTINATION ${CMAKE_INSTALL_DATADIR}/pdxsolve COMPONENT runtime
        FILES_MATCHING PATTERN "*.opts" PATTERN "*.csv" PATTERN "*.msh" PATTERN "README.md" PATTERN "*.png")

# Pages and reference: asked of the program when it is installed, so that a build needs no Python.
find_program(PDX_ANY_PYTHON python3)
if(PDX_ANY_PYTHON AND NOT CMAKE_CROSSCOMPILING)
  set(pdx_reference ${PROJECT_BINARY_DIR}/reference)
  install(CODE "execute_process(COMMAND ${PDX_ANY_PYTHON} ${PROJECT_SOURCE_DIR}/scripts/docs/build.py --installed --executable $<TARGET_FILE:pdxsolve> --out ${pdx_reference} RESULT_VARIABLE failed)
if(failed)
  message(WARNING \"no pages, no man pages and no completion: pdxsolve -help -json does not run here\")
endif()" COMPONENT runtime)
  install(DIRECTORY ${pdx_reference}/pages/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime OPTIONAL FILES_MATCHING PATTERN "*.md")
  foreach(name pdxsolve pdxsolve-report pdxsolve-plot pdxsolve-vtkhdf pdxsolve-pack)
    install(FILES ${pdx_reference}/${name}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime OPTIONAL)
  endforeach()
  install(FILES ${pdx_reference}/pdxsolve.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME pdxsolve
          COMPONENT runtime OPTIONAL)
endif()

set(CPACK_PACKAGE_NAME pdxsolve)
set(CPACK_PACKAGE_VENDOR "pdxsolve developers")
set(CPACK_PACKAGE_CONTACT "pdxsolve developers") # as in CITATION.cff; who hands packages on puts an address behind it
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "brittle fracture with elements, peridynamics and material points")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME pdxsolve)
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "Cracks cut finite elements, open into patches of particles and grow there bond
by bond; bodies of material points fly and collide. Static and in time, on any
number of ranks, on PETSc. With cases, a tutorial, and commands that draw runs
and make reports of them.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "paraview, python3-paraview, gmsh, man-db, bash-completion")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "openmpi-bin, python3, python3-numpy, python3-h5py, python3-matplotlib")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME pdxsolve-dev)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "library and headers of pdxsolve
For programs that add physics of their own to a scene: find_package(pdx) of
CMake finds it. An example is in /usr/share/doc/pdxsolve-dev.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "pdxsolve (= ${PROJECT_VERSION}), petsc-dev, libopenmpi-dev, libhdf5-openmpi-dev, libmetis-dev, libeigen3-dev, libfmt-dev, nlohmann-json3-dev, libxxhash-dev, cmake, make, g++, pkgconf")
include(CPack)
