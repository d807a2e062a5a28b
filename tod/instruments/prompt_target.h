// A bench with a hand only: tells the operator what to do and waits until it is done.
#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <memory>
#include <stop_token>
#include <string>

#include "acquisition/core/result.h"
#include "tod/presentation/target.h"

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

struct PromptTargetOptions {
  /// What the operator operates, for the report.
  std::string description = "set by hand by the operator";
  /// Time base of settling_s, which is here the time the operator took.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// present() writes what has to change since the last state, waits for Enter and believes it: PresentedTarget::state is
/// the state asked for, without temperatures. sets_shift is false: a new shift asks for a slight movement, and how far
/// it went is for the registration to measure. The answer "q" is `interrupted`; after any failure the next prompt
/// states everything again. `out` outlives the target.
[[nodiscard]] std::unique_ptr<Target> prompt_target(std::ostream& out, std::unique_ptr<LineSource> answers,
                                                    PromptTargetOptions options = {});

}  // namespace todbench
