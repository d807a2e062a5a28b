// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/naked_eye/naked_eye_prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "bench/text/json_fields.h"
#include "hvs/observer/open_parameters.h"
#include "sim_devices/prediction/local_crossing.h"
#include "sim_devices/prediction/size_trial.h"

namespace todbench {
namespace {

constexpr double smallest_samples = 0.7, largest_samples = 60;
constexpr int draws_of_the_eye = 64;

/// Share of right answers of one observer over size, at steps of naked_eye_size_ratio, computed where it is asked.
class ShareOverSize {
 public:
  ShareOverSize(const NakedEyeTask& task, const TemplateObserverSpec& spec, double contrast, int pictures)
      : task_(task), contrast_(contrast), pictures_(pictures), observer_(spec, triangle_alternatives()) {}

  static double size_at(int step) { return std::pow(naked_eye_size_ratio, step); }

  Result<Proportion> at(int step) {
    if (const auto known = known_.find(step); known != known_.end()) return known->second;
    TODBENCH_TRY(const auto prepared, observer_.prepare(size_at(step), 1));
    const RandomStream numbers =
        RandomStream(task_.seed, "naked-eye.prediction").sub(static_cast<std::uint64_t>(step + 64));
    double sum = 0, squares = 0;
    for (int k = 0; k < pictures_; ++k) {
      const auto number = static_cast<std::uint64_t>(k);
      const NakedEyeTrial trial{
          .contrast = contrast_,
          .size_samples = size_at(step),
          .truth = all_apexes[static_cast<std::size_t>(k) % all_apexes.size()],
          .centroid = {numbers.uniform(2 * number) - 0.5, numbers.uniform(2 * number + 1) - 0.5},
          .number = (std::uint64_t{1} << 32U) + static_cast<std::uint64_t>(step + 64) * 4096 + number};
      const NakedEyePicture picture = naked_eye_picture(task_, trial, prepared->window_samples());
      const Patch patch{.kelvin = cv::Mat1d(picture.contrast), .phase = trial.centroid, .noise_k = picture.noise};
      const GradedChoice judged = prepared->judge(patch, contrast_, numbers.sub(number), draws_of_the_eye);
      const double right = judged.answers.probability[static_cast<std::size_t>(trial.truth)];
      sum += right;
      squares += right * right;
    }
    const double mean = sum / pictures_;
    const Proportion share{mean, std::max(squares / pictures_ - mean * mean, 0.0) / std::max(pictures_ - 1, 1)};
    return known_.emplace(step, share).first->second;
  }

 private:
  const NakedEyeTask& task_;
  double contrast_;
  int pictures_;
  TemplateObserver observer_;
  std::map<int, Proportion> known_;
};

/// The 75 % size of an observer; empty if there is none in the range of sizes.
struct FoundSize {
  double samples = 0, se_samples = 0;
  int step = 0;  ///< nearest
};

Result<std::optional<FoundSize>> threshold_of(ShareOverSize& shares, int start, const std::stop_token& stop) {
  const double ratio = std::log(naked_eye_size_ratio);
  const int first = static_cast<int>(std::ceil(std::log(smallest_samples) / ratio));
  const int last = static_cast<int>(std::log(largest_samples) / ratio);
  // The largest size below the threshold.
  int below = std::clamp(start, first, last);
  for (int direction = 0;;) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "interrupted");
    TODBENCH_TRY(const Proportion share, shares.at(below));
    const int wanted = share.mean < 0.75 ? 1 : -1;
    if (wanted < 0 && direction > 0) --below;
    if (wanted != direction && direction != 0) break;
    direction = wanted;
    below += wanted;
    if (below < first || below > last) return std::optional<FoundSize>();
  }
  std::vector<double> xs;
  std::vector<Proportion> ps;
  for (int step = below - 2; step <= below + 3; ++step) {
    TODBENCH_TRY(const Proportion share, shares.at(step));
    xs.push_back((step - below) * ratio);
    ps.push_back(share);
  }
  const auto found = local_crossing(xs, ps);
  if (!found) return std::optional<FoundSize>();
  const double samples = ShareOverSize::size_at(below) * std::exp(found->x);
  return std::optional(
      FoundSize{samples, samples * found->standard_error, static_cast<int>(std::lround(std::log(samples) / ratio))});
}

/// Threshold of an observer, and its proportions correct at the sizes around `middle` or, without it, the threshold.
struct ObserverOverSize {
  std::optional<FoundSize> threshold;
  std::vector<double> shares;  ///< naked_eye_sizes; empty without a middle
};
constexpr int steps_below_middle = 3;

