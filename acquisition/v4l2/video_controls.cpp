// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/v4l2/video_controls.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

#include "acquisition/base/safe_text.h"

namespace todbench {
namespace {

/// Limit for a driver whose enumeration does not end.
constexpr int most_controls = 1024;
constexpr std::int64_t most_entries = 256;

template <typename Char, std::size_t N>
std::string text_of(const Char (&field)[N]) {
  std::string text;
  for (const auto c : field) {
    if (c == 0) break;
    text += static_cast<char>(c);
  }
  return text;
}

std::string name_of(const std::string& text) {
  std::string name;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  }
  return name;
}

bool is_plain(std::uint32_t type) {
  return type == V4L2_CTRL_TYPE_INTEGER || type == V4L2_CTRL_TYPE_BOOLEAN || type == V4L2_CTRL_TYPE_MENU ||
         type == V4L2_CTRL_TYPE_INTEGER_MENU || type == V4L2_CTRL_TYPE_BUTTON;
}

std::map<std::int64_t, std::string> menu_of(const VideoDevice& device, const VideoControl& control) {
  std::map<std::int64_t, std::string> menu;
  if (control.type != V4L2_CTRL_TYPE_MENU && control.type != V4L2_CTRL_TYPE_INTEGER_MENU) return menu;
  const auto last = std::min(control.maximum, control.minimum + most_entries);
  for (auto value = std::max<std::int64_t>(0, control.minimum); value <= last; ++value) {
    v4l2_querymenu entry{};
    entry.id = control.id;
    entry.index = static_cast<__u32>(value);
    if (device.call(VIDIOC_QUERYMENU, &entry) != 0) continue;
    std::int64_t number = 0;
    std::memcpy(&number, entry.name, sizeof number);  // name and value share their memory
    menu[value] = control.type == V4L2_CTRL_TYPE_MENU ? text_of(entry.name) : std::to_string(number);
  }
  return menu;
}

std::optional<std::int64_t> parsed(const VideoControl& control, const std::string& text) {
  for (const auto& [value, entry] : control.menu) {
    if (entry == text) return value;
  }
  if (control.type == V4L2_CTRL_TYPE_BUTTON) return 1;
  if (control.type == V4L2_CTRL_TYPE_BOOLEAN && (text == "true" || text == "false")) return text == "true" ? 1 : 0;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if (value < control.minimum || value > control.maximum) return std::nullopt;
  return value;
}

std::string allowed(const VideoControl& control) {
  if (control.menu.empty()) return std::to_string(control.minimum) + " ... " + std::to_string(control.maximum);
  std::string entries;
  for (const auto& [value, entry] : control.menu) entries += (entries.empty() ? "" : ", ") + entry;
  return "one of " + entries;
}

}  // namespace

std::vector<VideoControl> list_controls(const VideoDevice& device) {
  std::vector<VideoControl> controls;
  std::uint32_t last = 0;
  for (int k = 0; k < most_controls; ++k) {
    v4l2_query_ext_ctrl query{};
    query.id = last | V4L2_CTRL_FLAG_NEXT_CTRL;
    if (device.call(VIDIOC_QUERY_EXT_CTRL, &query) != 0 || query.id <= last) break;
    last = query.id;
    if (!is_plain(query.type) || (query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_INACTIVE)) != 0) continue;
    VideoControl control{
        .name = name_of(text_of(query.name)),
        .id = query.id,
        .type = query.type,
        .minimum = query.minimum,
        .maximum = query.maximum,
        .readable = (query.flags & V4L2_CTRL_FLAG_WRITE_ONLY) == 0 && query.type != V4L2_CTRL_TYPE_BUTTON,
        .writable = (query.flags & V4L2_CTRL_FLAG_READ_ONLY) == 0,
        .menu = {}};
    control.menu = menu_of(device, control);
    controls.push_back(std::move(control));
  }
  return controls;
}

const VideoControl* find_control(const std::vector<VideoControl>& controls, const std::string& name) {
  const auto found = std::find_if(controls.begin(), controls.end(), [&](const auto& c) { return c.name == name; });
  return found != controls.end() ? &*found : nullptr;
}

Result<std::string> get_control(const VideoDevice& device, const VideoControl& control) {
  if (!control.readable) return fail(ErrorCode::invalid_input, control.name + " cannot be read");
  v4l2_control value{.id = control.id, .value = 0};
  if (const int error = device.call(VIDIOC_G_CTRL, &value); error != 0) {
    return tl::unexpected(video_error(error, "reading " + control.name, ErrorCode::invalid_input));
  }
  const auto entry = control.menu.find(value.value);
  return entry != control.menu.end() ? entry->second : std::to_string(value.value);
}

Result<void> set_control(const VideoDevice& device, const VideoControl& control, const std::string& text) {
  if (!control.writable) return fail(ErrorCode::invalid_input, control.name + " cannot be written");
  const auto number = parsed(control, text);
  if (!number) {
    return fail(ErrorCode::invalid_input, control.name + " = " + text + ": expected " + allowed(control));
  }
  v4l2_control value{.id = control.id, .value = static_cast<__s32>(*number)};
  if (const int error = device.call(VIDIOC_S_CTRL, &value); error != 0) {
    return tl::unexpected(video_error(error, "setting " + control.name, ErrorCode::invalid_input));
  }
  return {};
}

const VideoControl* nonuniformity_button(const std::vector<VideoControl>& controls) {
  for (const auto& control : controls) {
    if (control.type != V4L2_CTRL_TYPE_BUTTON || !control.writable) continue;
    const std::string name = lower_case(control.name);
    for (const char* word : {"nuc", "ffc", "shutter", "flatfield", "nonuniformity", "calibrat"}) {
      if (name.find(word) != std::string::npos) return &control;
    }
  }
  return nullptr;
}

}  // namespace todbench
