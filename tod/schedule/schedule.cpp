#include "tod/schedule/schedule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace todbench {
namespace {

/// Positive root of x^3 = x + 1: its powers are the pair of numbers that is hardest to approximate by fractions with
/// one denominator, hence the evenness of the sequence at every length.
constexpr double plastic_number = 1.3247179572447460;

enum Dimension : std::size_t { plate_dimension, mounting_dimension, contrast_dimension, shift_dimension, dimensions };

/// The four loops of constant_stimuli, the outermost first.
class Nesting {
 public:
  Nesting(const ConstantStimuliOptions& options, const RandomStream& stream)
      : options_(options), stream_(stream), contrasts_(options.delta_t_k) {
    std::ranges::stable_sort(contrasts_, [](double a, double b) { return std::abs(a) > std::abs(b); });
    std::ranges::stable_sort(
        order_, [&](std::size_t a, std::size_t b) { return options.change_cost_s[a] > options.change_cost_s[b]; });
  }

  std::vector<TargetState> run() {
    descend(0, 0);
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

  /// `outer` numbers the combination of the loops outside this one. Each gets shifts of its own, so that set-ups and
  /// contrasts do not share phases; loops inside the shift share them, because there a new shift would cost more than
  /// what they change.
  void descend(std::size_t depth, std::uint64_t outer) {
    if (depth == dimensions) {
      states_.push_back(state_);
      return;
    }
    const std::size_t dimension = order_[depth];
    const std::size_t count = length(dimension);
    std::vector<cv::Point2d> phases;
    if (dimension == shift_dimension) phases = spread_phases(options_.phases, stream_.sub(outer));
    for (std::size_t i = 0; i < count; ++i) {
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
          state_.shift_mm = options_.pixel_mm * phases[i];
          break;
      }
      descend(depth + 1, outer * count + i);
    }
  }

  const ConstantStimuliOptions& options_;
  const RandomStream& stream_;
  std::vector<double> contrasts_;
  std::array<std::size_t, dimensions> order_{plate_dimension, mounting_dimension, contrast_dimension, shift_dimension};
  TargetState state_;
  std::vector<TargetState> states_;
};

}  // namespace

void TrialSchedule::observe(std::span<const Trial> /*trials*/) {}

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
