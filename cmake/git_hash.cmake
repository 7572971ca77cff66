# Writes OUTPUT with the commit that SOURCE is at, only where that changed, so that nothing else is compiled again.
# usage: cmake -DSOURCE=directory -DOUTPUT=file -P git_hash.cmake      "unknown" where SOURCE is no clone: a tarball
set(hash "unknown")
find_program(git git)
if(git AND EXISTS "${SOURCE}/.git")
  execute_process(COMMAND ${git} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                  OUTPUT_VARIABLE found RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND found)
    set(hash "${found}")
  endif()
endif()
set(text "#define PDX_GIT_HASH \"${hash}\"\n")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" old)
endif()
if(NOT "${old}" STREQUAL "${text}")
  file(WRITE "${OUTPUT}" "${text}")
endif()
