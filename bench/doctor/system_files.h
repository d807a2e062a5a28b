// Small files of /proc, /sys and /etc under a root of choice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace todbench {

/// The text without white space at its end; nothing when it cannot be read.
[[nodiscard]] std::optional<std::string> file_text(const std::filesystem::path& file);
[[nodiscard]] std::optional<std::int64_t> file_number(const std::filesystem::path& file);
/// Entries of a folder by name, sorted; none when there is no such folder.
[[nodiscard]] std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

/// A network interface that is up and is not the loopback.
struct NetworkInterface {
  std::string name;
  std::int64_t mtu = 0;
  std::int64_t speed_mbit = 0;  ///< 0: not known
  bool wireless = false;
};
[[nodiscard]] std::vector<NetworkInterface> network_interfaces(const std::filesystem::path& root);

}  // namespace todbench
