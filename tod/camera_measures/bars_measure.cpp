// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/bars_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "acquisition/base/normal.h"
#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "hvs/shape/polygon_coverage.h"
#include "tod/camera_measures/bars_profile.h"
#include "tod/camera_measures/edge_measure.h"
#include "tod/camera_measures/plate_offset.h"
#include "tod/range/bars_sampled.h"

namespace todbench {
namespace {

constexpr double clear_of_ends_px = 3.5;
constexpr double clear_of_area_px = 5;   // least distance from every edge of the pixels that give the contrast
constexpr double near_px = 4.5;          // half a pixel less, because pixels are counted by their centres
constexpr double beyond_pattern = 1.75;  // pitches of profile on both sides of the outermost bars
constexpr double knot_step = 0.15;       // of the line spread, in pitches
constexpr double coarser_step = 0.2;     // the difference to a profile with these knots is part of the interval
constexpr double widest_gap = 0.21;      // between samples along the profile
constexpr double method_error = 0.002;   // of a modulation: knots, and the nonlinear part of the correction
constexpr int repetitions = 100;

/// Place of a group and direction of its bars in the picture, from the derivative of the mapping at its middle.
struct GroupFrame {
  cv::Point2d middle;    ///< px
  cv::Matx22d to_mm;     ///< pixels from the middle -> mm across and along the bars
  double px_per_mm = 0;  ///< along the normal of the bars
  cv::Point2d normal;    ///< of the bars, in the picture
};

GroupFrame frame_of(const PlateBars& group, const Registration& where, cv::Point2d moved_px) {
  constexpr double step_mm = 0.5;
  const double angle = group.angle_deg * std::numbers::pi / 180;
  const cv::Point2d across(std::cos(angle), std::sin(angle)), along(-across.y, across.x);
  const auto slope = [&](cv::Point2d direction) {
    return (where.pixel(group.position_mm + direction * step_mm) -
            where.pixel(group.position_mm - direction * step_mm)) *
           (0.5 / step_mm);
  };
  const cv::Point2d u = slope(across), v = slope(along);
  GroupFrame frame;
  frame.middle = where.pixel(group.position_mm) + moved_px;
  frame.to_mm = cv::Matx22d(u.x, v.x, u.y, v.y).inv();
  // Lines of constant place across the bars: the gradient of that place is the first row.
  const cv::Point2d gradient(frame.to_mm(0, 0), frame.to_mm(0, 1));
  frame.px_per_mm = 1 / cv::norm(gradient);
  frame.normal = gradient * frame.px_per_mm;
  return frame;
}

/// Pixels: their places along the normal in pitches from the mapped middle, and their values.
struct ProfileSamples {
  std::vector<double> places, values;
  double width = 0;  ///< of a bar, in pitches
};

Result<ProfileSamples> samples_of(const cv::Mat1d& picture, const PlateBars& group, const GroupFrame& frame) {
  ProfileSamples out;
  out.width = group.bar_mm * frame.px_per_mm;
  const double reach = 3.5 * out.width + beyond_pattern;
  const double half_length_mm = 0.5 * group.length_mm - clear_of_ends_px / frame.px_per_mm;
  if (half_length_mm <= 0) return fail(ErrorCode::invalid_input, "its bars are too short in the picture");
  const double box = std::hypot(reach, 0.5 * group.length_mm * frame.px_per_mm) + 1;
  for (int row = static_cast<int>(frame.middle.y - box); row <= frame.middle.y + box; ++row) {
    for (int x = static_cast<int>(frame.middle.x - box); x <= frame.middle.x + box; ++x) {
      const cv::Vec2d mm = frame.to_mm * cv::Vec2d(x - frame.middle.x, row - frame.middle.y);
      const double t = mm[0] * frame.px_per_mm;
      if (std::abs(t) > reach || std::abs(mm[1]) > half_length_mm) continue;
      if (x < 0 || row < 0 || x >= picture.cols || row >= picture.rows)
        return fail(ErrorCode::calibration, "part of it is outside the picture");
      out.places.push_back(t), out.values.push_back(picture(row, x));
    }
  }
  std::vector<double> sorted = out.places;
  std::sort(sorted.begin(), sorted.end());
  const auto gap = [](double a, double b) { return b - a > widest_gap; };
  if (sorted.size() < 10 || std::adjacent_find(sorted.begin(), sorted.end(), gap) != sorted.end())
    return fail(ErrorCode::invalid_input, "its bars are too short in the picture to show every sampling phase");
  return out;
}

/// The middle of the pattern in a profile, near `from`: the place of best agreement with bars and spaces.
double middle_of(const BarsProfile& profile, double width, double sign, double from) {
  const auto likeness = [&](double middle) {
    constexpr int steps = 8;  // of a bar
    double sum = 0;
    for (int i = 0; i < 7 * steps; ++i) {
      const bool bar = i / steps % 2 == 0;
      sum += sign * profile.value(middle + ((i + 0.5) / steps - 3.5) * width) * (bar ? 1.0 / 4 : -1.0 / 3);
    }
    return sum;
  };
  const double most = std::min(0.7 * width, 1.0), step = 0.05;
  double best = from, height = likeness(from);
  for (double at = from - most; at <= from + most; at += step) {
    if (const double here = likeness(at); here > height) height = here, best = at;
  }
  const double before = likeness(best - step), after = likeness(best + step);
  const double bend = before - 2 * height + after;
  return bend < 0 ? best + 0.5 * step * (before - after) / bend : best;
}

BarModulation modulation_of(const BarsProfile& profile, double middle, double width, double sign) {
  return bar_modulation([&](double x) { return sign * profile.value(x + middle); }, 1 / (2 * width));
}

/// Repetitions with noise: difference of the mean from the noiseless value, and the spread.
struct Repeated {
  double sum = 0, squares = 0;
  void add(double value) { sum += value, squares += value * value; }
  [[nodiscard]] double mean() const { return sum / repetitions; }
  [[nodiscard]] double sd() const {
    return std::sqrt(std::max(0.0, squares / repetitions - mean() * mean()) * repetitions / (repetitions - 1));
  }
  /// `coarser`: result with wider knots.
  [[nodiscard]] Estimate around(double found, double coarser, double contrast, double relative_u95) const {
    const double bias = mean() - found;
    Estimate out;
    out.value = (found - bias) / contrast;
    const double noise = (normal_z95 * sd() + std::abs(bias)) / contrast;
    const double method = std::hypot((found - coarser) / contrast, method_error);
    const double half = std::hypot(noise, std::hypot(relative_u95 * out.value, method));
    out.low = out.value - half, out.high = out.value + half;
    return out;
  }
};

struct LargeAreas {
  double contrast = 0;      ///< signed, corrected
  double far_spread = 0;    ///< correction, relative
  double relative_u95 = 0;  ///< of the contrast
};

/// Takes the place of the middle within the group from the mapping, with the shift of the earlier groups on this axis.
Result<BarsCtf> group_ctf(const cv::Mat1d& picture, const PlateBars& group, const GroupFrame& frame,
                          const LargeAreas& areas, double& offset_pitch, const RandomStream& random) {
  TODBENCH_TRY(const auto samples, samples_of(picture, group, frame));
  const auto fit = BarsFit::of(samples.places, samples.width, offset_pitch, knot_step);
  const auto coarse_fit = BarsFit::of(samples.places, samples.width, offset_pitch, coarser_step);
  if (!fit || !coarse_fit) return fail(ErrorCode::invalid_input, "its image has too few pixels");
  const double sign = areas.contrast < 0 ? -1 : 1, contrast = std::abs(areas.contrast);
  const BarsProfile profile = fit->profile(samples.values);
  const double middle = middle_of(profile, samples.width, sign, offset_pitch);
  const BarModulation found = modulation_of(profile, middle, samples.width, sign);
  const BarModulation coarser = modulation_of(coarse_fit->profile(samples.values), middle, samples.width, sign);
  std::vector<double> smooth;
  double squares = 0;
  for (std::size_t i = 0; i < samples.places.size(); ++i) {
    smooth.push_back(profile.value(samples.places[i]));
    squares += std::pow(samples.values[i] - smooth.back(), 2);
  }
  const double noise = std::sqrt(squares / fit->degrees_of_freedom());

  Repeated best, mean, worst;
  std::vector<double> again = smooth;
  std::uint64_t draw = 0;
  for (int k = 0; k < repetitions; ++k) {
    for (std::size_t i = 0; i < again.size(); ++i) again[i] = smooth[i] + noise * random.normal(draw++);
    const BarModulation one = modulation_of(fit->profile(again), middle, samples.width, sign);
    best.add(one.best), mean.add(one.mean), worst.add(one.worst);
  }
  offset_pitch = middle;
  BarsCtf out;
  out.group = group.name;
  const cv::Point2d& n = frame.normal;
  out.axis = std::abs(n.x) >= std::abs(n.y) ? EdgeAxis::x : EdgeAxis::y;
  const double along = out.axis == EdgeAxis::x ? n.x : n.y, across = out.axis == EdgeAxis::x ? n.y : n.x;
  out.angle_deg = std::atan(across / along) * 180 / std::numbers::pi;
  out.frequency_per_pitch = 1 / (2 * samples.width);
  out.middle_px = frame.middle + n * middle;
  out.pixels = static_cast<int>(samples.places.size());
  out.noise_over_contrast = noise / contrast;
  out.best = best.around(found.best, coarser.best, contrast, areas.relative_u95);
  out.mean = mean.around(found.mean, coarser.mean, contrast, areas.relative_u95);
  out.worst = worst.around(found.worst, coarser.worst, contrast, areas.relative_u95);
  out.bars_separated_at_best = found.bars_separated_at_best;
  out.share_of_four = found.share_of_four;
  return out;
}

Polygon moved_outline(Polygon outline, const Registration& where, cv::Point2d moved_px) {
  for (cv::Point2d& corner : outline) corner = where.pixel(corner) + moved_px;
  return outline;
}

/// Covered share of each pixel by cut-outs.
cv::Mat1d coverage_of(const std::vector<Polygon>& outlines, cv::Size size) {
  cv::Mat1d covered(size, 0.0);
  for (Polygon cells : outlines) {
    for (cv::Point2d& p : cells) p += cv::Point2d(0.5, 0.5);
    covered += pixel_coverage(cells, size);
  }
  return covered;
}

/// Wanted pixels at least clear_of_area_px from every unwanted one.
std::vector<cv::Point> clear_pixels(const cv::Mat1b& wanted, const cv::Rect& within) {
  cv::Mat1f distance;
  cv::distanceTransform(wanted, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  std::vector<cv::Point> pixels;
  for (int row = within.y; row < within.y + within.height; ++row) {
    for (int x = within.x; x < within.x + within.width; ++x)
      if (distance(row, x) > clear_of_area_px) pixels.emplace_back(x, row);
  }
  return pixels;
}

double mean_at(const cv::Mat1d& picture, const std::vector<cv::Point>& pixels) {
  double sum = 0;
  for (const cv::Point& p : pixels) sum += picture(p);
  return sum / static_cast<double>(pixels.size());
}

/// A limited number of the pixels, evenly chosen.
std::vector<cv::Point> some_of(const std::vector<cv::Point>& pixels) {
  constexpr std::size_t most = 60;
  const std::size_t step = (pixels.size() + most - 1) / most;
  std::vector<cv::Point> some;
  for (std::size_t i = 0; i < pixels.size(); i += step) some.push_back(pixels[i]);
  return some;
}

/// Share of light that an MTF of 1 - a f spreads into these pixels from cut-outs further than near_px, per a.
double far_from_cut_outs(const cv::Mat1d& covered, const std::vector<cv::Point>& pixels) {
  double sum = 0;
  for (const cv::Point& p : pixels) {
    for (int row = 0; row < covered.rows; ++row) {
      for (int x = 0; x < covered.cols; ++x) {
        const double r2 = std::pow(x - p.x, 2) + std::pow(row - p.y, 2);
        if (r2 > near_px * near_px) sum += covered(row, x) / (r2 * std::sqrt(r2));
      }
    }
  }
  return sum / (4 * std::numbers::pi * std::numbers::pi * static_cast<double>(pixels.size()));
}

/// Loss of contrast of large areas, per a: inside a cut-out from the plate further than near_px, on the plate from
/// cut-outs. There is no area of the other kind nearer than that.
double far_exchange(const cv::Mat1d& covered, const std::vector<cv::Point>& within,
                    const std::vector<cv::Point>& outside) {
  constexpr double everything = 1 / (2 * std::numbers::pi * near_px);
  return everything - far_from_cut_outs(covered, some_of(within)) + far_from_cut_outs(covered, some_of(outside));
}

/// Initial slope a of the MTF, exp(-a f - c f^2); a normal blur has c only. Mean over the edges of the squares, from
/// 0.1 and 0.2 cycles per pitch.
std::optional<double> slope_of_mtf(const PlateEdges& edges) {
  if (edges.edges.empty()) return std::nullopt;
  double sum = 0;
  const auto fall = [](double mtf) {
    constexpr double least = 1e-3;
    return -std::log(std::max(mtf, least));
  };
  for (const EdgeMtf& edge : edges.edges) sum += (4 * fall(edge.at(0.1)) - fall(edge.at(0.2))) / 0.2;
  return std::max(0.0, sum / static_cast<double>(edges.edges.size()));
}

Result<LargeAreas> large_areas(const cv::Mat1d& picture, const TargetPlate& plate, const Registration& where,
                               cv::Point2d moved_px, const std::vector<Polygon>& outlines) {
  const double w = plate.width_mm / 2, h = plate.height_mm / 2;
  const Polygon border = moved_outline({{-w, -h}, {w, -h}, {w, h}, {-w, h}}, where, moved_px);
  const cv::Rect2d box = box_of(border);
  const cv::Rect whole = cv::Rect(cv::Point(static_cast<int>(std::ceil(box.x)), static_cast<int>(std::ceil(box.y))),
                                  cv::Point(static_cast<int>(box.br().x), static_cast<int>(box.br().y))) &
                         cv::Rect({0, 0}, picture.size());
  if (whole.area() <= 0) return fail(ErrorCode::calibration, "the plate is outside the picture");
  std::vector<Polygon> shifted = outlines;
  for (Polygon& outline : shifted)
    for (cv::Point2d& p : outline) p -= cv::Point2d(whole.tl());
  const cv::Mat1d covered = coverage_of(shifted, whole.size()), seen = picture(whole);
  constexpr int rim = 4;
  const cv::Rect inner(rim, rim, whole.width - 2 * rim, whole.height - 2 * rim);
  const auto within = clear_pixels(covered > 0.999, inner & cv::Rect({0, 0}, whole.size()));
  const auto outside = clear_pixels(covered < 0.001, inner & cv::Rect({0, 0}, whole.size()));
  constexpr std::size_t least_pixels = 9;
  if (within.size() < least_pixels || outside.size() < least_pixels)
    return fail(ErrorCode::calibration, "the squares of plate '" + plate.name + "' are too small in the picture");
  TODBENCH_TRY(const auto edges, plate_edges(picture, plate, where.moved(moved_px)));
  const auto slope = slope_of_mtf(edges);
  if (!slope)
    return fail(ErrorCode::calibration,
                edges.reasons.empty() ? "no edge of the squares could be measured" : edges.reasons.front());
  LargeAreas areas;
  areas.far_spread = *slope * far_exchange(covered, within, outside);
  constexpr double largest_spread = 0.1;
  areas.far_spread = std::min(areas.far_spread, largest_spread);
  areas.contrast = (mean_at(seen, within) - mean_at(seen, outside)) / (1 - areas.far_spread);
  double noise = 0;
  for (const EdgeMtf& edge : edges.edges) noise = std::max(noise, edge.noise_over_step);
  const auto fewest = static_cast<double>(std::min(within.size(), outside.size()));
  // A halo of 5 % changes the contrast by 0.7 (4 pixels) to 1.2 (10 pixels) times the correction.
  areas.relative_u95 = std::hypot(areas.far_spread, normal_z95 * noise * std::sqrt(2 / fewest));
  return areas;
}

}  // namespace

Result<PlateBarsCtf> plate_bars_ctf(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                    const Registration& where, std::uint64_t seed) {
  if (mounted_plate.bars.empty() || mounted_plate.rectangles.empty())
    return fail(ErrorCode::invalid_input, "plate '" + mounted_plate.name + "' needs both bars and squares for the CTF");
  if (!cv::checkRange(picture))
    return fail(ErrorCode::invalid_input, "the picture contains a value that is not finite");
  std::vector<Polygon> outlines;
  for (const PlateRectangle& cut_out : straight_cut_outs(mounted_plate))
    outlines.push_back(moved_outline(outline_mm(cut_out), where, {0, 0}));
  TODBENCH_TRY(const auto moved, plate_offset(picture, outlines, mounted_plate.name));
  for (Polygon& outline : outlines)
    for (cv::Point2d& p : outline) p += moved;
  TODBENCH_TRY(const auto areas, large_areas(picture, mounted_plate, where, moved, outlines));
  PlateBarsCtf out;
  out.contrast_k = areas.contrast;
  out.far_spread = areas.far_spread;
  std::vector<std::pair<GroupFrame, const PlateBars*>> groups;
  for (const PlateBars& group : mounted_plate.bars) groups.emplace_back(frame_of(group, where, moved), &group);
  const auto upright = [](const GroupFrame& frame) { return std::abs(frame.normal.x) >= std::abs(frame.normal.y); };
  // Wide bars first: they locate narrow ones to a fraction of a bar.
  std::stable_sort(groups.begin(), groups.end(), [&](const auto& a, const auto& b) {
    if (upright(a.first) != upright(b.first)) return upright(a.first);
    return a.second->bar_mm > b.second->bar_mm;
  });
  double offsets[] = {0, 0};
  const RandomStream random(seed, "bars");
  for (const auto& [frame, group] : groups) {
    auto ctf = group_ctf(picture, *group, frame, areas, offsets[upright(frame) ? 0 : 1],
                         random.sub(static_cast<std::uint64_t>(out.groups.size())));
    if (ctf)
      out.groups.push_back(*std::move(ctf));
    else
      out.reasons.push_back(fmt::format("CTF of '{}': {}", group->name, ctf.error().message));
  }
  return out;
}

}  // namespace todbench
