// SPDX-License-Identifier: GPL-3.0-or-later
// Filter for the system calls of a module in its own network. Private to this folder.
#pragma once

namespace todbench {

/// Returns the descriptor of a file with a seccomp filter for `bwrap --seccomp`, which the caller closes; -1 if there
/// is no filter for the system or processor. The filter forbids UNIX sockets, because their paths lead out of the
/// network of the module; pairs of sockets are allowed.
[[nodiscard]] int module_filter();

}  // namespace todbench
