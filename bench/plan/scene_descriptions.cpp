// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/scene_descriptions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "acquisition/base/try.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/strict_toml.h"

namespace todbench {
namespace {

const NumberRange scene_place_range = NumberRange::between(-1e6, 1e6);

/// Builds the outline from two lists of coordinates, y as in the file.
Polygon outline_of(TomlReader& table, const char* x_key, const char* y_key) {
  const auto x = table.numbers(x_key, scene_place_range, std::nullopt);
  const auto y = table.numbers(y_key, scene_place_range, std::nullopt);
  Polygon outline;
  if (x.size() != y.size()) {
    table.reject(y_key, fmt::format("expected {1} values as in {0}, found {2}", x_key, x.size(), y.size()));
    return outline;
  }
  for (std::size_t i = 0; i < x.size(); ++i) outline.emplace_back(x[i], y[i]);
  return outline;
}

Polygon flipped(Polygon outline) {
  for (auto& v : outline) v.y = -v.y;
  return outline;
}

SceneRegion read_region(TomlReader& table, std::size_t number) {
  SceneRegion region;
  region.name = table.text("name", fmt::format("{}", number));
  region.outline_m = flipped(outline_of(table, "x_m", "y_m"));
  region.temperature_k = table.number("temperature_k", scene_kelvin_range, std::nullopt);
  region.emissivity = table.number("emissivity", scene_share_range, region.emissivity);
  region.target = table.flag("target", region.target);
  return region;
}

std::filesystem::path folder_of(const Resource& resource) {
  return std::filesystem::path(resource.origin).parent_path();
}

Result<TargetModel> parse_target(const Resource& resource) {
  TODBENCH_TRY(TomlReader reader, TomlReader::parse(resource.text, resource.origin));
  TargetModel model;
  model.name = reader.text("name", std::nullopt);
  model.description = reader.text("description", "");
  auto parts = reader.sections("part");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    TomlReader& table = parts[i];
    TargetPart part;
    part.name = table.text("name", fmt::format("{}", i + 1));
    part.profile_m = outline_of(table, "x_m", "z_m");
    part.width_m = table.number("width_m", NumberRange::between(1e-6, 9999), std::nullopt);
    part.side_m = table.number("side_m", scene_place_range, part.side_m);
    part.temperature_k = table.number("temperature_k", scene_kelvin_range, std::nullopt);
    part.emissivity = table.number("emissivity", scene_share_range, part.emissivity);
    const bool both = table.flag("both_sides", false);
    model.parts.push_back(part);
    if (both) {
      part.side_m = -part.side_m;
      model.parts.push_back(part);
    }
  }
  TODBENCH_TRY_VOID(reader.finish());
  if (const Result<void> possible = validate(model); !possible) return fail(resource.origin, possible.error());
  return model;
}

/// Adds the regions of a target that a scene names.
Result<void> add_target(TomlReader& table, const std::filesystem::path& folder, FieldScene& scene) {
  const std::string reference = table.text("target", "");
  const double azimuth_deg = table.number("azimuth_deg", NumberRange::between(-360, 360), 90.0);
  const double x_m = table.number("x_m", scene_place_range, 0.0), y_m = table.number("y_m", scene_place_range, 0.0);
  if (reference.empty()) {
    table.reject("target", "expected the name or the file of a target");
    return {};
  }
  TODBENCH_TRY(auto model, load_target(absolute_reference(reference, folder)));
  for (auto& region : view_of(model, azimuth_deg)) {
    region.outline_m = placed(region.outline_m, 1, {x_m, -y_m});
    scene.regions.push_back(std::move(region));
  }
  return {};
}

Result<void> add_plate(TomlReader table, const std::filesystem::path& folder, FieldScene& scene) {
  if (!table.present()) return {};
  const std::string reference = table.text("plate", "");
  const double delta_t_k = table.number("delta_t_k", NumberRange::between(-1000, 1000), std::nullopt);
  if (reference.empty()) {
    table.reject("plate", "expected the name or the file of a plate");
    return {};
  }
  TODBENCH_TRY(auto plate, load_plate(absolute_reference(reference, folder)));
  for (auto& region : scene_of_plate(plate, delta_t_k, scene.background_k).regions)
    scene.regions.push_back(std::move(region));
  return {};
}

Result<void> add_picture(TomlReader table, const std::filesystem::path& folder, const PictureReader& read,
                         FieldScene& scene) {
  if (!table.present()) return {};
  const std::string file = table.text("file", ""), mask = table.text("mask", "");
  ScenePicture picture;
  const double pixel_mrad = table.number("pixel_mrad", NumberRange::between(1e-6, 1000), std::nullopt);
  picture.element_m = 1e-3 * pixel_mrad * table.number("range_m", NumberRange::between(1e-3, 1e6), std::nullopt);
  const auto kelvin_per_count = table.optional_number("kelvin_per_count", NumberRange::between(1e-9, 1000));
  const auto offset_k = table.optional_number("offset_k", NumberRange::between(-1000, 99999));
  if (file.empty()) {
    table.reject("file", "expected a TIFF file");
    return {};
  }
  const auto path_of = [&](const std::string& name) { return (folder / name).string(); };
  TODBENCH_TRY(auto stored, read(path_of(file)));
  if (stored.kind == StoredPicture::Kind::counts && (!kelvin_per_count || !offset_k)) {
    return fail(ErrorCode::invalid_input,
                path_of(file) + ": a picture of integer counts needs a scale, kelvin_per_count and offset_k");
  }
  picture.kelvin = stored.values * kelvin_per_count.value_or(1) + offset_k.value_or(0);
  if (!mask.empty()) {
    TODBENCH_TRY(auto marked, read(path_of(mask)));
    picture.target = marked.values != 0;
  }
  scene.picture = std::move(picture);
  return {};
}

template <typename T>
Result<T> checked_scene(const TomlReader& reader, const Resource& resource, T value) {
  TODBENCH_TRY_VOID(reader.finish());
  if (const Result<void> possible = validate(value); !possible) return fail(resource.origin, possible.error());
  return value;
}

}  // namespace

