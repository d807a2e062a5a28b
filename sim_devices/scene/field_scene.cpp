// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/scene/field_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

Result<void> refuse_scene(const std::string& sentence) {
  return fail(ErrorCode::invalid_input, sentence);
}

Result<void> check_temperature(const std::string& of, double kelvin) {
  if (kelvin > 0 && kelvin < 1e5) return {};
  return refuse_scene(
      fmt::format("{}: the temperature must be above 0 K and below 100000 K, found {:g} K", of, kelvin));
}

Result<void> check_region(const SceneRegion& region) {
  const std::string name = "region '" + region.name + "'";
  TODBENCH_TRY_VOID(check_temperature(name, region.temperature_k));
  if (!(region.emissivity >= 0 && region.emissivity <= 1))
    return refuse_scene(fmt::format("{}: the emissivity must be from 0 to 1, found {:g}", name, region.emissivity));
  if (region.outline_m.size() < 3) return refuse_scene(name + ": the outline needs at least three corners");
  for (const auto& v : region.outline_m) {
    if (!(std::abs(v.x) <= 1e6 && std::abs(v.y) <= 1e6))
      return refuse_scene(name + ": a corner lies more than 1000 km from the origin");
  }
  if (!is_simple(region.outline_m)) return refuse_scene(name + ": its outline crosses itself or encloses no area");
  return {};
}

Result<void> check_picture(const ScenePicture& picture) {
  if (picture.kelvin.empty()) return refuse_scene("the picture is empty");
  if (!(picture.element_m > 0 && picture.element_m < 1e7))
    return refuse_scene("the picture has no valid scale: the size of its elements in metres must be known");
  for (const double value : picture.kelvin) {
    TODBENCH_TRY_VOID(check_temperature("the picture", value));
  }
  if (!picture.target.empty() && picture.target.size() != picture.kelvin.size())
    return refuse_scene("the mask of the target and the picture have different sizes");
  return {};
}

double region_radiance(const FieldScene& scene, const SpectralBand& band, double temperature_k, double emissivity) {
  const double own = emissivity > 0 ? emissivity * band_radiance(band, temperature_k) : 0;
  return emissivity < 1 ? own + (1 - emissivity) * band_radiance(band, scene.surround_k) : own;
}

/// Edges in which every region has a level of its own; 0 for regions that are not targets.
std::vector<StepEdge> edges_with(const FieldScene& scene, const std::vector<PaintedPolygon>& levels,
                                 double (*level)(double, bool)) {
  std::vector<PaintedPolygon> painted;
  for (std::size_t i = 0; i < levels.size(); ++i)
    painted.push_back({levels[i].outline, level(levels[i].level, scene.regions[i].target)});
  return visible_edges(painted);
}

std::optional<TargetSignature> signature_of_polygons(const FieldScene& scene, const RadianceScale& scale) {
  const auto levels = levels_k(scene, scale);
  const auto mask = edges_with(scene, levels, [](double, bool target) { return target ? 1.0 : 0.0; });
  TargetSignature out;
  out.area_m2 = integral(mask);
  if (!(out.area_m2 > 0)) return std::nullopt;
  const double mean =
      integral(edges_with(scene, levels, [](double k, bool target) { return target ? k : 0.0; })) / out.area_m2;
  const double square =
      integral(edges_with(scene, levels, [](double k, bool target) { return target ? k * k : 0.0; })) / out.area_m2;
  out.sd_k = std::sqrt(std::max(0.0, square - mean * mean));
  // Scene without the target, for the mean along the outline.
  std::vector<PaintedPolygon> others;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (!scene.regions[i].target) others.push_back(levels[i]);
  }
  double beside = 0, length = 0;
  for (const auto& edge : mask) {
    const cv::Point2d d = edge.b - edge.a;
    const double own = std::hypot(d.x, d.y);
    // A thin strip along the edge, cut like the others, gives the mean level. A mask steps to 1 towards the target.
    constexpr int places = 8;
    for (int k = 0; k < places; ++k) {
      const double sign = edge.step > 0 ? -1 : 1;
      const cv::Point2d place = edge.a + d * ((k + 0.5) / places) + cv::Point2d(d.y, -d.x) * (sign * 1e-6);
      double level = 0;
      for (const auto& other : others) {
        const Polygon& p = other.outline;
        bool inside = false;
        for (std::size_t i = 0; i < p.size(); ++i) {
          const auto &a = p[i], &b = p[(i + 1) % p.size()];
          if ((a.y > place.y) != (b.y > place.y) && place.x < a.x + (b.x - a.x) * (place.y - a.y) / (b.y - a.y))
            inside = !inside;
        }
        if (inside) level = other.level;
      }
      beside += level * own / places;
    }
    length += own;
  }
  out.mean_dt_k = mean - beside / length;
  return out;
}

