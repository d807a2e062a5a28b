// SPDX-License-Identifier: GPL-3.0-or-later
// Selection of the next presentation.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/target.h"
#include "tod/presentation/trial.h"
#include "tod/psychometric/contrast_slope.h"

namespace todbench {

/// Chooses presentations. One thread at a time.
class TrialSchedule {
 public:
  virtual ~TrialSchedule() = default;
  /// Returns the next state; empty when enough has been shown.
  [[nodiscard]] virtual std::optional<TargetState> next() = 0;
  /// Returns the total number of presentations, for progress and remaining time. If this number depends on the answers,
  /// it returns the largest possible number.
  [[nodiscard]] virtual std::size_t planned() const = 0;
  /// Receives the answers to the last state of next(). Schedules that are not adaptive ignore the answers.
  virtual void observe(std::span<const Trial> trials);
  /// Receives the standard errors of the contrasts that have been measured, by set contrast. Called before the answers
  /// that follow. Errors that cannot be estimated are missing. Schedules that are not adaptive ignore the errors.
  virtual void observe_contrasts(const std::map<double, ContrastError>& errors);
};

/// The method of constant stimuli on plates: every plate in its mountings at every contrast in every phase.
struct ConstantStimuliOptions {
  std::vector<std::string> plates;
  /// Drawings of the plates, by name. The drawings are used to optimise the phases of all triangles together. A plate
  /// without a drawing is treated as one triangle in its middle.
  std::vector<TargetPlate> drawings{};
  std::vector<Mounting> mountings;
  /// For each of `plates`, the number of `mountings` in which the plate is shown, from the first mounting; empty: all.
  std::vector<std::size_t> mountings_per_plate{};
  std::vector<double> delta_t_k;
  int phases = 16;            ///< sub-pixel shifts per plate, mounting and contrast
  double pixel_mm = 1;        ///< size of a pixel on the plate; shifts are spread over one pixel in x and y
  double pixel_aspect = 1;    ///< ratio of height to width of a pixel; the width is pixel_mm
  bool spread_evenly = true;  ///< false: shifts only differ, so that presentations can be counted without even_phases()
  /// Time in s for a change of plate, mounting, contrast and shift.
  double change_cost_s[4] = {60, 30, 20, 0.1};
  /// Returns whether the plate is shown in the mounting, by their indices.
  [[nodiscard]] bool shows(std::size_t plate, std::size_t mounting) const {
    return mountings_per_plate.empty() || mounting < mountings_per_plate[plate];
  }
};

/// Returns width and height of a pixel on the plate.
[[nodiscard]] cv::Size2d pixel_of(const ConstantStimuliOptions& options);
/// Converts a phase in pixels to a shift in mm. Integer pixels are removed first.
[[nodiscard]] cv::Point2d shift_of(cv::Point2d phase_px, const ConstantStimuliOptions& options);

/// Returns the first `count` points of the additive recurrence with the plastic number (Roberts 2018) in [0, 1)^2, from
/// the origin.
[[nodiscard]] std::vector<cv::Point2d> plastic_points(int count);

/// Returns `count` sub-pixel shifts in [0, 1)^2 from a random start drawn from `stream`. The shifts are spread evenly
/// for every count (additive recurrence with the plastic number, Roberts 2018).
[[nodiscard]] std::vector<cv::Point2d> spread_phases(int count, const RandomStream& stream);

/// Returns presentations, nested so that the most expensive change occurs least often. Changes with equal costs have
/// the order plate, mounting, contrast, shift. Within a group of contrasts the highest contrast is first, because the
/// plate is registered at this contrast. The shifts are those of even_phases(). If a shift costs less than a mounting,
/// shifts are spread evenly over all mountings together. Each plate and contrast has a random start within the pixel.
[[nodiscard]] std::vector<TargetState> constant_stimuli(const ConstantStimuliOptions& options,
                                                        const RandomStream& stream);

/// A schedule that shows a list once.
class ListedSchedule final : public TrialSchedule {
 public:
  explicit ListedSchedule(std::vector<TargetState> states) : states_(std::move(states)) {}
  [[nodiscard]] std::optional<TargetState> next() override;
  [[nodiscard]] std::size_t planned() const override { return states_.size(); }

 private:
  std::vector<TargetState> states_;
  std::size_t position_ = 0;
};

}  // namespace todbench
