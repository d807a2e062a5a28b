// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/description/description_url.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <optional>
#include "acquisition/base/descriptor.h"
#include "acquisition/base/safe_text.h"

namespace todbench {
namespace {

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return text;
}

std::optional<std::uint64_t> hexadecimal(std::string_view text) {
  text = without_blanks(text);
  if (text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
  std::uint64_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 80)) out += c >= ' ' && c < 0x7F ? c : '?';
  return out;
}

}  // namespace

Result<DescriptionUrl> parse_description_url(std::string_view url) {
  const auto refused = [&](const std::string& why) {
    return fail(ErrorCode::not_found, "the camera states its description as '" + printable(url) + "': " + why);
  };
  const std::string scheme = lower_case(url.substr(0, url.find(':')));
  if (scheme.size() >= url.size() || (scheme != "file" && scheme != "local")) {
    return refused("only descriptions stored in the camera or in a file are supported");
  }
  // Some cameras append "?SchemaVersion=1.0.0".
  std::string_view rest = url.substr(scheme.size() + 1);
  rest = rest.substr(0, rest.find_first_of("?#"));
  DescriptionUrl found;
  if (scheme == "file") {
    // The host name, here always this host, does not belong to the path.
    if (rest.starts_with("//")) rest = rest.substr(std::min(rest.size(), rest.find('/', 2)));
    if (rest.empty()) return refused("it has no path");
    found.place = DescriptionUrl::Place::file;
    found.path = rest;
    return found;
  }
  const auto first = rest.find(';');
  const auto second = first == std::string_view::npos ? first : rest.find(';', first + 1);
  if (second == std::string_view::npos || first == 0) return refused("it has no name, address and size");
  const auto address = hexadecimal(rest.substr(first + 1, second - first - 1));
  const auto bytes = hexadecimal(rest.substr(second + 1));
  if (!address || !bytes) return refused("its address and size are not hexadecimal numbers");
  if (*bytes == 0 || *bytes > most_description_bytes)
    return refused("its size is not 1 ... " + std::to_string(most_description_bytes) + " bytes");
  if (*address > std::numeric_limits<std::uint32_t>::max() - *bytes)
    return refused("its address range exceeds 32 bits");
  found.address = static_cast<std::uint32_t>(*address);
  found.bytes = static_cast<std::uint32_t>(*bytes);
  found.path = rest.substr(0, first);
  found.zipped = found.path.ends_with(".zip");
  return found;
}

Result<std::string> read_description_file(const std::string& path) {
  const auto refused = [&](const char* why) {
    return fail(ErrorCode::not_found, "the camera states its description as the file " + printable(path) + ", " + why);
  };
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat facts {};
  if (file.get() < 0 || ::fstat(file.get(), &facts) != 0) return refused("which cannot be read");
  // Kernel files state no size.
  if (!S_ISREG(facts.st_mode) || facts.st_size == 0) return refused("which is empty or not a regular file");
  if (static_cast<std::uint64_t>(facts.st_size) > most_description_bytes) return refused("which is too large");
  std::string text(static_cast<std::size_t>(facts.st_size), '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const auto got = ::read(file.get(), text.data() + done, text.size() - done);
    if (got <= 0) return refused("which cannot be read");
    done += static_cast<std::size_t>(got);
  }
  return text;
}

}  // namespace todbench
