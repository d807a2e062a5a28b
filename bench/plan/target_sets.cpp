// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/target_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/resources.h"
#include "bench/plan/strict_toml.h"

namespace todbench {
namespace {

const NumberRange metre_range = NumberRange::between(1e-6, 1e6);

constexpr std::size_t most_targets = 64;
/// Every element adds two edges to the spectrum of a view.
constexpr int most_elements = 40000;
constexpr int nearest_background_px = 3, farthest_background_px = 5;
constexpr int least_background_pixels = 16;
/// Standard deviation beside the target, as a share of dT, above which a note warns of the background.
constexpr double uniform_share = 0.1;

/// The background of models.
struct SetBackground {
  double kelvin = 300, emissivity = 1, surround_k = 300;
};

/// Returns a scene with one model from one side, its visible part about the origin.
FieldScene scene_of(const TargetModel& model, double azimuth_deg, const SetBackground& background) {
  FieldScene scene;
  scene.name = model.name;
  scene.background_k = background.kelvin;
  scene.background_emissivity = background.emissivity;
  scene.surround_k = background.surround_k;
  scene.regions = view_of(model, azimuth_deg);
  cv::Point2d low(1e300, 1e300), high(-1e300, -1e300);
  for (const auto& region : scene.regions) {
    for (const auto& v : region.outline_m) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y)};
    }
  }
  for (auto& region : scene.regions) region.outline_m = placed(region.outline_m, 1, -(low + high) / 2);
  return scene;
}

/// Pixels within `distance` of the target, along both axes.
cv::Mat1b grown(const cv::Mat1b& target, int distance) {
  const cv::Size side(2 * distance + 1, 2 * distance + 1);
  cv::Mat1b out;
  cv::dilate(target, out, cv::getStructuringElement(cv::MORPH_RECT, side));
  return out;
}

/// The target of a region as a mask of 0 and 255.
Result<cv::Mat1b> target_in(const cv::Mat1d& kelvin, const cv::Rect& region, const PictureCut& cut) {
  cv::Mat1b target;
  if (cut.mask.empty()) {
    target = cv::Mat1b::zeros(region.size());
    if (cut.above_k) target |= kelvin(region) > *cut.above_k;
    if (cut.below_k) target |= kelvin(region) < *cut.below_k;
  } else {
    target = cut.mask(region) != 0;
  }
  const int count = cv::countNonZero(target);
  if (count == 0) return fail(ErrorCode::invalid_input, "no pixel of the region belongs to the target");
  if (count > most_elements) {
    return fail(
        ErrorCode::invalid_input,
        fmt::format("{} pixels belong to the target, at most {} are possible: state a smaller region, or reduce "
                    "the picture",
                    count, most_elements));
  }
  const cv::Rect inside(1, 1, target.cols - 2, target.rows - 2);
  if (inside.width < 1 || inside.height < 1 || cv::countNonZero(target(inside)) != count)
    return fail(ErrorCode::invalid_input,
                "the target touches the edge of its region, so a part of it or of its background may be missing");
  return target;
}

/// A view of a target as its table describes it.
struct DescribedView {
  std::string file, mask;
  int frames = 1;
  PictureCut cut{};
  std::optional<double> element_m{}, width_m{};
};
struct DescribedTarget {
  std::string name;
  std::vector<DescribedView> views;
};

/// Reads the scale: exactly one of three statements.
void read_scale(TomlReader& table, DescribedView& view) {
  view.element_m = table.optional_number("pixel_m", metre_range);
  view.width_m = table.optional_number("width_m", metre_range);
  const auto ifov_mrad = table.optional_number("ifov_mrad", NumberRange::between(1e-6, 1000));
  const auto distance_m = table.optional_number("distance_m", NumberRange::between(1e-3, 1e6));
  const int stated = (view.element_m ? 1 : 0) + (view.width_m ? 1 : 0) + (ifov_mrad || distance_m ? 1 : 0);
  if (stated != 1 || ifov_mrad.has_value() != distance_m.has_value())
    table.reject("pixel_m", "expected one of pixel_m, width_m, or ifov_mrad with distance_m");
  if (ifov_mrad && distance_m) view.element_m = 1e-3 * *ifov_mrad * *distance_m;
}

