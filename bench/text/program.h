// Ordinary programs of the system, run to their end.
#pragma once

#include <string>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

struct ProgramRun {
  int exit_code = 0;   ///< 128 + the signal where one ended it
  std::string output;  ///< standard output and error, at most 64 KiB
};

enum class ProgramOutput {
  kept,
  shown,  ///< on ours: it may ask something
};

/// Runs a program by name or path, without a shell; standard input is ours. `not_found` with the name, `internal`.
[[nodiscard]] Result<ProgramRun> run_program(std::vector<std::string> words, ProgramOutput output);

}  // namespace todbench
