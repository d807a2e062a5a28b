// SPDX-License-Identifier: GPL-3.0-or-later
// The template observer. It correlates a patch with ideal shapes after the viewing filter, at every search position.
// The observer hvs-1 has a blur, and internal noise proportional to the contrast. The observer hvs-2 has a display and
// an eye.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "hvs/eye/contrast_sensitivity.h"
#include "hvs/eye/viewed_display.h"
#include "hvs/observer/observer.h"
#include "hvs/observer/template_bank.h"

namespace todbench {

/// Parameters of the template observer; the defaults are those of hvs-1. A parameter set has a versioned name and is
/// never changed. In hvs-1, blur and internal noise were fitted to a published microscan gain of 55 % (EO-VISTA: Bijl,
/// Hogervorst and Vos). hvs-1 is not a validated model of people.
struct TemplateObserverSpec {
  std::string name = "hvs-1";
  double blur_sigma_samples = 0.6;  ///< Gaussian blur of display and eye together, in displayed samples
  double internal_noise = 0.07;     ///< sd per displayed sample, relative to the contrast
  double sensor_noise_factor = 1;   ///< factor by which the observer enlarges the sensor's noise (1.75 in human-like-1)
  double search_range_samples = 1;  ///< largest shift in each direction along x and y
  double search_step_samples = 0.125;
  double window_size_factor = 1.05;  ///< half window = ceil(factor * size + margin), in detector pitches
  double window_margin_pitch = 2;
  /// Eye of the observer (hvs-2). It replaces blur_sigma_samples and internal_noise; set internal_noise to 0. An eye
  /// requires a display.
  std::optional<EyeParameters> eye{};
  /// Margin of the half window in arcmin; only with an eye. The larger of the two margins is used.
  double window_margin_arcmin = 0;
  std::optional<ViewedDisplay> display{};  ///< display of the plan; only with an eye
  /// Ratio of height to width of a displayed sample, equal to that of a pixel of the camera. A length in samples is in
  /// units of the width. Search range and step are in units of the sample along each axis. Not part of a parameter set.
  /// An eye requires 1.
  double sample_aspect = 1;
  bool operator==(const TemplateObserverSpec&) const = default;
};

/// Checks the parameters. Error: `invalid_input`, with the name of the parameter that is out of range.
[[nodiscard]] Result<void> validate(const TemplateObserverSpec& spec);

/// Computes the picture that is correlated with the templates: the patch minus its background, in units of the
/// contrast, plus the internal noise per sample, drawn from the trial's `noise`. The background is the mean of the
/// patch or, with an eye, the mean of its outermost samples (without_background()). `seen`: output, `room`: scratch
/// memory; one value per sample.
void seen_patch(const TemplateObserverSpec& spec, const Patch& patch, double contrast_k, const RandomStream& noise,
                std::span<float> seen, std::span<float> room);
/// Returns the alternative with the highest score; between equal scores, the trial's `noise` decides.
[[nodiscard]] int winning_alternative(const Choice& choice, const RandomStream& noise);

/// Observer that correlates a patch with ideal shapes at every search position.
class TemplateObserver final : public Observer {
 public:
  /// Precondition: validate(spec) succeeds; 2..8 alternatives.
  TemplateObserver(TemplateObserverSpec spec, Alternatives alternatives);
  [[nodiscard]] const std::string& name() const override { return spec_.name; }
  [[nodiscard]] const TemplateObserverSpec& spec() const { return spec_; }
  [[nodiscard]] Result<std::shared_ptr<const PreparedObserver>> prepare(double size_samples,
                                                                        int samples_per_pitch) override;
  /// Returns the bank used by prepare(), for estimators that use the templates directly. Errors as prepare().
  [[nodiscard]] Result<std::shared_ptr<const TemplateBank>> bank(double size_samples, int samples_per_pitch);

 private:
  TemplateObserverSpec spec_;
  Alternatives alternatives_;
  std::mutex mutex_;
  std::map<std::pair<double, int>, std::shared_ptr<const TemplateBank>> banks_;
  std::map<std::pair<double, int>, std::shared_ptr<const PreparedObserver>> prepared_;
};

}  // namespace todbench
