// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>

#include "acquisition/base/try.h"
#include "hvs/observer/identification_bank.h"
#include "hvs/observer/open_parameters.h"
#include "hvs/observer/template_bank.h"
#include "hvs/observer/viewing_filter.h"
#include "sim_devices/prediction/identification_passes.h"
#include "sim_devices/prediction/identification_views.h"
#include "sim_devices/prediction/seen_window.h"
#include "sim_devices/prediction/window_noise.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/transfer_functions.h"

namespace todbench {
namespace {

constexpr int phases = identification_phases;

// Rates per second on one core, for the planned effort.
constexpr double spectrum_rate = 7e7, product_rate = 1.3e9, projection_rate = 2e10, score_rate = 5e9, noise_rate = 2e7;

/// Number of noise draws at every range. Each view meets each of them.
std::size_t draws_of(const IdentificationTask& task) {
  const int aspects = static_cast<int>(task.targets.front().aspects.size());
  return static_cast<std::size_t>(std::max(phases, (task.decisions + aspects - 1) / aspects));
}

/// The observer with the camera at one range.
class RangeTrial {
 public:
  static Result<RangeTrial> create(const IdentificationTask& task, const SeenTargets& targets,
                                   IdentificationRange range, const SceneImager& imager) {
    RangeTrial trial(task, range, imager);
    const auto known = in_samples(targets, trial.samples_per_metre_, trial.spec_, trial.known_motion());
    const TemplateObserverSpec searching = trial.tracks() ? searching_at_true_places(task.observer) : task.observer;
    auto bank = IdentificationBank::build(searching, known, trial.spec_.samples_per_pitch(), trial.known_camera());
    if (!bank) return tl::unexpected(bank.error());
    trial.bank_.emplace(*std::move(bank));
    trial.alternatives_ = in_samples(targets, trial.samples_per_metre_, trial.spec_, task.motion);
    return trial;
  }

  Result<IdentificationPoint> run(const SeenTargets& targets) {
    const std::size_t draws = draws_of(task_);
    TODBENCH_TRY_VOID(draw_noise(draws));
    const IdentificationPoint nothing{.range_m = range_.range_m,
                                      .transmittance = range_.transmittance,
                                      .answers = std::vector(targets.size(), std::vector<int>(targets.size(), 0)),
                                      .by_draw = std::vector<double>(draws, 0.0)};
    // The observer of the task, and both ends of its open parameters.
    std::vector<Seeing> all{{task_.observer, nothing}};
    for (TemplateObserverSpec& end : open_ends(task_.observer)) all.push_back({std::move(end), nothing});
    if (judges_passes()) {
      TODBENCH_TRY_VOID(answer_passes(targets, all));
    } else {
      for (Seeing& one : all) {
        TODBENCH_TRY_VOID(answer(targets, one.observer, one.point));
      }
    }
    if (all.size() > 1) all[0].point.spread = spread_of({all[1].point.proportion(), all[2].point.proportion()});
    return std::move(all.front().point);
  }

 private:
  /// An observer that differs from that of the task in its own noise only, and its answers.
  struct Seeing {
    TemplateObserverSpec observer;
    IdentificationPoint point;
  };

  [[nodiscard]] bool tracks() const { return task_.sequence == SequenceObserver::tracking_sum; }
  [[nodiscard]] bool judges_passes() const { return task_.stages || task_.sequence != SequenceObserver::single_frame; }