Result<FieldScene> load_scene(std::string_view reference, const PictureReader& read_picture) {
  TODBENCH_TRY(const auto resource, find_resource(ResourceKind::scene, reference));
  TODBENCH_TRY(TomlReader reader, TomlReader::parse(resource.text, resource.origin));
  FieldScene scene;
  scene.name = reader.text("name", std::nullopt);
  scene.description = reader.text("description", "");
  scene.background_k = reader.number("background_k", scene_kelvin_range, std::nullopt);
  scene.background_emissivity = reader.number("background_emissivity", scene_share_range, scene.background_emissivity);
  scene.surround_k = reader.number("surround_k", scene_kelvin_range, scene.background_k);
  const auto folder = folder_of(resource);
  auto regions = reader.sections("region");
  for (std::size_t i = 0; i < regions.size(); ++i) scene.regions.push_back(read_region(regions[i], i + 1));
  auto targets = reader.sections("target");
  for (TomlReader& table : targets) {
    if (auto added = add_target(table, folder, scene); !added) return fail(resource.origin, added.error());
  }
  // Later in the list than the regions of the scene, so in front of them in the picture.
  auto plate = add_plate(reader.section("plate"), folder, scene);
  if (!plate) return fail(resource.origin, plate.error());
  auto picture = add_picture(reader.section("picture"), folder, read_picture, scene);
  if (!picture) return fail(resource.origin, picture.error());
  return checked_scene(reader, resource, std::move(scene));
}

Result<TargetModel> load_target(std::string_view reference) {
  TODBENCH_TRY(const auto resource, find_resource(ResourceKind::target, reference));
  return parse_target(resource);
}

}  // namespace todbench
