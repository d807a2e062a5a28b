// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/doctor/system_files.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>

namespace todbench {

namespace fs = std::filesystem;

std::optional<std::string> file_text(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (stream.bad()) return std::nullopt;
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ' || text.back() == '\t')) text.pop_back();
  return text;
}

std::optional<std::int64_t> file_number(const fs::path& file) {
  const auto text = file_text(file);
  if (!text) return std::nullopt;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error != std::errc{} || end != text->data() + text->size()) return std::nullopt;
  return value;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    entries.push_back(entry->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<NetworkInterface> network_interfaces(const fs::path& root) {
  std::vector<NetworkInterface> interfaces;
  for (const auto& folder : entries_of(root / "sys/class/net")) {
    NetworkInterface one;
    one.name = folder.filename();
    const auto state = file_text(folder / "operstate").value_or("");
    // Tunnels and some virtual interfaces report "unknown" while they work.
    if (one.name == "lo" || (state != "up" && state != "unknown")) continue;
    one.mtu = file_number(folder / "mtu").value_or(0);
    one.speed_mbit = std::max<std::int64_t>(0, file_number(folder / "speed").value_or(0));
    std::error_code error;
    one.wireless = fs::exists(folder / "wireless", error);
    interfaces.push_back(std::move(one));
  }
  return interfaces;
}

}  // namespace todbench
