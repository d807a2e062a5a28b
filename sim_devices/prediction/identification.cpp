// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/identification.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <thread>

#include "acquisition/base/try.h"
#include "hvs/observer/identification_bank.h"
#include "hvs/observer/open_parameters.h"
#include "hvs/observer/viewing_filter.h"
#include "sim_devices/prediction/seen_window.h"
#include "sim_devices/prediction/window_noise.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/transfer_functions.h"

namespace todbench {
namespace {

constexpr int phases_on_axis = 4;
constexpr int phases = phases_on_axis * phases_on_axis;

// Rates per second on one core, for the planned effort.
constexpr double spectrum_rate = 7e7, product_rate = 1.3e9, projection_rate = 2e10, score_rate = 5e9;

/// Number of noise draws at every range. Each view meets each of them.
std::size_t draws_of(const IdentificationTask& task) {
  const int aspects = static_cast<int>(task.targets.front().aspects.size());
  return static_cast<std::size_t>(std::max(phases, (task.decisions + aspects - 1) / aspects));
}

/// One view, independent of range: edges in metres, and contrast.
struct SeenAspect {
  std::vector<StepEdge> edges_m;
  double dt_rss_k = 0, size_m = 0;
};
using SeenTargets = std::vector<std::vector<SeenAspect>>;

bool look_alike(const std::vector<SeenAspect>& a, const std::vector<SeenAspect>& b) {
  const auto same = [](const StepEdge& p, const StepEdge& q) {
    return cv::norm(p.a - q.a) < 1e-6 && cv::norm(p.b - q.b) < 1e-6 && std::abs(p.step - q.step) < 1e-9;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const SeenAspect& s, const SeenAspect& t) {
    return std::equal(s.edges_m.begin(), s.edges_m.end(), t.edges_m.begin(), t.edges_m.end(), same);
  });
}

/// Scales all targets to the mean size.
void make_alike_in_size(SeenTargets& targets) {
  double sum = 0, count = 0;
  for (const auto& target : targets) {
    for (const auto& aspect : target) {
      sum += aspect.size_m;
      ++count;
    }
  }
  for (auto& target : targets) {
    for (auto& aspect : target) aspect.edges_m = placed(aspect.edges_m, sum / count / aspect.size_m, 0, {0, 0});
  }
}

Result<SeenTargets> seen_targets(const IdentificationTask& task) {
  const RadianceScale scale{{task.sensor.wavelength_min_um, task.sensor.wavelength_max_um},
                            task.sensor.scene_temperature_k};
  SeenTargets out;
  for (const auto& target : task.targets) {
    if (target.aspects.empty() || target.aspects.size() != task.targets.front().aspects.size())
      return fail(ErrorCode::invalid_input, "every target must have the same number of aspects, at least one");
  }
  for (const auto& target : task.targets) {
    auto& own = out.emplace_back();
    for (const auto& scene : target.aspects) {
      if (auto fine = validate(scene); !fine) return fail("target " + target.name, fine.error());
      const auto signature = target_signature(scene, scale);
      if (!signature || !(signature->dt_rss_k() > 0))
        return fail(ErrorCode::invalid_input, "target " + target.name + " has no contrast against its background");
      auto painted = levels_k(scene, scale);
      if (task.cues == TargetCues::shape) {
        for (auto& region : painted) region.level = signature->dt_rss_k();
      }
      own.push_back({visible_edges(painted), signature->dt_rss_k(), signature->size_m()});
    }
  }
  if (out.size() < 2) return fail(ErrorCode::invalid_input, "identification needs at least two targets");
  if (task.cues == TargetCues::shape) make_alike_in_size(out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t other = 0; other < i; ++other) {
      if (look_alike(out[other], out[i])) {
        return fail(ErrorCode::invalid_input, "targets " + task.targets[other].name + " and " + task.targets[i].name +
                                                  " look alike in every aspect, so no observer can distinguish them");
      }
    }
  }
  return out;
}

