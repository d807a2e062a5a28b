// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/pattern_truth.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <vector>

#include "bench/text/text.h"

namespace todbench {
namespace {

/// In the order of the alternatives of PictureKind.
constexpr std::array<std::string_view, 6> kind_names{"tod", "mrtd", "edge", "ramp", "siemens", "flat"};
static_assert(kind_names.size() == std::variant_size_v<PictureKind>);

std::string toml_list(const std::vector<std::string>& words) {
  return fmt::format("[{}]", fmt::join(words, ", "));
}

/// Returns a plate for load_plate(): one pixel is one millimetre.
std::string plate_toml(const TestPicture& picture) {
  const TargetPlate& plate = picture.plate;
  std::string text = fmt::format(
      "name = \"{}\"\ndescription = \"test picture, 1 pixel = 1 mm, origin in the middle\"\nwidth_mm = {}\nheight_mm = "
      "{}\n",
      plate.name, number_text(plate.width_mm), number_text(plate.height_mm));
  // Every triangle has its own phase, so each row of the file holds one.
  for (const auto& triangle : plate.triangles) {
    text += fmt::format(
        "\n[[row]]\nsize_mm = {}\ny_mm = {}\nx_mm = {}\napex = {}\nnames = {}\n", number_text(triangle.size_mm),
        number_text(triangle.position_mm.y), toml_list({number_text(triangle.position_mm.x)}),
        toml_list({"\"" + std::string(to_string(triangle.apex)) + "\""}), toml_list({"\"" + triangle.name + "\""}));
  }
  return text;
}

std::string other_toml(const PictureRequest& request, const TestPicture& picture) {
  std::string text =
      fmt::format("pattern = \"{}\"\nwidth_px = {}\nheight_px = {}\nlow = {}\nhigh = {}\n", name_of(request.kind),
                  picture.levels.cols, picture.levels.rows, number_text(request.low), number_text(request.high));
  if (const auto* edge = std::get_if<EdgePicture>(&request.kind))
    text += fmt::format("angle_deg = {}\n", number_text(edge->angle_deg));
  if (const auto* star = std::get_if<SiemensPicture>(&request.kind))
    text += fmt::format("spokes = {}\nnyquist_radius_px = {}\n", star->spokes, number_text(finest_radius_px(*star)));
  if (const auto* flat = std::get_if<FlatPicture>(&request.kind))
    text += fmt::format("level = {}\n", number_text(flat->level));
  for (const auto& group : picture.bars) {
    text += fmt::format("\n[[bars]]\nfrequency_per_px = {}\nx_px = {}\ny_px = {}\nbars = \"{}\"\n",
                        number_text(group.frequency_per_px), number_text(group.x_px), number_text(group.y_px),
                        group.upright ? "upright" : "lying");
  }
  return text;
}

}  // namespace

std::string_view name_of(const PictureKind& kind) {
  return kind_names[kind.index()];
}

Result<PictureKind> picture_kind_named(std::string_view name) {
  if (name == "tod") return PictureKind(TodPicture{});
  if (name == "mrtd") return PictureKind(MrtdPicture{});
  if (name == "edge") return PictureKind(EdgePicture{});
  if (name == "ramp") return PictureKind(RampPicture{});
  if (name == "siemens") return PictureKind(SiemensPicture{});
  if (name == "flat") return PictureKind(FlatPicture{});
  constexpr std::string_view of_level = "flat:";
  if (name.starts_with(of_level)) {
    const auto level = parse_number(name.substr(of_level.size()));
    if (level && *level >= 0 && *level <= 1) return PictureKind(FlatPicture{*level});
    return fail(ErrorCode::invalid_input,
                "'" + one_line(name) + "': expected a level from 0 to 1 after 'flat:', as in 'flat:0.25'");
  }
  const std::vector<std::string> known(kind_names.begin(), kind_names.end());
  return fail(ErrorCode::invalid_input, "unknown pattern '" + one_line(name) + "'" + nearest_name_hint(name, known) +
                                            " (known: " + quoted_list(known) + ")");
}

std::string pattern_truth(const PictureRequest& request, const TestPicture& picture, std::string_view shown) {
  const std::string text = fmt::format(
      "# Truth of {}: {} x {} pixels, levels from {} to {}; the value of a pixel is the mean over its area.\n", shown,
      picture.levels.cols, picture.levels.rows, number_text(request.low), number_text(request.high));
  const bool plate = std::holds_alternative<TodPicture>(request.kind);
  return text + (plate ? plate_toml(picture) : other_toml(request, picture));
}

}  // namespace todbench