std::optional<TargetSignature> signature_of_picture(const FieldScene& scene, const RadianceScale& scale) {
  const ScenePicture& picture = *scene.picture;
  if (picture.target.empty() || cv::countNonZero(picture.target) == 0) return std::nullopt;
  const cv::Mat1d levels = picture_levels_k(scene, scale);
  cv::Scalar mean, sd;
  cv::meanStdDev(levels, mean, sd, picture.target);
  double beside = 0;
  int count = 0;
  for (int j = 0; j < levels.rows; ++j) {
    for (int i = 0; i < levels.cols; ++i) {
      if (picture.target(j, i) != 0) continue;
      bool next = false;
      for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        const int x = i + dx, y = j + dy;
        next = next || (x >= 0 && y >= 0 && x < levels.cols && y < levels.rows && picture.target(y, x) != 0);
      }
      if (!next) continue;
      beside += levels(j, i);
      ++count;
    }
  }
  TargetSignature out;
  out.area_m2 = cv::countNonZero(picture.target) * picture.element_m * picture.element_m;
  out.mean_dt_k = mean[0] - (count > 0 ? beside / count : 0);
  out.sd_k = sd[0];
  return out;
}

}  // namespace

Result<void> validate(const FieldScene& scene) {
  TODBENCH_TRY_VOID(check_temperature("background", scene.background_k));
  TODBENCH_TRY_VOID(check_temperature("surround", scene.surround_k));
  if (!(scene.background_emissivity >= 0 && scene.background_emissivity <= 1))
    return refuse_scene("the emissivity of the background must be from 0 to 1");
  if (scene.picture && !scene.regions.empty()) return refuse_scene("a scene has a picture or regions, not both");
  if (scene.picture) return check_picture(*scene.picture);
  if (scene.regions.empty()) return refuse_scene("the scene is empty: it has no region, target, plate or picture");
  for (const auto& region : scene.regions) {
    TODBENCH_TRY_VOID(check_region(region));
  }
  return {};
}

FieldScene scene_of_plate(const TargetPlate& plate, double delta_t_k, double background_k) {
  FieldScene scene;
  scene.name = plate.name;
  scene.description = plate.description;
  scene.background_k = scene.surround_k = background_k;
  for (const auto& t : plate.triangles) {
    scene.regions.push_back({.name = t.name,
                             .outline_m = placed(triangle(t.size_mm, t.apex, t.position_mm), 1e-3, {0, 0}),
                             .temperature_k = background_k + delta_t_k,
                             .emissivity = 1,
                             .target = true});
  }
  for (const auto& r : straight_cut_outs(plate)) {
    scene.regions.push_back({.name = r.name,
                             .outline_m = placed(outline_mm(r), 1e-3, {0, 0}),
                             .temperature_k = background_k + delta_t_k,
                             .emissivity = 1,
                             .target = true});
  }
  return scene;
}

double RadianceScale::kelvin(double radiance_w_m2_sr) const {
  return radiance_w_m2_sr / band_radiance_derivative(band, calibration_k);
}

double background_radiance(const FieldScene& scene, const SpectralBand& band) {
  return region_radiance(scene, band, scene.background_k, scene.background_emissivity);
}

std::vector<PaintedPolygon> levels_k(const FieldScene& scene, const RadianceScale& scale) {
  const double background = background_radiance(scene, scale.band);
  std::vector<PaintedPolygon> painted;
  for (const auto& region : scene.regions) {
    const double own = region_radiance(scene, scale.band, region.temperature_k, region.emissivity);
    painted.push_back({region.outline_m, scale.kelvin(own - background)});
  }
  return painted;
}

cv::Mat1d picture_levels_k(const FieldScene& scene, const RadianceScale& scale) {
  CV_Assert(scene.picture.has_value());
  const double background = background_radiance(scene, scale.band);
  cv::Mat1d levels(scene.picture->kelvin.size());
  std::transform(scene.picture->kelvin.begin(), scene.picture->kelvin.end(), levels.begin(),
                 [&](double kelvin) { return scale.kelvin(band_radiance(scale.band, kelvin) - background); });
  return levels;
}

double TargetSignature::dt_rss_k() const {
  return std::hypot(mean_dt_k, sd_k);
}

double TargetSignature::size_m() const {
  return std::sqrt(area_m2);
}

std::optional<TargetSignature> target_signature(const FieldScene& scene, const RadianceScale& scale) {
  return scene.picture ? signature_of_picture(scene, scale) : signature_of_polygons(scene, scale);
}

cv::Size2d extent_m(const FieldScene& scene) {
  if (scene.picture) {
    const double element_m = scene.picture->element_m;
    return {scene.picture->kelvin.cols * element_m, scene.picture->kelvin.rows * element_m};
  }
  double left = 1e300, right = -1e300, top = 1e300, bottom = -1e300;
  for (const auto& region : scene.regions) {
    for (const auto& v : region.outline_m) {
      left = std::min(left, v.x);
      right = std::max(right, v.x);
      top = std::min(top, v.y);
      bottom = std::max(bottom, v.y);
    }
  }
  return {std::max(0.0, right - left), std::max(0.0, bottom - top)};
}

}  // namespace todbench