/// Each draw meets a view in one of the phases; views begin with different ones.
std::size_t first_draw_of(std::size_t phase, std::size_t target, std::size_t aspect) {
  return (phase + target + 5 * aspect) % phases;
}

/// Offset of a target's origin from the middle of the window, in samples.
cv::Point2d view_offset(std::size_t phase) {
  const auto offset = [](std::size_t k) { return (static_cast<double>(k) + 0.5) / phases_on_axis - 0.5; };
  return {offset(phase % phases_on_axis), offset(phase / phases_on_axis)};
}

/// Number of a picture without noise, unique for the image dance.
std::uint64_t presentation_of(std::size_t phase, std::size_t target, std::size_t aspect) {
  return phase + phases * (aspect + 8 * target);
}

double samples_per_metre(const SensorSpec& spec, const IdentificationRange& range) {
  return 1e3 / (range.range_m * spec.ifov_mrad()) * spec.samples_per_pitch();
}

std::vector<AlternativeAspects> in_samples(const SeenTargets& targets, double samples_per_metre) {
  std::vector<AlternativeAspects> alternatives;
  for (const auto& target : targets) {
    auto& own = alternatives.emplace_back();
    for (const auto& aspect : target) own.push_back(placed(aspect.edges_m, samples_per_metre, 0, {0, 0}));
  }
  return alternatives;
}

/// The observer with the camera at one range.
class RangeTrial {
 public:
  static Result<RangeTrial> create(const IdentificationTask& task, const SeenTargets& targets,
                                   IdentificationRange range, const SceneImager& imager) {
    RangeTrial trial(task, range, imager);
    std::vector<AlternativeAspects> alternatives = in_samples(targets, trial.samples_per_metre_);
    auto bank =
        IdentificationBank::build(task.observer, alternatives, trial.spec_.samples_per_pitch(), trial.known_camera());
    if (!bank) return tl::unexpected(bank.error());
    trial.bank_.emplace(*std::move(bank));
    trial.alternatives_ = std::move(alternatives);
    return trial;
  }

  Result<IdentificationPoint> run(const SeenTargets& targets) {
    const std::size_t draws = draws_of(task_);
    if (auto drawn = draw_noise(draws); !drawn) return tl::unexpected(drawn.error());
    IdentificationPoint point{.range_m = range_.range_m,
                              .transmittance = range_.transmittance,
                              .answers = std::vector(targets.size(), std::vector<int>(targets.size(), 0)),
                              .by_draw = std::vector<double>(draws, 0.0)};
    if (auto answered = answer(targets, task_.observer, point); !answered) return tl::unexpected(answered.error());
    const auto ends = at_open_ends(task_.observer, [&](const TemplateObserverSpec& seeing) -> Result<double> {
      IdentificationPoint end = point;
      for (auto& row : end.answers) std::ranges::fill(row, 0);
      std::ranges::fill(end.by_draw, 0.0);
      if (auto answered = answer(targets, seeing, end); !answered) return tl::unexpected(answered.error());
      return end.proportion();
    });
    if (!ends) return tl::unexpected(ends.error());
    if (*ends) point.spread = spread_of({(**ends)[0], (**ends)[1]});
    return point;
  }