  /// Answers of an observer that differs from that of the task in its own noise only.
  Result<void> answer(const SeenTargets& targets, const TemplateObserverSpec& observer, IdentificationPoint& point) {
    const std::size_t draws = point.by_draw.size();
    double shown = 0;
    for (const auto& target : targets) shown += static_cast<double>(target.size());
    std::vector<float> own(observer.eye ? bank_->scores() : 0);
    for (std::size_t t = 0; t < targets.size(); ++t) {
      for (std::size_t a = 0; a < targets[t].size(); ++a) {
        if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
        const auto [white, eye] = own_noise_of(observer, t, a, targets[t][a], {});
        std::vector<cv::Mat1f> patches;
        for (std::size_t phase = 0; phase < phases; ++phase) patches.push_back(patch(t, a, phase));
        const auto signals = bank_->project_all(patches);
        for (std::size_t phase = 0; phase < phases; ++phase) {
          const auto& signal = signals[phase];
          for (std::size_t d = first_draw_of(phase, t, a); d < draws; d += phases) {
            std::size_t answer = 0;
            if (observer.eye) {
              for (std::size_t i = 0; i < own.size(); ++i) own[i] = white * white_[d][i] + eye * eye_[d][i];
              answer = bank_->best(signal, sensor_noise_[d], 1.0F, own, 1.0F);
            } else {
              answer = bank_->best(signal, sensor_noise_[d], 1.0F, white_[d], white);
            }
            ++point.answers[t][answer];
            if (answer == t) point.by_draw[d] += 1 / shown;
          }
        }
      }
    }
    return {};
  }

  /// Answers of several observers to the same passes.
  Result<void> answer_passes(const SeenTargets& targets, std::vector<Seeing>& all) {
    TODBENCH_TRY(const auto passes, IdentificationPasses::of(task_, spec_, window_, range_.transmittance, alternatives_,
                                                             bank_->window_samples()));
    for (Seeing& one : all) one.point.judged = passes->judged();
    const double views = static_cast<double>(targets.size() * targets.front().size());
    for (std::size_t t = 0; t < targets.size(); ++t) {
      for (std::size_t a = 0; a < targets[t].size(); ++a) {
        for (std::size_t phase = 0; phase < phases; ++phase) {
          const auto signals = passes->signals(t, a, phase);
          for (std::size_t d = first_draw_of(phase, t, a); d < all.front().point.by_draw.size(); d += phases) {
            if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
            TODBENCH_TRY(const auto windows, passes->windows(signals, d));
            const std::vector<float> scores = scores_of(windows);
            for (Seeing& one : all) {
              const OwnNoise noise = own_noise_of(one.observer, t, a, targets[t][a], passes->scale(t, a));
              const std::size_t answer = winner(scores, noise, d);
              ++one.point.answers[t][answer];
              if (answer == t) one.point.by_draw[d] += 1 / views;
            }
          }
        }
      }
    }
    return {};
  }

  /// Mean of the scores of the windows; a search that tracks is centred on the true place in each.
  [[nodiscard]] std::vector<float> scores_of(const std::vector<PassWindow>& windows) const {
    std::vector<cv::Mat1f> patches;
    for (const PassWindow& window : windows) patches.push_back(centred(window.kelvin));
    auto projected = bank_->project_all(patches);
    if (!tracks()) return std::move(projected.front());
    std::vector<float> sum(bank_->views() * places_of_search(task_.observer), 0.0F);
    for (std::size_t k = 0; k < windows.size(); ++k)
      add_centred(task_.observer, projected[k], windows[k].phase, 1.0F / static_cast<float>(windows.size()), sum);
    return sum;
  }

  /// Standard deviations of the noise of an observer, in units of its white scores and those of its eye.
  struct OwnNoise {
    float white = 0, eye = 0;
  };
  [[nodiscard]] OwnNoise own_noise_of(const TemplateObserverSpec& observer, std::size_t target, std::size_t aspect,
                                      const SeenAspect& shown, ViewScale scale) const {
    const double contrast_k = shown.dt_rss_k * range_.transmittance * scale.contrast;
    const int frames = task_.sequence == SequenceObserver::single_frame ? 1 : task_.frames;
    OwnNoise out{.white = own_noise(observer, contrast_k, scale.noise, frames)};
    if (observer.eye)
      out.eye = static_cast<float>(bank_->eye_noise_k(observer, target, aspect, contrast_k, shown.dt_rss_k));
    return out;
  }

  /// Answer to a pass with the noise of the observer, once for the decision.
  [[nodiscard]] std::size_t winner(const std::vector<float>& scores, OwnNoise noise, std::size_t draw) const {
    std::size_t best = 0, at = 0;
    float largest = -1e30F;
    for (std::size_t o = 0; o < alternatives_.size(); ++o) {
      for (const std::size_t end = at + alternatives_[o].size() * places_of_search(task_.observer); at < end; ++at) {
        const float score =
            scores[at] + noise.white * white_[draw][at] + (eye_.empty() ? 0.0F : noise.eye * eye_[draw][at]);
        if (score > largest) largest = score, best = o;
      }
    }
    return best;
  }

