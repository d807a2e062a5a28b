// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs as child processes, started without a shell. No other part of todbench creates processes.
#pragma once

#include <sys/types.h>

#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Descriptors that the child receives. -1: the child inherits the descriptor of this program (`at_three`: none). The
/// caller closes the copies in this program.
struct ChildStreams {
  int input = -1, output = -1, error = -1;
  int at_three = -1;  ///< becomes descriptor 3
};

/// Process group of a child: a child in `ours` receives Ctrl-C from the terminal of this program; a child in `own` can
/// be ended together with all its children.
enum class ChildGroup { ours, own };

/// Starts a program by name or path, with all signals unblocked and SIGPIPE not ignored. Errors: `not_found` with the
/// name (no such program), `internal`.
[[nodiscard]] Result<pid_t> start_program(std::vector<std::string> words, const ChildStreams& streams = {},
                                          ChildGroup group = ChildGroup::ours);

/// Waits for a child. Returns its exit code, or 128 + the number of the signal that ended it. Errors: `internal` (not a
/// child).
[[nodiscard]] Result<int> wait_for_program(pid_t process);

/// Result of run_program().
struct ProgramRun {
  int exit_code = 0;   ///< 128 + signal number if a signal ended it
  std::string output;  ///< at most 1 MiB; empty for ProgramOutput::shown
};

/// Destination of the output of a child.
enum class ProgramOutput {
  kept,             ///< standard output and standard error are returned
  kept_but_errors,  ///< standard output is returned; standard error is discarded
  shown,            ///< displayed on the output of this program, because the child may ask a question
};

/// Runs a program with the standard input of this program and waits for it. A stop request ends it with SIGTERM. Errors
/// as start_program().
[[nodiscard]] Result<ProgramRun> run_program(std::vector<std::string> words, ProgramOutput output,
                                             const std::stop_token& stop = {});

/// Returns the path of this program.
[[nodiscard]] std::string own_program();

/// Both ends of a new pipe. A child receives an end only if its ChildStreams contain this end.
struct Pipe {
  Descriptor read, write;
};
/// Creates a pipe. Errors: `internal`.
[[nodiscard]] Result<Pipe> make_pipe();

/// Opens /dev/null, to discard output or to provide an empty input.
[[nodiscard]] Descriptor null_device();

}  // namespace todbench
