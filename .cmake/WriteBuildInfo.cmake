# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D SOURCE_DIR=... -D OUTPUT=... -D VERSION=... -D COMPILER=... -P WriteBuildInfo.cmake
# Writes the source with the version and the commit. Runs at every build and touches its output only when it changes.

set(commit "unknown")
find_program(GIT git)
if(GIT AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(COMMAND "${GIT}" -C "${SOURCE_DIR}" rev-parse --short=12 HEAD
    OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND head)
    set(commit "${head}")
    execute_process(COMMAND "${GIT}" -C "${SOURCE_DIR}" status --porcelain --untracked-files=no
      OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(changes)
      string(APPEND commit "-modified")
    endif()
  endif()
endif()

set(content "#include \"bench/session/build_info.h\"

namespace todbench {

BuildInfo build_info() { return {\"${VERSION}\", \"${commit}\", \"${COMPILER}\"}; }

}  // namespace todbench
")
set(previous "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" previous)
endif()
if(NOT content STREQUAL previous)
  file(WRITE "${OUTPUT}" "${content}")
endif()