  /// Scores of noise as the observer's own search has them.
  [[nodiscard]] std::vector<float> own_search(std::vector<float> scores) const {
    if (!tracks()) return scores;
    std::vector<float> own(bank_->views() * places_of_search(task_.observer), 0.0F);
    add_centred(task_.observer, scores, {0, 0}, 1, own);
    return own;
  }

  RangeTrial(const IdentificationTask& task, IdentificationRange range, const SceneImager& imager)
      : task_(task),
        range_(range),
        spec_(sensor_at(task, range.range_m)),
        window_(spec_, imager),
        samples_per_metre_(samples_per_metre(spec_, range)) {}

  /// Motion in which the observer knows its targets.
  [[nodiscard]] SceneMotion known_motion() const {
    return task_.knowledge == TemplateKnowledge::behind_camera ? task_.motion : SceneMotion{};
  }

  /// Transfer function of the camera with its display; empty for an observer without knowledge of it. Cut at 3 cycles
  /// per pitch, which leaves out 0.3 % of the contrast at an edge.
  [[nodiscard]] std::optional<KnownCamera> known_camera() const {
    if (task_.knowledge == TemplateKnowledge::ideal) return std::nullopt;
    const int n = spec_.samples_per_pitch();
    return KnownCamera{
        [spec = spec_, n, camera = sensor_transfer(spec_, task_.plan, task_.accuracy.wavelengths, known_motion())](
            double u, double w) {
          const double display = has_display(spec) ? display_response(spec, u) * display_response(spec, w) : 1;
          return display * camera(u * n, w * n);
        },
        3.0 / n};
  }

  [[nodiscard]] cv::Mat1f centred(const cv::Mat1f& window) const { return without_background(task_.observer, window); }

  [[nodiscard]] cv::Mat1f patch(std::size_t target, std::size_t aspect, std::size_t phase) const {
    return centred(window_.picture(alternatives_[target][aspect], bank_->window_samples(), view_offset(phase),
                                   range_.transmittance, presentation_of(phase, target, aspect)));
  }

  /// Noise of the observer in kelvin per sample: internal noise, and the enlargement of the sensor's noise in the mean
  /// of some frames.
  [[nodiscard]] float own_noise(const TemplateObserverSpec& observer, double contrast_k, double noise_ratio,
                                int frames) const {
    const double enlarged = observer.sensor_noise_factor * observer.sensor_noise_factor - 1;
    return static_cast<float>(
        std::sqrt(std::pow(observer.internal_noise * contrast_k, 2) +
                  enlarged * white_variance_k2(spec_, task_.plan, 1) * noise_ratio * noise_ratio / frames));
  }

  /// Every range has the same random numbers, except for the size of the window.
  Result<void> draw_noise(std::size_t draws) {
    const WindowNoise noise(spec_, task_.plan, task_.accuracy, bank_->window_samples(), task_.seed);
    constexpr std::size_t at_once = 32;
    for (std::size_t first = 0; first < draws; first += at_once) {
      if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      std::vector<cv::Mat1f> sensor, white, eye;
      for (std::size_t d = first; d < std::min(draws, first + at_once); ++d) {
        if (!judges_passes()) sensor.push_back(centred(noise.sensor_k(d)));
        white.push_back(task_.observer.eye ? noise.white(d) : centred(noise.white(d)));
        if (const int points = bank_->eye_points(); points > 0) {
          eye.emplace_back(points, points);
          RandomStream(task_.seed, "identify.eye").sub(d).fill_normal({eye.back().ptr<float>(), eye.back().total()});
        }
      }
      for (auto& projected : bank_->project_all(sensor)) sensor_noise_.push_back(std::move(projected));
      for (auto& projected : bank_->project_all(white)) white_.push_back(own_search(std::move(projected)));
      if (eye.empty()) continue;
      for (auto& projected : bank_->project_eye(eye)) eye_.push_back(own_search(std::move(projected)));
    }
    return {};
  }