 private:
  /// Answers of an observer that differs from that of the task in its own noise only.
  Result<void> answer(const SeenTargets& targets, const TemplateObserverSpec& observer, IdentificationPoint& point) {
    const std::size_t draws = point.by_draw.size();
    double shown = 0;
    for (const auto& target : targets) shown += static_cast<double>(target.size());
    std::vector<float> own(observer.eye ? bank_->scores() : 0);
    for (std::size_t t = 0; t < targets.size(); ++t) {
      for (std::size_t a = 0; a < targets[t].size(); ++a) {
        const double contrast_k = targets[t][a].dt_rss_k * range_.transmittance;
        if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
        const float white = own_noise(observer, contrast_k);
        const auto eye = static_cast<float>(
            observer.eye ? bank_->eye_noise_k(observer, t, a, contrast_k, targets[t][a].dt_rss_k) : 0);
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

  RangeTrial(const IdentificationTask& task, IdentificationRange range, const SceneImager& imager)
      : task_(task),
        range_(range),
        spec_(sensor_at(task, range.range_m)),
        window_(spec_, imager),
        samples_per_metre_(samples_per_metre(spec_, range)) {}

  /// Transfer function of the camera with its display; empty for an observer without knowledge of it. Cut at 3 cycles
  /// per pitch, which leaves out 0.3 % of the contrast at an edge.
  [[nodiscard]] std::optional<KnownCamera> known_camera() const {
    if (task_.knowledge == TemplateKnowledge::ideal) return std::nullopt;
    const int n = spec_.samples_per_pitch();
    return KnownCamera{
        [spec = spec_, n, camera = sensor_transfer(spec_, task_.plan, task_.accuracy.wavelengths)](double u, double w) {
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

  /// Noise of the observer in kelvin per sample: internal noise, and the enlargement of the sensor's noise.
  [[nodiscard]] float own_noise(const TemplateObserverSpec& observer, double contrast_k) const {
    const double enlarged = observer.sensor_noise_factor * observer.sensor_noise_factor - 1;
    return static_cast<float>(std::sqrt(std::pow(observer.internal_noise * contrast_k, 2) +
                                        enlarged * white_variance_k2(spec_, task_.plan, 1)));
  }

  /// Every range has the same random numbers, except for the size of the window.
  Result<void> draw_noise(std::size_t draws) {
    const WindowNoise noise(spec_, task_.plan, task_.accuracy, bank_->window_samples(), task_.seed);
    constexpr std::size_t at_once = 32;
    for (std::size_t first = 0; first < draws; first += at_once) {
      if (task_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      std::vector<cv::Mat1f> sensor, white, eye;
      for (std::size_t d = first; d < std::min(draws, first + at_once); ++d) {
        sensor.push_back(centred(noise.sensor_k(d)));
        white.push_back(task_.observer.eye ? noise.white(d) : centred(noise.white(d)));
        if (const int points = bank_->eye_points(); points > 0) {
          eye.emplace_back(points, points);
          RandomStream(task_.seed, "identify.eye").sub(d).fill_normal({eye.back().ptr<float>(), eye.back().total()});
        }
      }
      for (auto& projected : bank_->project_all(sensor)) sensor_noise_.push_back(std::move(projected));
      for (auto& projected : bank_->project_all(white)) white_.push_back(std::move(projected));
      if (eye.empty()) continue;
      for (auto& projected : bank_->project_eye(eye)) eye_.push_back(std::move(projected));
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
  TODBENCH_TRY(const auto targets, seen_targets(task));
  const SensorSpec spec = as_planned(task.sensor, task.plan);
  const int n = spec.samples_per_pitch();
  double views = 0, edges = 0, reach_m = 0;
  for (const auto& target : targets) {
    for (const auto& aspect : target) {
      ++views;
      edges += static_cast<double>(aspect.edges_m.size());
      for (const auto& edge : aspect.edges_m)
        reach_m = std::max({reach_m, std::abs(edge.a.x), std::abs(edge.a.y), std::abs(edge.b.x), std::abs(edge.b.y)});
    }
  }
  const auto draws = static_cast<double>(draws_of(task));
  const double places =
      std::pow(2 * std::round(task.observer.search_range_samples / task.observer.search_step_samples) + 1, 2);
  IdentificationEffort out;
  out.decisions = draws * views * static_cast<double>(task.ranges.size());
  for (const auto& range : task.ranges) {
    const double reach = reach_m * 1e3 / (range.range_m * spec.ifov_mrad());  // pitches
    const double side = 2 * n * std::ceil(1.1 * reach + task.observer.window_margin_pitch);
    const double samples = side * side;
    // Rank of the templates of one view at all places: 30 for a point, about half of the places for a large target.
    const double rank = std::min({30 + 8 * reach * n, places / 2 + 1, samples});
    out.largest_bytes = std::max(out.largest_bytes, samples * rank * views * sizeof(float));
    double band = task.knowledge == TemplateKnowledge::ideal ? 1.2 / task.observer.blur_sigma_samples : 3.0 / n;
    if (task.observer.eye) band = std::min(viewing_filter(task.observer).band_per_sample, 3.0 / n);
    const double frequencies = 2 * std::pow(band * (0.5 * side + reach * n + 6), 2);
    // Measured rates per second.
    out.processor_s += edges * frequencies / spectrum_rate + views * rank * places * samples / product_rate +
                       (16 * views + 2 * draws) * rank * views * (samples + places) / projection_rate +
                       draws * views * views * places / score_rate;
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
  const auto targets = seen_targets(task);
  if (!targets) return tl::unexpected(targets.error());
  if (task.plan.simulates(Effect::quantisation) && rounds_coarsely(as_planned(task.sensor, task.plan)))
    return fail(ErrorCode::invalid_input,
                "a count of the camera is larger than its noise, so rounding depends on the targets. The experiment "
                "does not simulate this");
  const SensorSpec spec = as_planned(task.sensor, task.plan);
  const SceneImager imager(spec, task.plan, task.accuracy);
  std::vector<Result<IdentificationPoint>> found(task.ranges.size(), IdentificationPoint{});
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < found.size(); i = next++) {
      std::optional<SceneImager> own;
      if (task.cn2_m_minus_2_3 > 0) own.emplace(sensor_at(task, task.ranges[i].range_m), task.plan, task.accuracy);
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

/// One range: everything except the observer.
struct IdentificationFrames::Range {
  Range(const IdentificationTask& task, const SeenTargets& targets, const IdentificationRange& range)
      : spec(sensor_at(task, range.range_m)),
        imager(spec, task.plan, task.accuracy),
        window(spec, imager),
        transmittance(range.transmittance),
        alternatives(in_samples(targets, samples_per_metre(spec, range))),
        side(identification_window_samples(task.observer, alternatives, spec.samples_per_pitch())),
        noise(spec, task.plan, task.accuracy, side, task.seed) {}
  SensorSpec spec;
  SceneImager imager;
  SeenWindow window;
  double transmittance;
  std::vector<AlternativeAspects> alternatives;
  int side;
  WindowNoise noise;
};

Result<IdentificationFrames> IdentificationFrames::of(const IdentificationTask& task) {
  TODBENCH_TRY(const auto targets, seen_targets(task));
  IdentificationFrames frames;
  for (const auto& range : task.ranges) frames.ranges_.push_back(std::make_shared<const Range>(task, targets, range));
  for (const auto& target : targets) {
    auto& own = frames.contrasts_k_.emplace_back();
    for (const auto& aspect : target) own.push_back(aspect.dt_rss_k);
  }
  return frames;
}

cv::Mat1f IdentificationFrames::frame_k(std::size_t range, std::size_t target, std::size_t aspect,
                                        std::uint64_t draw) const {
  const Range& at = *ranges_[range];
  std::size_t phase = 0;
  while (first_draw_of(phase, target, aspect) != draw % phases) ++phase;
  return at.window.picture(at.alternatives[target][aspect], at.side, view_offset(phase), at.transmittance,
                           presentation_of(phase, target, aspect)) +
         at.noise.sensor_k(draw);
}

double IdentificationFrames::contrast_k(std::size_t range, std::size_t target, std::size_t aspect) const {
  return contrasts_k_[target][aspect] * ranges_[range]->transmittance;
}

}  // namespace todbench
