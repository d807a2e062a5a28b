// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/measure_pictures.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <utility>

#include "bench/text/base64.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::string_view png_ending = ".png";
constexpr std::string_view png_signature = "\x89PNG\r\n\x1a\n";
/// Keys of the pictures of a plate, and parts of their file names.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> panel_keys{
    {{"seen_png", "plate-seen"}, {"expected_png", "plate-expected"}, {"difference_png", "plate-difference"}}};
constexpr std::array<std::string_view, 2> side_keys{"main", "twin"};

/// Calls `with` for every picture with its object, key and name. If it returns false, the list element is removed.
template <typename Function>
void for_each_picture(Json& measures, const Function& with) {
  for (const std::string_view side : side_keys) {
    const auto found = measures.find(std::string(side));
    if (found == measures.end() || !found->is_object()) continue;
    if (const auto picture = found->find("picture"); picture != found->end() && picture->is_object()) {
      for (const auto& [key, name] : panel_keys)
        with(*picture, std::string(key), std::string(side) + "-" + std::string(name));
    }
    const auto maps = found->find("maps");
    if (maps == found->end() || !maps->is_array()) continue;
    std::map<std::string, int> used;
    for (Json& map : *maps) {
      if (!map.is_object()) continue;
      const auto name = map.find("name");
      std::string text = name != map.end() && name->is_string() ? name->template get<std::string>() : "map";
      for (char& c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') c = '-';
      const int number = ++used[text];
      with(map, "png", std::string(side) + "-" + text + (number > 1 ? "-" + std::to_string(number) : ""));
    }
  }
}

bool names_a_file(const Json& object, const std::string& key) {
  const auto value = object.find(key);
  return value != object.end() && value->is_string() && value->get_ref<const std::string&>().ends_with(png_ending);
}

/// Returns whether the path is "pictures/NAME.png" with letters, digits, hyphens and underscores in NAME.
bool is_picture_name(std::string_view name) {
  if (!name.starts_with(pictures_folder)) return false;
  name.remove_prefix(pictures_folder.size());
  if (!name.starts_with('/')) return false;
  name.remove_prefix(1);
  name.remove_suffix(png_ending.size());
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
  });
}

/// Removes objects that have lost their picture.
void drop_incomplete(Json& measures) {
  for (const std::string_view key : side_keys) {
    const auto side = measures.find(std::string(key));
    if (side == measures.end() || !side->is_object()) continue;
    if (const auto picture = side->find("picture"); picture != side->end() && picture->is_object()) {
      const bool whole = std::all_of(panel_keys.begin(), panel_keys.end(), [&](const auto& panel) {
        const auto value = picture->find(std::string(panel.first));
        return value == picture->end() || !value->is_null();
      });
      if (!whole) *picture = nullptr;
    }
    const auto maps = side->find("maps");
    if (maps == side->end() || !maps->is_array()) continue;
    Json kept = Json::array();
    for (Json& map : *maps) {
      const auto value = map.is_object() ? map.find("png") : map.end();
      if (!map.is_object() || value == map.end() || !value->is_null()) kept.push_back(std::move(map));
    }
    *maps = std::move(kept);
  }
}

}  // namespace

std::vector<MeasurePicture> take_pictures(Json& measures) {
  std::vector<MeasurePicture> pictures;
  for_each_picture(measures, [&](Json& object, const std::string& key, const std::string& name) {
    const auto value = object.find(key);
    if (value == object.end() || !value->is_string()) return;
    auto bytes = from_base64(value->get_ref<const std::string&>());
    if (!bytes) return;
    std::string file = std::string(pictures_folder) + "/" + name + std::string(png_ending);
    *value = file;
    pictures.push_back({std::move(file), *std::move(bytes)});
  });
  return pictures;
}

Result<Json> with_pictures(Json measures, const std::filesystem::path& folder) {
  std::optional<Error> wrong;
  std::map<std::string, std::vector<std::string>> missing;  // by side
  for_each_picture(measures, [&](Json& object, const std::string& key, const std::string& name) {
    if (wrong || !names_a_file(object, key)) return;
    const std::string file = object[key].get<std::string>();
    if (!is_picture_name(file)) {
      wrong = Error{ErrorCode::invalid_input, "'" + key + "': expected the name of a picture in pictures/"};
      return;
    }
    std::error_code problem;
    if (!std::filesystem::is_regular_file(folder / file, problem)) {
      missing[name.substr(0, name.find('-'))].push_back("the picture " + file + " is missing");
      object[key] = nullptr;
      return;
    }
    const auto bytes = read_text_file(folder / file);
    if (!bytes)
      wrong = bytes.error();
    else if (!bytes->starts_with(png_signature))
      wrong = Error{ErrorCode::invalid_input, file + ": not a PNG file"};
    else
      object[key] = base64(*bytes);
  });
  if (wrong) return tl::unexpected(*wrong);
  if (missing.empty()) return measures;
  drop_incomplete(measures);
  for (const auto& [side, sentences] : missing) {
    Json& reasons = measures[side]["reasons"];
    if (!reasons.is_array()) continue;
    for (const std::string& sentence : sentences) reasons.push_back(sentence);
  }
  return measures;
}

}  // namespace todbench
