# Writes OUTPUT, a C++ file that says which commit of SOURCE is built. Runs with every build.
execute_process(COMMAND git describe --always --dirty=+changes --exclude=*
  WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include "render/study/provenance.h"

std::string lacuna::sourceCommit() { return "@commit@"; }
]] @ONLY)
