// SPDX-License-Identifier: GPL-3.0-or-later
// A network of its own for a test program.
#pragma once

namespace todbench::testing_support {

/// Moves the calling process, which must have one thread, into a network namespace with only a loopback, so that its
/// emulated cameras meet nobody else's. Where the system does not permit that, the host's loopback is shared, one such
/// program at a time, and a line on stderr says so, and who else has the GigE Vision control port.
void enter_private_network();
/// The same with a table of mounts of its own, none of which is seen outside.
void enter_private_network_and_mounts();

}  // namespace todbench::testing_support
