// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/mrtd_measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string_view>

#include "acquisition/base/try.h"
#include "tod/camera_measures/bars_judge.h"
#include "tod/camera_measures/plate_offset.h"

namespace todbench {
namespace {

const MrtdPoint* nearest(const std::vector<MrtdPoint>& points, double MrtdPoint::*value, double wanted,
                         std::optional<EdgeAxis> axis) {
  const MrtdPoint* found = nullptr;
  for (const MrtdPoint& one : points) {
    if (axis && one.axis != *axis) continue;
    if (found == nullptr || std::abs(one.*value - wanted) < std::abs(found->*value - wanted)) found = &one;
  }
  return found;
}

/// Name of the group of a rectangle "NAME, bar 3"; empty: it is no bar.
std::optional<std::string> group_of_bar(const std::string& name) {
  constexpr std::string_view mark = ", bar ";
  const auto at = name.rfind(mark);
  if (at == std::string::npos || at + mark.size() + 1 != name.size()) return std::nullopt;
  return name.substr(0, at);
}

std::map<std::string, std::vector<PlateRectangle>> groups_of_five(const TargetPlate& plate) {
  std::map<std::string, std::vector<PlateRectangle>> groups;
  for (const PlateRectangle& one : plate.rectangles) {
    if (const auto group = group_of_bar(one.name)) groups[*group].push_back(one);
  }
  return groups;
}

/// Place of a set-up between the pixels, in pixels: even phases in x and y that do not repeat together, and whole
/// pixels, which move the picture to other detectors.
cv::Point2d set_up_shift_px(int set_up, int set_ups) {
  int stride = 2;
  while (std::gcd(stride, set_ups) > 1) ++stride;
  const auto phase = [&](int step) { return (step % set_ups + 0.5) / set_ups - 0.5; };
  return {set_up % 3 - 1 + phase(set_up), set_up / 3 % 3 - 1 + phase(stride * set_up)};
}

Result<cv::Point2d> located(const cv::Mat1d& picture, const TargetPlate& mounted_plate, const Registration& where) {
  std::vector<Polygon> outlines;
  for (const PlateRectangle& cut_out : straight_cut_outs(mounted_plate)) {
    outlines.push_back(outline_mm(cut_out));
    for (cv::Point2d& corner : outlines.back()) corner = where.pixel(corner);
  }
  return plate_offset(picture, outlines, mounted_plate.name);
}

}  // namespace

const MrtdPoint* MrtdMeasure::stated(EdgeAxis axis) const {
  return nearest(bars, &MrtdPoint::frequency_per_pitch, frequency_per_pitch, axis);
}

const MrtdPoint* MrtdMeasure::stated_spot() const {
  return nearest(spots, &MrtdPoint::size_px, spot_px, std::nullopt);
}

std::vector<BarPair> bar_pairs(const TargetPlate& plate) {
  constexpr double same_square = 0.005, same_axis_deg = 1;
  const auto differs = [](double a, double b) { return std::abs(a - b) > same_square * b; };
  const auto groups = groups_of_five(plate);
  std::vector<BarPair> pairs;
  for (const PlateBars& four : plate.bars) {
    std::optional<BarPair> best;
    for (const auto& [name, bars] : groups) {
      if (bars.size() != 5 || std::abs(bars.front().angle_deg - four.angle_deg) > same_axis_deg) continue;
      if (differs(9 * bars.front().size_mm.width, 7 * four.bar_mm)) continue;
      if (differs(bars.front().size_mm.height, four.length_mm)) continue;
      const BarPair pair{four, name, bars, bars[2].position_mm};
      const auto apart = [&](const BarPair& one) { return cv::norm(one.five_mm - four.position_mm); };
      if (!best || apart(pair) < apart(*best)) best = pair;
    }
    if (best) pairs.push_back(*best);
  }
  return pairs;
}

std::vector<PlateRectangle> spots_of(const TargetPlate& plate) {
  std::vector<PlateRectangle> spots;
  for (const PlateRectangle& one : plate.rectangles) {
    if (!group_of_bar(one.name)) spots.push_back(one);
  }
  return spots;
}

std::vector<MrtdPresentation> mrtd_presentations(const MrtdOptions& options, double pixel_mm) {
  std::vector<std::size_t> levels(options.contrasts_k.size());
  std::iota(levels.begin(), levels.end(), 0);
  std::ranges::sort(levels, std::greater<>{}, [&](std::size_t level) { return options.contrasts_k[level]; });
  const auto mountings = static_cast<int>(options.mountings.size());
  std::vector<MrtdPresentation> all;
  for (int m = 0; m < std::min(mountings, options.set_ups); ++m) {
    const TargetState still{
        options.plate.name, options.mountings[static_cast<std::size_t>(m)], options.locating_k, {0, 0}};
    all.push_back({still, -1, 0});
    for (const double sign : {1.0, -1.0}) {
      for (const std::size_t level : levels) {
        for (int s = m; s < options.set_ups; s += mountings) {
          TargetState state = still;
          state.delta_t_k = sign * options.contrasts_k[level];
          state.shift_mm = set_up_shift_px(s, options.set_ups) * pixel_mm;
          all.push_back({state, s, level});
        }
      }
    }
  }
  return all;
}

Result<MrtdMeasure> measure_mrtd(FrameTaker& taker, const ShowState& show, const Registration& where,
                                 const MrtdOptions& options, std::stop_token stop) {
  cv::Point2d moved_px(0, 0);
  double noise_k = 0;
  // Making the templates takes seconds, and the observer takes longer for a frame than the camera: it judges the frames
  // of a presentation during the next one.
  std::optional<Result<BarsJudge>> judge;
  ShownBars bars;
  std::vector<cv::Mat1d> frames;
  const auto judge_frames = [&] {
    if (!judge) judge.emplace(BarsJudge::create(options, where));
    if (!*judge) return;
    for (const cv::Mat1d& kelvin : frames) (*judge)->add(kelvin, bars);
    frames.clear();
  };
  for (const MrtdPresentation& one : mrtd_presentations(options, 1 / where.scale_px_per_mm)) {
    const auto shown = show(one.state, judge_frames);
    if (judge && !*judge) return tl::unexpected(judge->error());
    if (!shown) return tl::unexpected(shown.error());
    if (one.set_up < 0) {
      TODBENCH_TRY(const AveragedPicture picture, taker.average(options.registration_frames, stop));
      TODBENCH_TRY(moved_px, located(picture.kelvin, mounted(options.plate, one.state.mounting), where));
      noise_k = noise_of_one_frame(picture);
      continue;
    }
    bars = {one.set_up,
            one.level,
            shown->state.delta_t_k,
            one.state.mounting,
            where.shifted(one.state.shift_mm).moved(moved_px),
            noise_k};
    for (int k = 0; k < options.frames; ++k) {
      TODBENCH_TRY(const Frame frame, taker.next(stop));
      TODBENCH_TRY(cv::Mat1d kelvin, to_kelvin(frame));
      frames.push_back(std::move(kelvin));
    }
  }
  judge_frames();
  if (!*judge) return tl::unexpected(judge->error());
  return (*judge)->result();
}

}  // namespace todbench
