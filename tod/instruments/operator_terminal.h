// An operator at a terminal: requests are written as lines, answers are read as lines.
#pragma once

#include <iosfwd>
#include <memory>
#include <stop_token>
#include <string>

#include "acquisition/core/result.h"
#include "tod/presentation/operator_request.h"

namespace todbench {

/// Where the operator's answers come from. One thread at a time.
class LineSource {
 public:
  virtual ~LineSource() = default;
  /// The next line without its end. Errors: `interrupted` (at once when stop is requested), `disconnected` (end of
  /// input).
  [[nodiscard]] virtual Result<std::string> next_line(const std::stop_token& stop) = 0;
};

/// Lines from a descriptor that stays the caller's, e.g. 0 for standard input; it is waited on with poll(), so nothing
/// else may read or buffer it. A line longer than 4096 characters is cut.
[[nodiscard]] std::unique_ptr<LineSource> descriptor_lines(int fd);

/// Writes the steps and reads until there is an answer: an empty line is `done`, "q" is `stop`. `out` outlives it.
[[nodiscard]] AskOperator operator_at_terminal(std::ostream& out, std::shared_ptr<LineSource> answers);

}  // namespace todbench