Result<ObserverOverSize> over_size(const NakedEyeTask& task, const TemplateObserverSpec& spec, double contrast,
                                   int pictures, std::optional<int> middle, const std::stop_token& stop) {
  ShareOverSize shares(task, spec, contrast, pictures);
  ObserverOverSize out;
  TODBENCH_TRY(out.threshold, threshold_of(shares, middle.value_or(5), stop));
  if (!middle && out.threshold) middle = out.threshold->step;
  for (int k = 0; middle && k < naked_eye_sizes; ++k) {
    TODBENCH_TRY(const Proportion share, shares.at(*middle - steps_below_middle + k));
    out.shares.push_back(share.mean);
  }
  return out;
}

Result<NakedEyeContrast> predicted_contrast(const NakedEyeTask& task, const TemplateObserverSpec& spec, double contrast,
                                            int pictures, const std::stop_token& stop) {
  const double mrad = mrad_per_sample(*task.model.display);
  TODBENCH_TRY(const ObserverOverSize model, over_size(task, spec, contrast, pictures, {}, stop));
  if (!model.threshold) {
    return fail(ErrorCode::not_identifiable,
                fmt::format("at a contrast of {:g} the model has no threshold between {:g} and {:g} displayed samples: "
                            "choose another contrast, zoom or viewing distance",
                            contrast, smallest_samples, largest_samples));
  }
  const int middle = model.threshold->step;
  TODBENCH_TRY(const auto ends, at_open_ends(spec, [&](const TemplateObserverSpec& end) {
                 return over_size(task, end, contrast, pictures, middle, stop);
               }));
  const auto [best, worst] = ends.value_or(std::array{model, model});
  NakedEyeContrast out{.contrast = contrast,
                       .s75_mrad = mrad * model.threshold->samples,
                       .s75_se_mrad = mrad * model.threshold->se_samples,
                       .spread_low_mrad = {},
                       .spread_high_mrad = {},
                       .sizes = {}};
  if (best.threshold) out.spread_low_mrad = mrad * best.threshold->samples;
  if (worst.threshold) out.spread_high_mrad = mrad * worst.threshold->samples;
  for (std::size_t k = 0; k < model.shares.size(); ++k) {
    const double samples = ShareOverSize::size_at(middle - steps_below_middle + static_cast<int>(k));
    out.sizes.push_back({.size_samples = samples,
                         .size_mrad = mrad * samples,
                         .share = model.shares[k],
                         .share_low = worst.shares[k],
                         .share_high = best.shares[k]});
  }
  return out;
}

void share_fields(JsonFields& json, NakedEyeShare& share) {
  json.value("size_samples", share.size_samples);
  json.value("size_mrad", share.size_mrad);
  json.value("proportion_correct", share.share);
  json.value("proportion_correct_low", share.share_low);
  json.value("proportion_correct_high", share.share_high);
}

void contrast_fields(JsonFields& json, NakedEyeContrast& contrast) {
  json.value("contrast", contrast.contrast);
  json.value("s75_mrad", contrast.s75_mrad);
  json.value("s75_se_mrad", contrast.s75_se_mrad);
  json.value("s75_spread_low_mrad", contrast.spread_low_mrad);
  json.value("s75_spread_high_mrad", contrast.spread_high_mrad);
  json.value("sizes", contrast.sizes, share_fields);
}

}  // namespace

std::vector<std::vector<double>> NakedEyePrediction::sizes_samples() const {
  std::vector<std::vector<double>> out;
  for (const NakedEyeContrast& contrast : contrasts) {
    out.emplace_back();
    for (const NakedEyeShare& size : contrast.sizes) out.back().push_back(size.size_samples);
  }
  return out;
}

void prediction_fields(JsonFields& json, NakedEyePrediction& prediction) {
  json.value("arcmin_per_sample", prediction.arcmin_per_sample);
  json.value("adaptation_luminance_cd_m2", prediction.adaptation_luminance_cd_m2);
  json.value("contrasts", prediction.contrasts, contrast_fields);
}

Result<NakedEyePrediction> predict_naked_eye(const NakedEyeTask& task, int pictures, const std::stop_token& stop) {
  TODBENCH_TRY_VOID(validate(task));
  NakedEyePrediction out{.arcmin_per_sample = arcmin_per_sample(*task.model.display),
                         .adaptation_luminance_cd_m2 = adaptation_luminance_cd_m2(*task.model.display),
                         .contrasts = {}};
  const TemplateObserverSpec model = model_at_linear_display(task);
  for (const double contrast : task.contrasts) {
    TODBENCH_TRY(auto predicted, predicted_contrast(task, model, contrast, pictures, stop));
    out.contrasts.push_back(std::move(predicted));
  }
  return out;
}

}  // namespace todbench
