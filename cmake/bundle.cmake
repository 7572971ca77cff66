# pdx_bundle(TARGET SOURCES...): with PDX_BUNDLE, sources of one folder are compiled some at a time, so that a build of
# everything reads our headers a few times instead of hundreds. A source with options of its own is left alone. Helpers of one
# name in two sources of a folder are an error then, or overloads of each other: give them names that say whose, give the
# source a namespace of its own, or leave sources ALONE that ends of paths match.
function(pdx_bundle target)
  if(NOT PDX_BUNDLE)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  cmake_parse_arguments(B "" "" "ALONE" ${ARGN})
  set(in_bundle 10)
  foreach(source ${B_UNPARSED_ARGUMENTS})
    if(B_ALONE)
      list(JOIN B_ALONE "|" alone)
      if(source MATCHES "(${alone})$")
        set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
        continue()
      endif()
    endif()
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(folder ${folder} NAME)
    if(NOT folder STREQUAL last_folder)
      set(last_folder ${folder})
      set(count 0)
    endif()
    math(EXPR number "${count} / ${in_bundle}")
    math(EXPR count "${count} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${folder}${number}")
  endforeach()
endfunction()

# pdx_read_once(TARGET [HEADERS...]): with PDX_BUNDLE, other people's headers are read once for all of a target's sources.
set(pdx_foreign_headers
    <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <map> <numeric> <optional> <set> <span> <string> <vector>
    <Eigen/Dense> <fmt/format.h> <fmt/ranges.h> <petscdmplex.h> <petscsnes.h> <petscts.h>)
function(pdx_read_once target)
  if(PDX_BUNDLE)
    target_precompile_headers(${target} PRIVATE ${pdx_foreign_headers} ${ARGN})
  endif()
endfunction()