DescribedView described_view(TomlReader& table) {
  DescribedView view;
  view.file = table.text("file", std::nullopt);
  view.frames = static_cast<int>(table.whole("frames", 1, 10000, 1));
  const auto region = table.wholes("region", 0, 100000, std::vector<double>{});
  if (!region.empty() && (region.size() != 4 || region[2] < 1 || region[3] < 1)) {
    table.reject("region", "expected x, y, width and height in pixels");
  } else if (!region.empty()) {
    view.cut.region = {static_cast<int>(region[0]), static_cast<int>(region[1]), static_cast<int>(region[2]),
                       static_cast<int>(region[3])};
  }
  view.cut.above_k = table.optional_number("above_k", scene_kelvin_range);
  view.cut.below_k = table.optional_number("below_k", scene_kelvin_range);
  view.cut.background_k = table.optional_number("background_k", scene_kelvin_range);
  view.mask = table.text("mask", "");
  if (view.mask.empty() == !(view.cut.above_k || view.cut.below_k))
    table.reject("mask", "expected either a mask or above_k, below_k or both");
  read_scale(table, view);
  return view;
}

std::vector<DescribedTarget> described_targets(std::vector<TomlReader> tables) {
  std::vector<DescribedTarget> targets;
  for (TomlReader& table : tables) {
    DescribedTarget target{table.text("name", std::nullopt), {}};
    auto views = table.sections("view");
    if (views.empty() || views.size() > most_aspects)
      table.reject("view", fmt::format("expected 1 to {} views", most_aspects));
    if (!targets.empty() && targets.front().views.size() != views.size())
      table.reject("view", "expected as many views as the first target has");
    for (TomlReader& view : views) target.views.push_back(described_view(view));
    targets.push_back(std::move(target));
  }
  return targets;
}

/// Cuts one view and notes whether its background is uniform.
Result<FieldScene> cut_view(DescribedView view, const std::filesystem::path& folder, const SetReaders& readers,
                            std::vector<std::string>& notes) {
  TODBENCH_TRY(const auto kelvin, readers.temperatures((folder / view.file).string(), view.frames));
  if (!view.mask.empty()) {
    TODBENCH_TRY(const auto marked, readers.mask((folder / view.mask).string()));
    view.cut.mask = marked.values != 0;
  }
  TODBENCH_TRY(auto found, cut_target(kelvin, view.cut));
  FieldScene scene;
  scene.background_k = scene.surround_k = found.background_k;
  found.picture.element_m = view.element_m ? *view.element_m : *view.width_m / found.target_px.width;
  const double dt_k = cv::norm(found.picture.kelvin - found.background_k) /
                      std::sqrt(static_cast<double>(cv::countNonZero(found.picture.target)));
  if (!found.background_sd_k) {
    notes.push_back(view.file + ": too little of the background is in the region to tell whether it is uniform");
  } else if (*found.background_sd_k > uniform_share * dt_k) {
    notes.push_back(fmt::format(
        "{}: beside the target the background varies by {:.2g} K (standard deviation), and dT_RSS is {:.2g} K; the "
        "experiment shows the target in front of a uniform background",
        view.file, *found.background_sd_k, dt_k));
  }
  scene.picture = std::move(found.picture);
  TODBENCH_TRY_VOID(validate(scene));
  return scene;
}

Result<void> read_pictures(const std::vector<DescribedTarget>& targets, const std::filesystem::path& folder,
                           const SetReaders& readers, TargetSet& set) {
  if (!readers.temperatures || !readers.mask)
    return fail(ErrorCode::invalid_input, "sets of pictures are not possible here");
  for (const DescribedTarget& described : targets) {
    auto& target = set.targets.emplace_back(IdentificationTarget{described.name, {}});
    for (const DescribedView& view : described.views) {
      auto scene = cut_view(view, folder, readers, set.notes);
      if (!scene)  // also of a missing file: the set is wrong
        return fail(ErrorCode::invalid_input,
                    fmt::format("target {}, {}: {}", described.name, view.file, scene.error().message));
      scene->name = described.name;
      target.aspects.push_back(*std::move(scene));
    }
  }
  return {};
}

Result<void> read_models(const std::vector<std::string>& names, const std::filesystem::path& folder,
                         const SetBackground& background, TargetSet& set) {
  for (const auto& name : names) {
    TODBENCH_TRY(const auto model, load_target(absolute_reference(name, folder)));
    auto& target = set.targets.emplace_back(IdentificationTarget{model.name, {}});
    for (const double azimuth_deg : set.azimuths_deg)
      target.aspects.push_back(scene_of(model, azimuth_deg, background));
  }
  return {};
}

