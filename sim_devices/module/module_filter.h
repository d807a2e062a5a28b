// SPDX-License-Identifier: GPL-3.0-or-later
// Filter for the system calls of a module in its own network. Private to this folder.
#pragma once

namespace todbench {

/// Returns the descriptor of a file with a seccomp filter for `bwrap --seccomp`. The filter forbids sockets of every
/// family except IPv4, IPv6 and netlink, because other families (UNIX, VSOCK) are not limited to the module's own
/// network. Pairs of sockets are allowed. The caller closes the file. Returns -1 if there is no filter for this system
/// or processor.
[[nodiscard]] int module_filter();

}  // namespace todbench
