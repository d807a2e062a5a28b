// SPDX-License-Identifier: GPL-3.0-or-later
// 75 % size for an observer that knows the position of the target: analytic, without noise draws. This estimate is used
// to bracket sizes and to plan effects. Reported numbers come from the searching observer.
#pragma once

#include <map>
#include <memory>
#include <opencv2/core/types.hpp>

#include "acquisition/base/result.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/size_trial.h"

namespace todbench {

/// S75, the size with 75 % correct answers, as a function of the noise-to-contrast ratio q of one sensor and observer.
/// Uses the sizes and the template banks of direct_estimate(). One thread at a time.
///
/// Validity (section "Two tiers" of docs/method/effect-planning.md): within 4 % of the searching observer for q up to
/// 0.1, within 8 % up to 0.35.
class CuedEstimate {
 public:
  /// `observer` must outlive this object.
  CuedEstimate(const SensorSpec& sensor, const SensorPlan& plan, TemplateObserver& observer, SceneMotion motion = {});

  /// Sets the contrast at which an observer with an eye sees the target. All later results add the noise of the eye,
  /// which depends on the target size, to `q`. Has no effect for observers without an eye.
  void show(double contrast_k) { contrast_k_ = contrast_k; }
  /// Returns the 75 % size in pitches. `q` is the noise per sample over the contrast, internal noise included. Errors:
  /// `invalid_input` if no size from 0.2 to 40 pitches reaches 75 % correct, or if even the smallest size exceeds 75 %.
  [[nodiscard]] Result<double> s75_pitch(double q);
  /// Returns d ln S75 / d ln q at `q`. For an observer with an eye, the noise of the eye is scaled with q.
  [[nodiscard]] Result<double> sensitivity(double q);
  /// Returns the slope b of the Weibull function with the same slope as the proportion correct at the 75 % size:
  /// dP/dlnS = (b/4) ln 3.
  [[nodiscard]] Result<double> weibull_slope(double q);
  /// Returns the size trial nearest to `size_pitch`.
  [[nodiscard]] Result<const SizeTrial*> trial(double size_pitch);

 private:
  [[nodiscard]] Result<const SizeTrial*> trial_at(int index);
  [[nodiscard]] double proportion(const SizeTrial& trial, double q) const;
  /// Returns whether no size of the size ladder can reach 75 % correct at `q`, judged by the sizes number `index` and
  /// `index` - 4 of the ladder.
  [[nodiscard]] bool hopeless(double q, int index);

  TemplateObserver& observer_;
  ImageChain chain_;
  TrialConditions conditions_;
  double contrast_k_ = 0, eye_scale_ = 1;
  std::map<int, std::unique_ptr<SizeTrial>> trials_;
};

/// Returns the discriminability D of orientations in the noise-free picture of a sensor: D^2 = integral over frequency
/// of (|F_up - F_down|^2 + |F_up - F_right|^2) |H|^2. F: spectrum of a triangle of `size_pitch`, H: sensor_transfer().
[[nodiscard]] double discriminability(const SensorSpec& sensor, const SensorPlan& plan, double size_pitch,
                                      int wavelengths, SceneMotion motion = {});

}  // namespace todbench
