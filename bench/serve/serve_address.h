// SPDX-License-Identifier: GPL-3.0-or-later
// Address of the live page.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/base/result.h"

namespace todbench {

/// Address and port.
struct ServeAddress {
  std::string host;  ///< address of this computer: "127.0.0.1", "::1", "localhost", or the address of a network card
  int port = 0;      ///< 0: any free port
};

/// Computers that may reach the page.
enum class Reach {
  this_computer,  ///< loopback addresses only
  network,
};

/// Parses "HOST:PORT" or "[IPv6]:PORT". Errors: `invalid_input` (other text, or an address beyond loopback with
/// Reach::this_computer).
[[nodiscard]] Result<ServeAddress> serve_address(std::string_view text, Reach reach);

}  // namespace todbench
