// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/edge_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "tod/camera_measures/plate_offset.h"
#include "tod/camera_measures/plate_tails.h"
#include "tod/measures/mtf50.h"

namespace todbench {
namespace {

constexpr double clear_px = 3.5;      // of a region from the corners of its rectangle and from neighbouring cut-outs
constexpr double longest_reach = 26;  // of a region to both sides of its edge

Polygon in_picture(const PlateRectangle& rectangle, const Registration& where) {
  Polygon outline = outline_mm(rectangle);
  for (cv::Point2d& corner : outline) corner = where.pixel(corner);
  return outline;
}

/// Objects that the region of an edge must stay clear of.
struct Surroundings {
  cv::Rect2d plate;                ///< contains only cut-outs
  std::vector<cv::Rect2d> others;  ///< of other rectangles
};

/// The upright region round the middle of a side whose MTF is along `axis`.
cv::Rect region_of(const Polygon& outline, std::size_t side, EdgeAxis axis, const Surroundings& around) {
  const cv::Point2d a = outline[side], b = outline[(side + 1) % 4], opposite = outline[(side + 2) % 4];
  const cv::Point2d middle = 0.5 * (a + b), along = b - a, depth = opposite - b;
  const bool upright = axis == EdgeAxis::x;
  const double run = std::abs(upright ? along.y : along.x), slant = std::abs(upright ? along.x : along.y);
  const double reach = std::min(0.5 * std::hypot(depth.x, depth.y), longest_reach);
  const double half = 0.5 * run - clear_px - reach * slant / std::max(run, 1e-9);
  const cv::Size2d size = upright ? cv::Size2d(2 * reach, 2 * half) : cv::Size2d(2 * half, 2 * reach);
  cv::Rect2d region(middle.x - size.width / 2, middle.y - size.height / 2, size.width, size.height);
  if (half <= 0) return {};
  region &= around.plate;
  for (const cv::Rect2d& other : around.others) {
    const cv::Rect2d shared = region & other;
    if (shared.area() <= 0) continue;
    // Reduced equally on both sides.
    const double less = (upright ? shared.width : shared.height) + clear_px;
    region = upright ? cv::Rect2d(region.x + less, region.y, region.width - 2 * less, region.height)
                     : cv::Rect2d(region.x, region.y + less, region.width, region.height - 2 * less);
    if (region.width <= 0 || region.height <= 0) return {};
  }
  const cv::Point first(static_cast<int>(std::ceil(region.x)), static_cast<int>(std::ceil(region.y)));
  const cv::Point last(static_cast<int>(std::floor(region.x + region.width)),
                       static_cast<int>(std::floor(region.y + region.height)));
  return {first, last + cv::Point(1, 1)};
}

/// Halos wider than the plate count only if the picture shows them: a plate of some 100 pixels never excludes them.
const std::vector<double>& low_of(const SlantedEdge& side) {
  return side.wide_halo_least > least_wide_share ? side.mtf_low : side.mtf_low_in_picture;
}

/// Mean over the sides. Tails are common to the sides: the mean does not shorten their intervals.
EdgeMtf mean_of(const std::vector<SlantedEdge>& sides) {
  EdgeMtf mean;
  mean.axis = sides.front().axis;
  mean.sides = static_cast<int>(sides.size());
  mean.frequency_per_pitch = sides.front().frequency_per_pitch;
  mean.widest_halo_pitch = sides.front().widest_halo_pitch;
  const auto count = static_cast<double>(sides.size());
  for (const SlantedEdge& side : sides) {
    mean.angle_deg += side.angle_deg / count;
    mean.noise_over_step = std::max(mean.noise_over_step, side.noise_over_step);
    mean.halo_allowance = std::max(mean.halo_allowance, side.halo_allowance);
    mean.wide_halo_least = std::max(mean.wide_halo_least, side.wide_halo_least);
    mean.wide_halo_most = std::max(mean.wide_halo_most, side.wide_halo_most);
  }
  for (std::size_t k = 0; k < mean.frequency_per_pitch.size(); ++k) {
    double sum = 0, below = 0, above = 0, least = sides.front().mtf[k], most = least;
    bool low_known = true;
    for (const SlantedEdge& side : sides) {
      sum += side.mtf[k];
      below += (side.mtf[k] - low_of(side)[k]) / count, above += (side.mtf_high[k] - side.mtf[k]) / count;
      least = std::min(least, side.mtf[k]), most = std::max(most, side.mtf[k]);
      low_known = low_known && side.low_known[k];
    }
    const double value = sum / count, apart = 0.5 * (most - least);
    mean.mtf.push_back(value);
    mean.low.push_back(low_known ? std::max(0.0, value - std::max(below, apart)) : 0);
    mean.high.push_back(value + std::max(above, apart));
  }
  mean.mtf50_per_pitch = first_half(mean.frequency_per_pitch, mean.mtf);
  return mean;
}

double tabulated(const std::vector<double>& frequency, const std::vector<double>& values, double f) {
  const auto next = std::upper_bound(frequency.begin(), frequency.end(), f);
  if (next == frequency.begin()) return values.front();
  if (next == frequency.end()) return values.back();
  const auto i = static_cast<std::size_t>(next - frequency.begin());
  const double share = (f - frequency[i - 1]) / (frequency[i] - frequency[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

/// Both axes of one rectangle.
void add_rectangle(const cv::Mat1d& picture, const std::string& name, const Polygon& outline,
                   const Surroundings& around, const std::optional<PlateTails>& tails, const TailBounds& bounds,
                   PlateEdges& out) {
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    std::vector<SlantedEdge> sides;
    std::vector<std::string> reasons;
    for (std::size_t side = 0; side < 4; ++side) {
      const cv::Point2d along = outline[(side + 1) % 4] - outline[side];
      if ((std::abs(along.y) > std::abs(along.x)) != (axis == EdgeAxis::x)) continue;
      const cv::Rect region = region_of(outline, side, axis, around) & cv::Rect(0, 0, picture.cols, picture.rows);
      const auto here = tails ? std::optional(moved_to(*tails, region.tl())) : std::nullopt;
      const SlantedEdgeOptions options{.axis = axis, .tails = bounds, .plate = here ? &*here : nullptr};
      auto edge = region.area() > 0 ? slanted_edge(picture(region).clone(), options)
                                    : fail(ErrorCode::invalid_input, "the edge has no free surround in the picture");
      if (!edge) {
        reasons.push_back(edge.error().message);
        continue;
      }
      sides.push_back(*std::move(edge));
    }
    std::sort(reasons.begin(), reasons.end());
    reasons.erase(std::unique(reasons.begin(), reasons.end()), reasons.end());
    for (const std::string& reason : reasons)
      out.reasons.push_back(fmt::format("MTF along {} at '{}': {}", to_string(axis), name, reason));
    if (sides.empty()) continue;
    EdgeMtf edge = mean_of(sides);
    edge.place = name;
    edge.middle_px = 0.5 * (outline[0] + outline[2]);
    out.edges.push_back(std::move(edge));
  }
}

}  // namespace

double EdgeMtf::at(double f) const {
  return tabulated(frequency_per_pitch, mtf, f);
}

double EdgeMtf::low_at(double f) const {
  return tabulated(frequency_per_pitch, low, f);
}

double EdgeMtf::high_at(double f) const {
  return tabulated(frequency_per_pitch, high, f);
}

Result<PlateEdges> plate_edges(const cv::Mat1d& picture, const TargetPlate& mounted_plate, const Registration& where,
                               const TailBounds& bounds) {
  if (mounted_plate.rectangles.empty())
    return fail(ErrorCode::invalid_input,
                "plate '" + mounted_plate.name + "' has no rectangles: the MTF needs at least one");
  if (!cv::checkRange(picture))
    return fail(ErrorCode::invalid_input, "the picture contains a value that is not finite");
  std::vector<Polygon> outlines;
  for (const PlateRectangle& rectangle : mounted_plate.rectangles) outlines.push_back(in_picture(rectangle, where));
  TODBENCH_TRY(const auto moved, plate_offset(picture, outlines, mounted_plate.name));
  PlateEdges out;
  out.moved_px = moved;
  for (Polygon& outline : outlines)
    for (cv::Point2d& corner : outline) corner += moved;
  std::vector<cv::Rect2d> bars;
  std::vector<Polygon> cut_outs = outlines;
  for (const PlateRectangle& bar : straight_cut_outs(mounted_plate)) {
    // Bars come after the rectangles.
    Polygon outline = in_picture(bar, where);
    for (cv::Point2d& corner : outline) corner += moved;
    bars.push_back(box_of(outline));
    if (bars.size() > outlines.size()) cut_outs.push_back(std::move(outline));
  }
  bars.erase(bars.begin(), bars.begin() + static_cast<std::ptrdiff_t>(outlines.size()));
  const double w = mounted_plate.width_mm / 2, h = mounted_plate.height_mm / 2;
  const cv::Point2d top_left = where.pixel({-w, -h}) + moved, bottom_right = where.pixel({w, h}) + moved;
  Surroundings around{cv::Rect2d(top_left, bottom_right), {}};
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < outlines.size(); ++i) order.push_back(i);
  const cv::Point2d centre((picture.cols - 1) / 2.0, (picture.rows - 1) / 2.0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cv::norm(0.5 * (outlines[a][0] + outlines[a][2]) - centre) <
           cv::norm(0.5 * (outlines[b][0] + outlines[b][2]) - centre);
  });
  for (const std::size_t i : order) {
    around.others.clear();
    for (std::size_t k = 0; k < outlines.size(); ++k)
      if (k != i) around.others.push_back(box_of(outlines[k]));
    around.others.insert(around.others.end(), bars.begin(), bars.end());
    const auto tails = plate_tails(picture, cut_outs, i, around.plate, bounds);
    add_rectangle(picture, mounted_plate.rectangles[i].name, outlines[i], around, tails, bounds, out);
  }
  return out;
}

}  // namespace todbench
