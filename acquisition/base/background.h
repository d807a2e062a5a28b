// SPDX-License-Identifier: GPL-3.0-or-later
// Work in the background that ends before the program does.
#pragma once

#include <functional>
#include <memory>
#include <utility>

namespace todbench {

/// Runs `work` on a separate thread. The program waits for this thread after main, before static objects are destroyed.
/// The work must therefore end within seconds, because it receives no stop request. Any thread.
void start_in_background(std::function<void()> work);

/// Like start_in_background(), but for move-only work. The work is destroyed on its thread after it has run.
template <typename Work>
void finish_in_background(Work work) {
  start_in_background([held = std::make_shared<Work>(std::move(work))]() mutable {
    (*held)();
    held.reset();
  });
}

}  // namespace todbench
