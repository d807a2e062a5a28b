// Work that nobody waits for, and that does not outlive the program.
#pragma once

#include <functional>
#include <memory>
#include <utility>

namespace todbench {

/// Runs `work` on a thread of its own. Nobody waits for it but the end of the program, which comes after main and
/// before anything static goes; so work has to end by itself, within seconds. Any thread.
void start_in_background(std::function<void()> work);

/// The same for work that is moved and not copied; it is destroyed on its thread when it has run.
template <typename Work>
void finish_in_background(Work work) {
  start_in_background([held = std::make_shared<Work>(std::move(work))]() mutable {
    (*held)();
    held.reset();
  });
}

}  // namespace todbench