/// Reads the sides of models. A duplicate would count twice in every mean.
std::vector<double> read_sides(TomlReader& reader) {
  auto sides = reader.numbers("azimuths_deg", NumberRange::between(-360, 360), std::nullopt);
  if (sides.empty() || sides.size() > most_aspects)
    reader.reject("azimuths_deg", fmt::format("expected 1 to {} azimuths", most_aspects));
  std::set<double> known;
  for (const double azimuth_deg : sides) {
    // 90 and -270 degrees are the same side.
    if (!known.insert(azimuth_deg - 360 * std::floor(azimuth_deg / 360)).second)
      reader.reject("azimuths_deg", fmt::format("expected every side once, found {:g} degrees twice", azimuth_deg));
  }
  return sides;
}

}  // namespace

Result<CutTarget> cut_target(const cv::Mat1d& kelvin, const PictureCut& cut) {
  const cv::Rect whole({0, 0}, kelvin.size()), region = cut.region.empty() ? whole : cut.region;
  if ((region & whole) != region) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the region ends outside the picture of {} x {} pixels", whole.width, whole.height));
  }
  if (!cut.mask.empty() && cut.mask.size() != kelvin.size()) {
    return fail(ErrorCode::invalid_input, fmt::format("the mask has {} x {} pixels and the picture {} x {}",
                                                      cut.mask.cols, cut.mask.rows, whole.width, whole.height));
  }
  if (!cv::checkRange(kelvin(region)))
    return fail(ErrorCode::invalid_input, "a pixel of the region has no temperature");
  TODBENCH_TRY(const auto target, target_in(kelvin, region, cut));
  const cv::Mat1b beside = grown(target, farthest_background_px) & ~grown(target, nearest_background_px - 1);
  CutTarget out;
  cv::Scalar mean, sd;
  cv::meanStdDev(kelvin(region), mean, sd, beside);
  const bool known = cv::countNonZero(beside) >= least_background_pixels;
  if (known) out.background_sd_k = sd[0];
  if (!known && !cut.background_k) {
    return fail(ErrorCode::invalid_input,
                fmt::format("fewer than {} pixels lie {} to {} pixels beside the target: state a larger region or "
                            "background_k",
                            least_background_pixels, nearest_background_px, farthest_background_px));
  }
  out.background_k = cut.background_k.value_or(mean[0]);
  const cv::Rect box = cv::boundingRect(target);
  out.target_px = box.size();
  const cv::Rect around(box.tl() - cv::Point(1, 1), box.size() + cv::Size(2, 2));
  out.picture.target = target(around).clone();
  out.picture.kelvin = kelvin(region)(around).clone();
  out.picture.kelvin.setTo(out.background_k, out.picture.target == 0);
  return out;
}

Result<TargetSet> load_target_set(std::string_view reference, const SetReaders& readers) {
  TODBENCH_TRY(const auto resource, find_resource(ResourceKind::target_set, reference));
  TODBENCH_TRY(TomlReader reader, TomlReader::parse(resource.text, resource.origin));
  const auto folder = std::filesystem::path(resource.origin).parent_path();
  TargetSet set;
  set.name = reader.text("name", std::nullopt);
  set.description = reader.text("description", "");
  const auto pictures = described_targets(reader.sections("target"));
  std::vector<std::string> models;
  SetBackground background;
  if (pictures.empty()) {
    models = reader.texts("targets", std::nullopt);
    set.azimuths_deg = read_sides(reader);
    background.kelvin = reader.number("background_k", scene_kelvin_range, std::nullopt);
    background.emissivity = reader.number("background_emissivity", scene_share_range, background.emissivity);
    background.surround_k = reader.number("surround_k", scene_kelvin_range, background.kelvin);
  }
  const std::size_t count = pictures.size() + models.size();
  if (count < 2 || count > most_targets)
    reader.reject(pictures.empty() ? "targets" : "target", fmt::format("expected 2 to {} targets", most_targets));
  TODBENCH_TRY_VOID(reader.finish());
  auto read =
      pictures.empty() ? read_models(models, folder, background, set) : read_pictures(pictures, folder, readers, set);
  if (!read) return fail(resource.origin, read.error());
  std::set<std::string> known;
  for (const auto& target : set.targets) {
    if (!known.insert(target.name).second)
      return fail(ErrorCode::invalid_input, resource.origin + ": target '" + target.name + "' is listed twice");
  }
  return set;
}

std::optional<std::pair<double, double>> element_range_m(const TargetSet& set) {
  std::optional<std::pair<double, double>> range;
  for (const auto& target : set.targets) {
    for (const auto& aspect : target.aspects) {
      if (!aspect.picture) continue;
      const double element_m = aspect.picture->element_m;
      range = range ? std::pair(std::min(range->first, element_m), std::max(range->second, element_m))
                    : std::pair(element_m, element_m);
    }
  }
  return range;
}

}  // namespace todbench
