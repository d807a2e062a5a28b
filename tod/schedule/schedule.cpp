// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/schedule/schedule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include "tod/schedule/even_phases.h"

namespace todbench {
namespace {

/// Positive root of x^3 = x + 1: its powers are the pair of numbers that is hardest to approximate by fractions with
/// one denominator, which makes the sequence even at every length.
constexpr double plastic_number = 1.3247179572447460;

enum Dimension : std::size_t { plate_dimension, mounting_dimension, contrast_dimension, shift_dimension, dimensions };

/// The four loops of constant_stimuli(), the outermost first.
class Nesting {
 public:
  Nesting(const ConstantStimuliOptions& options, const RandomStream& stream)
      : options_(options), stream_(stream), contrasts_(options.delta_t_k) {
    std::ranges::stable_sort(contrasts_, [](double a, double b) { return std::abs(a) > std::abs(b); });
    std::ranges::stable_sort(
        order_, [&](std::size_t a, std::size_t b) { return options.change_cost_s[a] > options.change_cost_s[b]; });
  }

  std::vector<TargetState> run() {
    descend(0);
    return std::move(states_);
  }

 private:
  [[nodiscard]] std::size_t length(std::size_t dimension) const {
    switch (dimension) {
      case plate_dimension:
        return options_.plates.size();
      case mounting_dimension:
        return options_.mountings.size();
      case contrast_dimension:
        return contrasts_.size();
      default:
        return static_cast<std::size_t>(std::max(0, options_.phases));
    }
  }

  /// Whether a loop is outside that of the shifts.
  [[nodiscard]] bool outside(Dimension dimension) const {
    return std::ranges::find(order_, dimension) < std::ranges::find(order_, shift_dimension);
  }

  /// The triangles that share shifts with those of plate `index_`: of every plate if that loop is inside.
  [[nodiscard]] std::vector<PhasedTriangle> triangles_together() const {
    std::vector<PhasedTriangle> all;
    for (std::size_t p = 0; p < options_.plates.size(); ++p) {
      if (outside(plate_dimension) && p != index_[plate_dimension]) continue;
      const auto drawing = std::ranges::find(options_.drawings, options_.plates[p], &TargetPlate::name);
      if (drawing == options_.drawings.end() || !(options_.pixel_mm > 0)) continue;
      for (std::size_t m = 0; m < options_.mountings.size(); ++m) {
        if (!options_.shows(p, m)) continue;
        const auto more =
            phased_triangles(*drawing, options_.mountings[m], pixel_of(options_), outside(mounting_dimension) ? m : 0);
        all.insert(all.end(), more.begin(), more.end());
      }
    }
    return all;
  }

  [[nodiscard]] static EvenPhases different_phases(std::size_t groups, int count) {
    const std::vector<cv::Point2d> all = plastic_points(static_cast<int>(groups) * count);
    EvenPhases out;
    for (std::size_t first = 0; first < all.size(); first += static_cast<std::size_t>(count)) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
      out.shifts.emplace_back(begin, begin + count);
    }
    return out;
  }

  /// The shifts of this turn of the outer loops. Mountings have one random start in common, so that their phases
  /// interleave; plates and contrasts have their own. Loops inside the shift share shifts, because a new one would cost
  /// more there than their own change.
  [[nodiscard]] std::vector<cv::Point2d> shifts() {
    const std::size_t plate = outside(plate_dimension) ? index_[plate_dimension] : 0;
    const std::size_t group = outside(mounting_dimension) ? index_[mounting_dimension] : 0;
    const std::size_t contrast = outside(contrast_dimension) ? index_[contrast_dimension] : 0;
    auto [phases, is_new] = phases_.try_emplace(plate);
    if (is_new) {
      const std::size_t groups = outside(mounting_dimension) ? options_.mountings.size() : 1;
      phases->second = options_.spread_evenly ? even_phases(triangles_together(), groups, options_.phases)
                                              : different_phases(groups, options_.phases);
    }
    const RandomStream start = stream_.sub(plate * contrasts_.size() + contrast);
    std::vector<cv::Point2d> out;
    for (const cv::Point2d& shift : phases->second.shifts[group]) {
      const cv::Point2d p = shift + cv::Point2d(start.uniform(0), start.uniform(1));
      out.push_back(shift_of(p, options_));
    }
    return out;
  }

  void descend(std::size_t depth) {
    if (depth == dimensions) {
      if (options_.shows(index_[plate_dimension], index_[mounting_dimension])) states_.push_back(state_);
      return;
    }
    const std::size_t dimension = order_[depth];
    std::vector<cv::Point2d> shifts_mm;
    if (dimension == shift_dimension && length(dimension) > 0) shifts_mm = shifts();
    for (std::size_t i = 0; i < length(dimension); ++i) {
      index_[dimension] = i;
      switch (dimension) {
        case plate_dimension:
          state_.plate = options_.plates[i];
          break;
        case mounting_dimension:
          state_.mounting = options_.mountings[i];
          break;
        case contrast_dimension:
          state_.delta_t_k = contrasts_[i];
          break;
        default:
          state_.shift_mm = shifts_mm[i];
          break;
      }
      descend(depth + 1);
    }
  }

  const ConstantStimuliOptions& options_;
  const RandomStream& stream_;
  std::vector<double> contrasts_;
  std::array<std::size_t, dimensions> order_{plate_dimension, mounting_dimension, contrast_dimension, shift_dimension};
  std::array<std::size_t, dimensions> index_{};
  std::map<std::size_t, EvenPhases> phases_;  ///< by plate
  TargetState state_;
  std::vector<TargetState> states_;
};

}  // namespace

void TrialSchedule::observe(std::span<const Trial> /*trials*/) {}
void TrialSchedule::observe_contrasts(const std::map<double, ContrastError>& /*errors*/) {}

cv::Size2d pixel_of(const ConstantStimuliOptions& options) {
  return {options.pixel_mm, options.pixel_mm * options.pixel_aspect};
}

cv::Point2d shift_of(cv::Point2d phase_px, const ConstantStimuliOptions& options) {
  const cv::Size2d pixel_mm = pixel_of(options);
  return {pixel_mm.width * (phase_px.x - std::floor(phase_px.x)),
          pixel_mm.height * (phase_px.y - std::floor(phase_px.y))};
}

std::vector<cv::Point2d> plastic_points(int count) {
  const double step_x = 1 / plastic_number;
  const double step_y = 1 / (plastic_number * plastic_number);
  std::vector<cv::Point2d> points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(i * step_x - std::floor(i * step_x), i * step_y - std::floor(i * step_y));
  return points;
}

std::vector<cv::Point2d> spread_phases(int count, const RandomStream& stream) {
  const double step_x = 1 / plastic_number;
  const double step_y = 1 / (plastic_number * plastic_number);
  const double start_x = stream.uniform(0);
  const double start_y = stream.uniform(1);
  std::vector<cv::Point2d> phases;
  for (int i = 0; i < count; ++i) {
    const double x = start_x + i * step_x;
    const double y = start_y + i * step_y;
    phases.emplace_back(x - std::floor(x), y - std::floor(y));
  }
  return phases;
}

std::vector<TargetState> constant_stimuli(const ConstantStimuliOptions& options, const RandomStream& stream) {
  return Nesting(options, stream).run();
}

std::optional<TargetState> ListedSchedule::next() {
  if (position_ >= states_.size()) return std::nullopt;
  return states_[position_++];
}

}  // namespace todbench
