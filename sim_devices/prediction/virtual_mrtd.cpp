// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/virtual_mrtd.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "hvs/observer/identification_bank.h"
#include "hvs/observer/open_parameters.h"
#include "hvs/observer/seen_picture.h"
#include "sim_devices/prediction/bar_pattern.h"
#include "sim_devices/prediction/bar_profile.h"
#include "sim_devices/prediction/seen_window.h"
#include "sim_devices/prediction/window_noise.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/measures/two_intervals.h"
#include "tod/range/bars_sampled.h"

namespace todbench {
namespace {

constexpr std::size_t phases_across = 8, phases_along = 2, bar_phases = phases_across * phases_along;
constexpr double false_alarms = 0.05;
constexpr double contrast_step = 1.25;
constexpr int most_steps = 36;  ///< highest contrast: 1.25^36 = 3081 times ideal_k
constexpr double known_band_per_pitch = 3;

using Responses = IntervalScores;
using Share = ShareOfPairs;

/// Share of yes answers to the pattern, at the limit that gives 5 % yes answers without one.
Share share_of_yes(const Responses& pattern, const Responses& nothing) {
  std::vector<float> sorted;
  for (const auto& row : nothing) sorted.insert(sorted.end(), row.begin(), row.end());
  const auto at = static_cast<std::size_t>((1 - false_alarms) * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(at), sorted.end());
  const float limit = sorted[at];
  const std::size_t draws = pattern.front().size();
  double sum = 0, squares = 0;
  for (std::size_t d = 0; d < draws; ++d) {
    double yes = 0;
    for (const auto& row : pattern) yes += row[d] > limit ? 1 : 0;
    yes /= static_cast<double>(pattern.size());
    sum += yes;
    squares += yes * yes;
  }
  const auto n = static_cast<double>(draws);
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

/// Offset of the pattern's middle from that of the window across the bars, in samples.
double offset_across(std::size_t phase) {
  return (static_cast<double>(phase % phases_across) + 0.5) / phases_across - 0.5;
}

/// The same offset in the picture.
cv::Point2d bar_offset(std::size_t phase, BarAxis axis) {
  const std::size_t row = phase / phases_across;
  const double along = (static_cast<double>(row) + 0.5) / phases_along - 0.5;
  return axis == BarAxis::vertical ? cv::Point2d(along, offset_across(phase))
                                   : cv::Point2d(offset_across(phase), along);
}

std::vector<StepEdge> bar_edges_in_samples(const SensorSpec& spec, BarPattern pattern, double frequency_per_pitch,
                                           BarAxis axis) {
  return placed(bar_edges(pattern, frequency_per_pitch, axis), spec.samples_per_pitch(), 0, {0, 0});
}

/// The observer at one frequency.
class BarTrial {
 public:
  static Result<BarTrial> create(const VirtualMrtdTask& task, const SensorSpec& spec, const SceneImager& imager,
                                 double frequency_per_mrad) {
    BarTrial trial(task, spec, frequency_per_mrad * spec.ifov_mrad());
    std::vector<AlternativeAspects> alternatives;
    for (const BarPattern pattern : {BarPattern::four_bars, BarPattern::five_bars})
      alternatives.push_back({trial.edges(pattern)});
    TODBENCH_TRY(auto bank, IdentificationBank::build(task.observer, alternatives, spec.samples_per_pitch()));
    trial.bank_.emplace(std::move(bank));
    if (task.observer.eye && task.criterion == BarCriterion::bars_resolved)
      trial.picture_.emplace(task.observer, trial.bank_->window_samples());
    for (std::size_t phase = 0; phase < bar_phases; ++phase) {
      trial.four_.push_back(trial.seen(imager, BarPattern::four_bars, phase));
      if (task.criterion == BarCriterion::four_or_five)
        trial.other_.push_back(trial.seen(imager, BarPattern::five_bars, phase));
    }
    TODBENCH_TRY_VOID(trial.draw_noise());
    return trial;
  }

  Result<void> measure(VirtualMrtdPoint& point) {
    if (!(noise_k_ > 0) && !(task_.observer.eye && task_.observer.display->span_k > 0)) {
      return fail(ErrorCode::invalid_input,
                  "a camera without noise has no MRTD, because the noise of the observer grows with the contrast");
    }
    find_thresholds(point);
    if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    if (!point.threshold_k) return {};
    const auto ends =
        at_open_ends(task_.observer, [&](const TemplateObserverSpec& end) -> Result<std::optional<double>> {
          seeing_ = end;
          VirtualMrtdPoint found = point;
          find_thresholds(found);
          if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
          return found.threshold_k;
        });
    if (!ends) return tl::unexpected(ends.error());
    if (*ends) point.spread_k = spread_of({(**ends)[0], (**ends)[1]});
    return {};
  }

 private:
  /// Raises the contrast until every phase is above the criterion.
  void find_thresholds(VirtualMrtdPoint& point) {
    std::vector<double> contrasts_k;
    std::vector<Share> all;
    std::array<std::vector<Share>, phases_across> by_phase;
    const auto passed = [](const std::vector<Share>& shares) {
      return !shares.empty() && shares.back().mean >= threshold_share;
    };
    for (int step = -2; step <= most_steps; ++step) {
      if (task_.stop.stop_requested()) return;
      contrasts_k.push_back(point.ideal_k * std::pow(contrast_step, step));
      answer(contrasts_k.back(), all, by_phase);
      if (passed(all) && std::all_of(by_phase.begin(), by_phase.end(), passed)) break;
    }
    const PassedContrast found = passed_contrast(contrasts_k, all);
    point.threshold_k = found.contrast_k;
    point.relative_error = found.relative_error;
    point.highest_k = contrasts_k.back();
    point.proportion_at_most = all.back().mean;
    bool every_phase = true;
    for (const auto& shares : by_phase) {
      const auto own = passed_contrast(contrasts_k, shares).contrast_k;
      every_phase = every_phase && own.has_value();
      if (!own) continue;
      point.best_phase_k = std::min(point.best_phase_k.value_or(*own), *own);
      point.worst_phase_k = std::max(point.worst_phase_k.value_or(*own), *own);
    }
    if (!every_phase) point.worst_phase_k.reset();
  }

  /// A picture in every form that the criteria use.
  struct Seen {
    std::vector<float> scores, profile;
  };

  BarTrial(const VirtualMrtdTask& task, const SensorSpec& spec, double frequency_per_pitch)
      : task_(task), seeing_(task.observer), spec_(spec), frequency_per_pitch_(frequency_per_pitch) {}

  [[nodiscard]] std::vector<StepEdge> edges(BarPattern pattern) const {
    return bar_edges_in_samples(spec_, pattern, frequency_per_pitch_, task_.axis);
  }
  [[nodiscard]] double frequency_per_sample() const { return frequency_per_pitch_ / spec_.samples_per_pitch(); }

  [[nodiscard]] Seen of(const cv::Mat1f& window) const {
    Seen out;
    if (task_.criterion == BarCriterion::bars_resolved) {
      out.profile = bar_profile(picture_ ? picture_->of(window) : window, frequency_per_sample(), task_.axis);
      return out;
    }
    out.scores = bank_->project(without_background(task_.observer, window));
    return out;
  }

  [[nodiscard]] Seen seen(const SceneImager& imager, BarPattern pattern, std::size_t phase) const {
    const SeenWindow window(spec_, imager);
    return of(window.picture(edges(pattern), bank_->window_samples(), bar_offset(phase, task_.axis), 1, phase));
  }

  Result<void> draw_noise() {
    const int window = bank_->window_samples();
    const WindowNoise noise(spec_, task_.plan, task_.accuracy, window, task_.seed);
    double squares = 0;
    for (int d = 0; d < task_.draws; ++d) {
      if (d % 64 == 0 && task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      const cv::Mat1f sensor = noise.sensor_k(static_cast<std::uint64_t>(d));
      squares += cv::norm(sensor, cv::NORM_L2SQR) / static_cast<double>(sensor.total());
      sensor_.push_back(of(sensor));
      const cv::Mat1f white = noise.white(static_cast<std::uint64_t>(d));
      if (!task_.observer.eye || picture_) {
        white_.push_back(of(white));
      } else {
        white_.push_back({.scores = bank_->project(white), .profile = {}});
      }
      if (task_.observer.eye) eye_.push_back(eye_noise(static_cast<std::uint64_t>(d)));
    }
    noise_k_ = std::sqrt(squares / task_.draws);
    return {};
  }

  /// Noise of the eye of standard deviation 1: in a score, or in a displayed sample of the seen picture.
  [[nodiscard]] Seen eye_noise(std::uint64_t draw) const {
    const int points = picture_ ? bank_->window_samples() : bank_->eye_points();
    cv::Mat1f eye(points, points);
    RandomStream(task_.seed, "mrtd.eye").sub(draw).fill_normal({eye.ptr<float>(), eye.total()});
    if (picture_) return {.scores = {}, .profile = bar_profile(eye, frequency_per_sample(), task_.axis)};
    return {.scores = std::move(bank_->project_eye({&eye, 1}).front()), .profile = {}};
  }

  /// Noise of the observer per sample, relative to the contrast.
  [[nodiscard]] float own_noise(double contrast_k) const {
    const double enlarged = seeing_.sensor_noise_factor * seeing_.sensor_noise_factor - 1;
    return static_cast<float>(
        std::hypot(seeing_.internal_noise, std::sqrt(enlarged * white_variance_k2(spec_, task_.plan, 1)) / contrast_k));
  }

  /// Score of the criterion for a pattern (null: no pattern) with one draw.
  [[nodiscard]] float response(const Seen* pattern, std::size_t phase, std::size_t draw, float noise_scale,
                               float own) const {
    const Seen& sensor = sensor_[draw];
    const Seen& white = own_.empty() ? white_[draw] : own_[draw];
    if (task_.criterion == BarCriterion::bars_resolved) {
      std::vector<double> profile(sensor.profile.size());
      for (std::size_t i = 0; i < profile.size(); ++i) {
        profile[i] = static_cast<double>((pattern != nullptr ? pattern->profile[i] : 0.0F) +
                                         noise_scale * sensor.profile[i] + own * white.profile[i]);
      }
      return static_cast<float>(shallowest_gap(profile, frequency_per_sample(), offset_across(phase)));
    }
    const std::vector<float>& signal = pattern != nullptr ? pattern->scores : nothing_;
    std::array<float, 2> largest{};
    bank_->largest_of_each(signal, sensor.scores, noise_scale, white.scores, own, largest);
    return task_.criterion == BarCriterion::detection ? largest[0] : largest[0] - largest[1];
  }

  /// Both noises of an observer with an eye, relative to the contrast. The intervals of a pair have the noise of the
  /// four bars, whose energy differs from that of five by a few percent.
  void mix_own_noise(double contrast_k, float white) {
    const auto eye = static_cast<float>(bank_->eye_noise_k(seeing_, 0, 0, contrast_k, 1) / contrast_k);
    own_ = white_;
    for (std::size_t d = 0; d < own_.size(); ++d) {
      for (std::size_t i = 0; i < own_[d].scores.size(); ++i)
        own_[d].scores[i] = white * white_[d].scores[i] + eye * eye_[d].scores[i];
      for (std::size_t i = 0; i < own_[d].profile.size(); ++i)
        own_[d].profile[i] = white * white_[d].profile[i] + eye * eye_[d].profile[i];
    }
  }

  void answer(double contrast_k, std::vector<Share>& all, std::array<std::vector<Share>, phases_across>& by_phase) {
    const auto scale = static_cast<float>(1 / contrast_k);
    float own = own_noise(contrast_k);
    if (task_.observer.eye) {
      mix_own_noise(contrast_k, own);
      own = 1;
    }
    if (nothing_.empty()) nothing_.assign(bank_->scores(), 0.0F);
    const auto draws = static_cast<std::size_t>(task_.draws);
    Responses pattern(bar_phases, std::vector<float>(draws)), other = pattern;
    for (std::size_t phase = 0; phase < bar_phases; ++phase) {
      for (std::size_t d = 0; d < draws; ++d) {
        pattern[phase][d] = response(&four_[phase], phase, d, scale, own);
        other[phase][d] = response(other_.empty() ? nullptr : &other_[phase], phase, d, scale, own);
      }
    }
    const auto share = task_.criterion == BarCriterion::bars_resolved ? share_of_yes : share_of_pairs;
    all.push_back(share(pattern, other));
    for (std::size_t a = 0; a < phases_across; ++a) {
      Responses some, others;
      for (std::size_t phase = a; phase < bar_phases; phase += phases_across) {
        some.push_back(pattern[phase]);
        others.push_back(other[phase]);
      }
      by_phase[a].push_back(share(some, others));
    }
  }

  const VirtualMrtdTask& task_;
  TemplateObserverSpec seeing_;  ///< the observer of the task, or one that differs in its own noise only
  SensorSpec spec_;
  double frequency_per_pitch_;
  std::optional<IdentificationBank> bank_;
  std::optional<SeenPicture> picture_;  ///< only if an eye reads the gaps of the picture
  std::vector<Seen> four_, other_;      ///< by phase
  std::vector<Seen> sensor_, white_;    ///< by draw
  std::vector<Seen> eye_;               ///< by draw; only with an eye
  std::vector<Seen> own_;               ///< by draw, at the present contrast; only with an eye
  std::vector<float> nothing_;
  double noise_k_ = 0;
};

Result<void> check_bars(const VirtualMrtdTask& task, const SensorSpec& spec) {
  TODBENCH_TRY_VOID(require_square_pixels(spec, "the virtual MRTD"));
  if (task.frequencies_per_mrad.empty()) return fail(ErrorCode::invalid_input, "at least one frequency is needed");
  if (task.draws < 64) return fail(ErrorCode::invalid_input, "at least 64 draws are needed");
  for (const double f : task.frequencies_per_mrad) {
    const double side = 3.5 / (f * spec.ifov_mrad()) * spec.samples_per_pitch();
    if (!(f > 0) || !(side >= 4 && side <= 400)) {
      return fail(ErrorCode::invalid_input, fmt::format("bars of {:g} cycles/mrad: their square must have 4 to 400 "
                                                        "samples per side, which is {:.4g} to {:.4g} cycles/mrad",
                                                        f, 3.5 * spec.samples_per_pitch() / 400 / spec.ifov_mrad(),
                                                        3.5 * spec.samples_per_pitch() / 4 / spec.ifov_mrad()));
    }
  }
  if (task.plan.simulates(Effect::quantisation) && rounds_coarsely(spec)) {
    return fail(ErrorCode::invalid_input,
                "a count of the camera is larger than its noise: the rounding of small contrasts is not simulated");
  }
  return {};
}

/// Quantities of a frequency that need no trials.
VirtualMrtdPoint point_before_trials(const VirtualMrtdTask& task, const SensorSpec& spec, double frequency_per_mrad) {
  VirtualMrtdPoint point;
  point.frequency_per_mrad = frequency_per_mrad;
  const int n = spec.samples_per_pitch();
  const double per_sample = frequency_per_mrad * spec.ifov_mrad() / n;
  point.frequency_over_nyquist = 2 * per_sample;
  const TransferFunction camera = sensor_transfer(spec, task.plan, task.accuracy.wavelengths);
  const auto in_samples = [&](double u, double w) { return camera(u * n, w * n); };
  const BarPattern other = task.criterion == BarCriterion::four_or_five ? BarPattern::five_bars : BarPattern::uniform;
  const auto energies = bar_energies(per_sample, other, in_samples, known_band_per_pitch / n, 4);
  const double noise_k = std::sqrt(std::max(white_variance_k2(spec, task.plan, 1), 1e-12));
  point.ideal_k = noise_k * ideal_two_interval_contrast(energies, threshold_share);
  const BlurredBars bars(
      per_sample, [&](double u) { return camera(u * n, 0).real(); }, 4.0 / n);
  const BarModulation left = bar_modulation(bars);
  point.share_of_four = left.share_of_four;
  point.modulation_best = left.best;
  point.modulation_worst = left.worst;
  return point;
}

}  // namespace

std::string_view to_string(BarCriterion criterion) {
  switch (criterion) {
    case BarCriterion::four_or_five:
      return "four-or-five";
    case BarCriterion::bars_resolved:
      return "bars-resolved";
    case BarCriterion::detection:
      break;
  }
  return "detection";
}

Result<std::vector<VirtualMrtdPoint>> virtual_mrtd(const VirtualMrtdTask& task) {
  const SensorSpec spec = as_planned(task.sensor, task.plan);
  TODBENCH_TRY_VOID(check_bars(task, spec));
  const SceneImager imager(spec, task.plan, task.accuracy);
  std::vector<VirtualMrtdPoint> points;
  for (const double frequency : task.frequencies_per_mrad) {
    points.push_back(point_before_trials(task, spec, frequency));
    TODBENCH_TRY(auto trial, BarTrial::create(task, spec, imager, frequency));
    TODBENCH_TRY_VOID(trial.measure(points.back()));
  }
  return points;
}

/// All data of a frequency except the observer.
struct BarFrames::Frequency {
  Frequency(const VirtualMrtdTask& task, const SensorSpec& sensor, double frequency_per_mrad)
      : spec(sensor),
        imager(spec, task.plan, task.accuracy),
        window(spec, imager),
        axis(task.axis),
        frequency_per_pitch(frequency_per_mrad * spec.ifov_mrad()),
        side(identification_window_samples(
            task.observer,
            std::vector<AlternativeAspects>{
                {bar_edges_in_samples(spec, BarPattern::four_bars, frequency_per_pitch, axis)},
                {bar_edges_in_samples(spec, BarPattern::five_bars, frequency_per_pitch, axis)}},
            spec.samples_per_pitch())),
        noise(spec, task.plan, task.accuracy, side, task.seed),
        known(point_before_trials(task, spec, frequency_per_mrad)) {}
  SensorSpec spec;
  SceneImager imager;
  SeenWindow window;
  BarAxis axis;
  double frequency_per_pitch;
  int side;
  WindowNoise noise;
  VirtualMrtdPoint known;
};

Result<BarFrames> BarFrames::of(const VirtualMrtdTask& task) {
  const SensorSpec spec = as_planned(task.sensor, task.plan);
  TODBENCH_TRY_VOID(check_bars(task, spec));
  BarFrames frames;
  for (const double frequency : task.frequencies_per_mrad)
    frames.frequencies_.push_back(std::make_shared<const Frequency>(task, spec, frequency));
  return frames;
}

cv::Mat1f BarFrames::frame_k(std::size_t frequency, BarPattern pattern, double contrast_k, std::size_t phase,
                             std::uint64_t draw) const {
  const Frequency& at = *frequencies_[frequency];
  return at.window.picture(bar_edges_in_samples(at.spec, pattern, at.frequency_per_pitch, at.axis), at.side,
                           bar_offset(phase % bar_phases, at.axis), contrast_k, phase % bar_phases) +
         at.noise.sensor_k(draw);
}

double BarFrames::ideal_k(std::size_t frequency) const {
  return frequencies_[frequency]->known.ideal_k;
}

}  // namespace todbench