  const IdentificationTask& task_;
  IdentificationRange range_;
  SensorSpec spec_;
  SeenWindow window_;
  double samples_per_metre_;
  std::optional<IdentificationBank> bank_;
  std::vector<AlternativeAspects> alternatives_;
  std::vector<std::vector<float>> sensor_noise_, white_;  ///< by draw
  std::vector<std::vector<float>> eye_;                   ///< by draw; only with an eye
};

/// Half width in metres of the largest view.
double reach_of_views(const SeenTargets& targets) {
  double reach_m = 0;
  for (const auto& target : targets) {
    for (const auto& aspect : target) {
      for (const auto& edge : aspect.edges_m)
        reach_m = std::max({reach_m, std::abs(edge.a.x), std::abs(edge.a.y), std::abs(edge.b.x), std::abs(edge.b.y)});
    }
  }
  return reach_m;
}

/// Predicted size of the templates of one range.
struct PredictedTemplates {
  double reach_pitch = 0, side = 0, samples = 0, rank = 0, bytes = 0;
};

PredictedTemplates predicted_templates(const IdentificationTask& task, const SensorSpec& spec,
                                       const SeenTargets& targets, double reach_m, double range_m) {
  PredictedTemplates out;
  const int n = spec.samples_per_pitch();
  double views = 0;
  for (const auto& target : targets) views += static_cast<double>(target.size());
  out.reach_pitch = reach_m * 1e3 / (range_m * spec.ifov_mrad());
  out.side = 2 * n * std::ceil(1.1 * out.reach_pitch + task.observer.window_margin_pitch);
  out.samples = out.side * out.side;
  // Rank of the templates of one view at all places: 30 for a point, about half of the places for a large target.
  out.rank = std::min(
      {30 + 8 * out.reach_pitch * n, static_cast<double>(places_of_search(task.observer)) / 2 + 1, out.samples});
  out.bytes = out.samples * out.rank * views * sizeof(float);
  return out;
}

/// Refuses a range whose templates are beyond the limit of the bank even if the prediction is four times too large:
/// before anything is computed, because the pictures of such a range need more memory than any machine has.
Result<void> check_memory(const IdentificationTask& task, const SensorSpec& spec, const SeenTargets& targets) {
  constexpr double limit = TemplateBank::max_bytes, sure = 4, gib = 1 << 30;
  const double reach_m = reach_of_views(targets);
  const auto bytes = [&](double range_m) { return predicted_templates(task, spec, targets, reach_m, range_m).bytes; };
  for (const auto& range : task.ranges) {
    const double needed = bytes(range.range_m);
    if (needed <= sure * limit) continue;
    double feasible_m = range.range_m;
    for (; feasible_m < 1e9 && bytes(feasible_m) > limit; feasible_m *= 1.02) {
    }
    return fail(ErrorCode::invalid_input,
                fmt::format("at {:g} m the targets are too large for this observer: their templates would need about "
                            "{:.0f} GiB, at most {:.0f} GiB are allowed; the shortest feasible range is about {:.3g} m",
                            range.range_m, needed / gib, limit / gib, feasible_m));
  }
  return {};
}

}  // namespace

SensorSpec sensor_at(const IdentificationTask& task, double range_m) {
  SensorSpec spec = task.sensor;
  if (task.cn2_m_minus_2_3 > 0) {
    spec.turbulence_cn2_m_minus_2_3 = task.cn2_m_minus_2_3;
    spec.turbulence_path_m = range_m;
  }
  return as_planned(spec, task.plan);
}

Result<IdentificationEffort> planned_effort(const IdentificationTask& task) {
  TODBENCH_TRY_VOID(check_passes(task));
  TODBENCH_TRY(const auto targets, seen_targets(task));
  const SensorSpec spec = as_planned(task.sensor, task.plan);
  const int n = spec.samples_per_pitch();
  TODBENCH_TRY_VOID(check_memory(task, spec, targets));
  const double reach_m = reach_of_views(targets);
  double views = 0, edges = 0;
  for (const auto& target : targets) {
    for (const auto& aspect : target) {
      ++views;
      edges += static_cast<double>(aspect.edges_m.size());
    }
  }
  const auto draws = static_cast<double>(draws_of(task));
  const auto places = static_cast<double>(places_of_search(task.observer));
  IdentificationEffort out;
  out.decisions = draws * views * static_cast<double>(task.ranges.size());
  const double windows = task.sequence == SequenceObserver::tracking_sum ? task.frames : 1;
  // Pictures of a pass; those of stages that need the whole picture of the camera are larger.
  double frames = task.sequence == SequenceObserver::single_frame ? 1 : task.frames, whole = 0;
  if (task.stages) {
    for (const auto& stage : task.stages()) frames += stage->memory_frames();
    if (!task.stage_reach_px) whole = static_cast<double>(spec.width) * spec.height * n * n;
  }
  for (const auto& range : task.ranges) {
    const auto [reach, side, samples, rank, bytes] = predicted_templates(task, spec, targets, reach_m, range.range_m);
    out.largest_bytes = std::max(out.largest_bytes, bytes);
    double band = task.knowledge == TemplateKnowledge::ideal ? 1.2 / task.observer.blur_sigma_samples : 3.0 / n;
    if (task.observer.eye) band = std::min(viewing_filter(task.observer).band_per_sample, 3.0 / n);
    const double frequencies = 2 * std::pow(band * (0.5 * side + reach * n + 6), 2);
    // Measured rates per second.
    out.processor_s += edges * frequencies / spectrum_rate + views * rank * places * samples / product_rate +
                       (16 * views + 2 * draws) * rank * views * (samples + places) / projection_rate +
                       draws * views * views * places / score_rate;
    if (task.sequence == SequenceObserver::single_frame && !task.stages) continue;
    out.processor_s += draws * views *
                       (windows * rank * views * (samples + places) / projection_rate +
                        frames * std::max(samples, whole) / noise_rate);
  }
  return out;
}

double IdentificationPoint::proportion() const {
  return std::accumulate(by_draw.begin(), by_draw.end(), 0.0) / static_cast<double>(by_draw.size());
}

double IdentificationPoint::standard_error() const {
  const double mean = proportion(), n = static_cast<double>(by_draw.size());
  double squares = 0;
  for (const double share : by_draw) squares += (share - mean) * (share - mean);
  return n > 1 ? std::sqrt(squares / (n - 1) / n) : 1;
}

Result<std::vector<IdentificationPoint>> identify(const IdentificationTask& task) {
  TODBENCH_TRY_VOID(require_square_pixels(task.sensor, "identification"));
  TODBENCH_TRY_VOID(check_passes(task));
  const auto targets = seen_targets(task);
  if (!targets) return tl::unexpected(targets.error());
  if (task.plan.simulates(Effect::quantisation) && rounds_coarsely(as_planned(task.sensor, task.plan)))
    return fail(ErrorCode::invalid_input,
                "a count of the camera is larger than its noise, so rounding depends on the targets. The experiment "
                "does not simulate this");
  const SensorSpec spec = as_planned(task.sensor, task.plan);
  TODBENCH_TRY_VOID(check_memory(task, spec, *targets));
  const SceneImager imager(spec, task.plan, task.accuracy, task.motion);
  std::vector<Result<IdentificationPoint>> found(task.ranges.size(), IdentificationPoint{});
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < found.size(); i = next++) {
      std::optional<SceneImager> own;
      if (task.cn2_m_minus_2_3 > 0)
        own.emplace(sensor_at(task, task.ranges[i].range_m), task.plan, task.accuracy, task.motion);
      auto trial = RangeTrial::create(task, *targets, task.ranges[i], own ? *own : imager);
      if (trial) {
        found[i] = trial->run(*targets);
      } else {
        found[i] = tl::unexpected(trial.error());
      }
    }
  };
  {
    std::vector<std::jthread> threads;
    const std::size_t count =
        std::min<std::size_t>(found.size(), std::clamp(std::thread::hardware_concurrency(), 1U, 4U));
    for (std::size_t i = 1; i < count; ++i) threads.emplace_back(work);
    work();
  }
  std::vector<IdentificationPoint> points;
  for (auto& point : found) {
    if (!point) return tl::unexpected(point.error());
    points.push_back(*std::move(point));
  }
  return points;
}

}  // namespace todbench
