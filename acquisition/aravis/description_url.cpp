#include "acquisition/aravis/description_url.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string>

namespace todbench {
namespace {

std::optional<std::uint64_t> hexadecimal(std::string_view text) {
  if (text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
  // Some cameras append "?SchemaVersion=1.0.0".
  text = text.substr(0, text.find('?'));
  std::uint64_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Result<void> check_description_url(std::string_view url) {
  const auto refused = [&](const std::string& why) {
    return fail(ErrorCode::not_found,
                "the camera states its description as '" + std::string(url.substr(0, 80)) + "': " + why);
  };
  std::string scheme(url.substr(0, url.find(':')));
  std::transform(scheme.begin(), scheme.end(), scheme.begin(), [](unsigned char c) { return std::tolower(c); });
  if (scheme == "file") return {};
  if (scheme != "local") return refused("only descriptions in the camera or in a file are read");
  const auto first = url.find(';');
  const auto second = first == std::string_view::npos ? first : url.find(';', first + 1);
  if (second == std::string_view::npos) return refused("it has no address and size");
  const auto address = hexadecimal(url.substr(first + 1, second - first - 1));
  const auto size = hexadecimal(url.substr(second + 1));
  if (!address || !size) return refused("its address and size are no hexadecimal numbers");
  if (*size == 0 || *size > most_description_bytes) return refused("its size is out of reason");
  return {};
}

}  // namespace todbench
