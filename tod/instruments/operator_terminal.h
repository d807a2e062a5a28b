// SPDX-License-Identifier: GPL-3.0-or-later
// An operator at a terminal: requests and answers are lines of text.
#pragma once

#include <iosfwd>
#include <memory>
#include <stop_token>
#include <string>

#include "acquisition/base/result.h"
#include "tod/presentation/operator_request.h"

namespace todbench {

/// Source of the operator's answers. One thread at a time.
class LineSource {
 public:
  virtual ~LineSource() = default;
  /// Returns the next line without its end. Errors: `interrupted` (immediately when stop is requested), `disconnected`
  /// (end of input).
  [[nodiscard]] virtual Result<std::string> next_line(const std::stop_token& stop) = 0;
};

/// Returns a source of lines from a descriptor that the caller owns, e.g. 0 for standard input. The source waits with
/// poll(), so no other code may read or buffer the descriptor. Lines are truncated to 4096 characters.
[[nodiscard]] std::unique_ptr<LineSource> descriptor_lines(int fd);

/// Returns a function that writes the steps and reads until an answer arrives: an empty line is `done`, "q" is `stop`.
/// `out` must outlive the returned function.
[[nodiscard]] AskOperator operator_at_terminal(std::ostream& out, std::shared_ptr<LineSource> answers);

}  // namespace todbench
