// SPDX-License-Identifier: GPL-3.0-or-later
// Reading of small files of /proc, /sys and /etc under a selectable root.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace todbench {

/// Returns the text without trailing white space; empty if it cannot be read.
[[nodiscard]] std::optional<std::string> file_text(const std::filesystem::path& file);
/// Returns the number in a file; empty if it cannot be read.
[[nodiscard]] std::optional<std::int64_t> file_number(const std::filesystem::path& file);
/// Returns the entries of a folder sorted by name; empty if the folder does not exist.
[[nodiscard]] std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

/// Active network interface, other than the loopback interface.
struct NetworkInterface {
  std::string name;
  std::int64_t mtu = 0;
  std::int64_t speed_mbit = 0;  ///< 0: unknown
  bool wireless = false;
};
/// Returns the active interfaces.
[[nodiscard]] std::vector<NetworkInterface> network_interfaces(const std::filesystem::path& root);

}  // namespace todbench
