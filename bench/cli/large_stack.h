// SPDX-License-Identifier: GPL-3.0-or-later
// Stack whose size does not depend on the limit of the shell.
#pragma once

#include <functional>

namespace todbench {

/// Calls `main` and returns its result. If the stack limit (`ulimit -s`) is below 1 MiB, `main` runs on a thread with a
/// stack of 8 MiB. Later threads get stacks of this size. Call it first in main().
[[nodiscard]] int on_a_large_stack(const std::function<int()>& main);

}  // namespace todbench
