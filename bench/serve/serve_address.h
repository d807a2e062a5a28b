// Where the live page is served.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/core/result.h"

namespace todbench {

struct ServeAddress {
  std::string host;  ///< of this computer: "127.0.0.1", "::1", "localhost", an address of a network card
  int port = 0;      ///< 0: any that is free
};

/// Who may reach the page.
enum class Reach {
  this_computer,  ///< loopback addresses only
  network,
};

/// "HOST:PORT" or "[IPv6]:PORT". `invalid_input` for anything else, and for an address beyond loopback where only this
/// computer may reach the page.
[[nodiscard]] Result<ServeAddress> serve_address(std::string_view text, Reach reach);

}  // namespace todbench
