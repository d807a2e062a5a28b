// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/camera_id.h"

#include <cctype>

namespace todbench {
namespace {

std::string in_identity(std::string_view text) {
  std::string clean(text);
  for (char& c : clean) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '_') c = '_';
  }
  return clean;
}

}  // namespace

std::string camera_id(std::string_view scheme, std::string_view name) {
  return std::string(scheme) + ":" + std::string(name);
}

std::string camera_id(std::string_view scheme, std::initializer_list<std::string_view> identity) {
  std::string name;
  for (const auto part : identity) name += "-" + in_identity(part);
  return camera_id(scheme, std::string_view(name).substr(1));
}

std::optional<std::string> camera_name(std::string_view id, std::string_view scheme) {
  if (!id.starts_with(scheme) || !id.substr(scheme.size()).starts_with(':')) return std::nullopt;
  return std::string(id.substr(scheme.size() + 1));
}

}  // namespace todbench
