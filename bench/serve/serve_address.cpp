// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/serve/serve_address.h"

#include <charconv>

#include "acquisition/base/safe_text.h"

namespace todbench {
namespace {

/// Returns whether the address is 127.0.0.0/8 as four plain numbers, "::1" or "localhost"; other spellings are
/// rejected.
bool is_loopback(std::string_view host) {
  if (host == "localhost" || host == "::1") return true;
  if (!host.starts_with("127.")) return false;
  int numbers = 0;
  for (const char* at = host.data(); at < host.data() + host.size();) {
    int value = -1;
    const auto [end, problem] = std::from_chars(at, host.data() + host.size(), value);
    if (problem != std::errc() || value < 0 || value > 255) return false;
    ++numbers;
    if (end == host.data() + host.size()) break;
    if (*end != '.' || end + 1 == host.data() + host.size()) return false;
    at = end + 1;
  }
  return numbers == 4;
}

}  // namespace

Result<ServeAddress> serve_address(std::string_view text, Reach reach) {
  const auto wrong = [&] {
    return fail(ErrorCode::invalid_input,
                "expected HOST:PORT, for example 127.0.0.1:8080, found '" + one_line(text) + "'");
  };
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return wrong();
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    return wrong();
  }
  ServeAddress address{std::string(host), -1};
  const auto [end, problem] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (problem != std::errc() || end != port.data() + port.size() || address.port < 0 || address.port > 65535)
    return wrong();
  for (const char c : host) {
    const bool plain =
        (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-' || c == ':';
    if (!plain) return wrong();
  }
  if (host.empty()) return wrong();
  if (reach == Reach::this_computer && !is_loopback(host)) {
    return fail(
        ErrorCode::invalid_input,
        "'" + std::string(host) +
            "' can be reached from other computers: use a loopback address such as 127.0.0.1, or add --serve-network");
  }
  return address;
}

}  // namespace todbench
