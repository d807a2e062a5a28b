// SPDX-License-Identifier: GPL-3.0-or-later
// The recommended observer: normalised correlation with ideal shapes behind the viewing filter, search for the
// position, and internal noise proportional to the contrast.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "hvs/observer/observer.h"
#include "hvs/observer/template_bank.h"

namespace todbench {

/// Parameters of the template observer; the defaults are hvs-1. A parameter set has a versioned name and is never
/// changed afterwards. sigma and the internal noise of hvs-1 were tuned to a published microscan gain of 55 %
/// (EO-VISTA: Bijl, Hogervorst and Vos). hvs-1 is not a validated model of people.
struct TemplateObserverSpec {
  std::string name = "hvs-1";
  double blur_sigma_samples = 0.6;  ///< Gaussian of display and eye together, in displayed samples
  double internal_noise = 0.07;     ///< sd per displayed sample, relative to the contrast
  double sensor_noise_factor = 1;   ///< enlargement of the sensor's noise by the observer (1.75 in human-like-1)
  double search_range_samples = 1;  ///< each way, in x and y
  double search_step_samples = 0.125;
  double window_size_factor = 1.05;  ///< half window = ceil(factor * size + margin), in detector pitches
  double window_margin_pitch = 2;
  bool operator==(const TemplateObserverSpec&) const = default;
};

/// Error: `invalid_input` with the parameter that is out of its range.
[[nodiscard]] Result<void> validate(const TemplateObserverSpec& spec);

/// Computes the input of an observer's templates: the patch without its mean, in units of the contrast, with the
/// observer's own noise drawn from the trial's `noise`. `seen` and `room` have one value for each sample of the patch.
void seen_patch(const TemplateObserverSpec& spec, const Patch& patch, double contrast_k, const RandomStream& noise,
                std::span<float> seen, std::span<float> room);
/// Returns the alternative with the highest score; equal scores are decided by the trial's `noise`.
[[nodiscard]] int winning_alternative(const Choice& choice, const RandomStream& noise);

class TemplateObserver final : public Observer {
 public:
  /// Precondition: validate(spec) succeeds; 2..8 alternatives.
  TemplateObserver(TemplateObserverSpec spec, Alternatives alternatives);
  [[nodiscard]] const std::string& name() const override { return spec_.name; }
  [[nodiscard]] const TemplateObserverSpec& spec() const { return spec_; }
  [[nodiscard]] Result<std::shared_ptr<const PreparedObserver>> prepare(double size_samples,
                                                                        int samples_per_pitch) override;
  /// The bank used by prepare(), for estimates that work on the templates themselves.
  [[nodiscard]] Result<std::shared_ptr<const TemplateBank>> bank(double size_samples, int samples_per_pitch);

 private:
  TemplateObserverSpec spec_;
  Alternatives alternatives_;
  std::mutex mutex_;
  std::map<std::pair<double, int>, std::shared_ptr<const TemplateBank>> banks_;
  std::map<std::pair<double, int>, std::shared_ptr<const PreparedObserver>> prepared_;
};

}  // namespace todbench
