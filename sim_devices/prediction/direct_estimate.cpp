#include "sim_devices/prediction/direct_estimate.h"

#include <fmt/format.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>

#include "sim_devices/prediction/size_trial.h"
#include "sim_devices/sensor/image_chain.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double size_step = 1.08;   ///< sizes are powers of it, so that contrasts share banks and noise
constexpr int smallest_index = -20;  ///< 0.21 pitch
constexpr int largest_index = 48;    ///< 40 pitches
constexpr int scout_draws = 64;

double size_of(int index) {
  return std::pow(size_step, index);
}

/// ln((P - 0.25) / (1 - P)): nearly linear in ln size near the threshold, ln 2 at 75 %.
double transformed(double p, double resolution) {
  const double inside = std::clamp(p, 0.25 + resolution, 1 - resolution);
  return std::log((inside - 0.25) / (1 - inside));
}

double transformed_slope(double p, double resolution) {
  const double inside = std::clamp(p, 0.25 + resolution, 1 - resolution);
  return 1 / (inside - 0.25) + 1 / (1 - inside);
}

/// Where the local quadratic through the points meets ln 2, with its standard error; in ln size relative to `centre`.
struct Crossing {
  double x = 0, standard_error = 0;
};

std::optional<Crossing> crossing(const std::vector<double>& xs, const std::vector<Proportion>& ps, double resolution) {
  const auto n = static_cast<Eigen::Index>(xs.size());
  Eigen::MatrixXd a(n, 3);
  Eigen::VectorXd y(n), variance(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    a.row(i) << 1, xs[k], xs[k] * xs[k];
    y(i) = transformed(ps[k].mean, resolution);
    variance(i) = std::max(ps[k].variance, 1e-8) * std::pow(transformed_slope(ps[k].mean, resolution), 2);
  }
  const Eigen::VectorXd weight = variance.cwiseInverse();
  const Eigen::Matrix3d normal = a.transpose() * weight.asDiagonal() * a;
  const Eigen::Matrix3d covariance = normal.inverse();
  const Eigen::Vector3d c = covariance * (a.transpose() * weight.asDiagonal() * y);
  // Newton from the middle; the curve is increasing and nearly straight there.
  double x = 0;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double slope = c(1) + 2 * c(2) * x;
    if (!(slope > 0)) return std::nullopt;
    const double step = (c(0) + c(1) * x + c(2) * x * x - std::numbers::ln2) / slope;
    x -= step;
    if (std::abs(x) > 0.5) return std::nullopt;
    if (std::abs(step) < 1e-13) break;
  }
  const Eigen::Vector3d at(1, x, x * x);
  const double spread = std::sqrt(at.dot(covariance * at));
  return Crossing{x, spread / (c(1) + 2 * c(2) * x)};
}

/// Sizes on demand for one sensor and observer.
class SizeLadder {
 public:
  SizeLadder(const ImageChain& chain, TemplateObserver& observer, TrialConditions conditions,
             const DirectEstimateOptions& options)
      : chain_(chain),
        observer_(observer),
        conditions_(std::move(conditions)),
        options_(options),
        stream_(options.seed, "direct_estimate") {}

  [[nodiscard]] Result<Proportion> proportion(int index, const WhiteNoise& white, double contrast_k, int draws) {
    if (options_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    auto& slot = sizes_[index];
    if (slot == nullptr) {
      const double size = size_of(index);
      auto bank = observer_.bank(size * conditions_.samples_per_pitch, conditions_.samples_per_pitch);
      if (!bank) return tl::unexpected(bank.error());
      slot = std::make_unique<SizeTrial>(chain_, *bank, size, conditions_,
                                         stream_.sub(static_cast<std::uint64_t>(index - smallest_index)));
    }
    return slot->proportion(white, contrast_k, draws);
  }

 private:
  const ImageChain& chain_;
  TemplateObserver& observer_;
  TrialConditions conditions_;
  DirectEstimateOptions options_;
  RandomStream stream_;
  std::map<int, std::unique_ptr<SizeTrial>> sizes_;
};

/// The largest index whose proportion is below 75 % while that of the next is not: the first crossing from above.
Result<int> bracket(SizeLadder& ladder, const WhiteNoise& white, double contrast) {
  int index = 9;  // 2 pitches
  for (;; index += 4) {
    if (index > largest_index) {
      return fail(ErrorCode::invalid_input,
                  fmt::format("at a contrast of {:g} K no size up to {:.0f} pitches is judged 75 % correct", contrast,
                              size_of(largest_index)));
    }
    const auto p = ladder.proportion(index, white, std::abs(contrast), scout_draws);
    if (!p) return tl::unexpected(p.error());
    if (p->mean > 0.8) break;
  }
  for (--index; index >= smallest_index; --index) {
    const auto p = ladder.proportion(index, white, std::abs(contrast), scout_draws);
    if (!p) return tl::unexpected(p.error());
    if (p->mean < 0.75) return index;
  }
  return fail(ErrorCode::invalid_input,
              "even the smallest target is judged correctly: there is no threshold above 0.2 pitch");
}

/// One pass at a number of draws: five sizes around the threshold, moved until it is in their middle.
struct Pass {
  DirectPoint point;
  int centre = 0;
};

Result<Pass> one_pass(SizeLadder& ladder, double contrast, const WhiteNoise& white, const Accuracy& accuracy,
                      int centre, int draws) {
  const double resolution = 0.25 / (draws * accuracy.phases_per_axis);
  for (int attempt = 0; attempt < 4; ++attempt) {
    centre = std::clamp(centre, smallest_index + 2, largest_index - 2);
    DirectPoint point;
    point.delta_t_k = contrast;
    point.noise_draws = draws;
    std::vector<double> xs;
    std::vector<Proportion> ps;
    for (int k = centre - 2; k <= centre + 2; ++k) {
      const auto p = ladder.proportion(k, white, std::abs(contrast), draws);
      if (!p) return tl::unexpected(p.error());
      xs.push_back((k - centre) * std::log(size_step));
      ps.push_back(*p);
      point.sizes_pitch.push_back(size_of(k));
      point.proportion_correct.push_back(p->mean);
    }
    const auto found = crossing(xs, ps, resolution);
    if (!found) break;
    const int move = static_cast<int>(std::lround(found->x / std::log(size_step)));
    if (move != 0 && attempt < 3) {
      centre += std::clamp(move, -3, 3);
      continue;
    }
    point.s75_pitch = size_of(centre) * std::exp(found->x);
    point.standard_error_pitch = point.s75_pitch * found->standard_error;
    return Pass{std::move(point), centre};
  }
  return fail(ErrorCode::invalid_input,
              "the proportion correct does not rise with size near 75 %: the contrast has no threshold");
}

/// Why the asked tolerance cannot be met, what can, and for what.
std::string out_of_reach(double contrast, double asked_percent, double needed_draws, double reachable_percent,
                         double seconds) {
  return fmt::format(
      "a tolerance of {:.3g} % cannot be met at a contrast of {:g} K: a standard error of half of it needs {:.0f} "
      "noise draws per size, the most is {}; the best that is reachable is {:.2g} %, for about {:.1f} s",
      2 * asked_percent, contrast, needed_draws, Accuracy::max_noise_draws, 2 * reachable_percent, seconds);
}

Result<DirectPoint> estimate_contrast(SizeLadder& ladder, double contrast, const WhiteNoise& white,
                                      const Accuracy& accuracy, const std::function<double(double)>& seconds_at) {
  const auto below = bracket(ladder, white, contrast);
  if (!below) return tl::unexpected(below.error());
  int centre = *below, draws = accuracy.noise_draws;
  for (;;) {
    auto pass = one_pass(ladder, contrast, white, accuracy, centre, draws);
    if (!pass) return tl::unexpected(pass.error());
    const double reached = 100 * pass->point.standard_error_pitch / pass->point.s75_pitch;
    const double asked = accuracy.standard_error_percent;
    if (!(asked > 0) || reached <= asked) return std::move(pass->point);
    // The error falls with the square root of the draws; a tenth more, because it is itself an estimate.
    const double needed = 1.1 * draws * std::pow(reached / asked, 2);
    if (needed > 2 * Accuracy::max_noise_draws || draws == Accuracy::max_noise_draws) {
      const double reachable = 1.05 * reached * std::sqrt(draws / double{Accuracy::max_noise_draws});
      return fail(ErrorCode::invalid_input,
                  out_of_reach(contrast, asked, needed, reachable, seconds_at(pass->point.s75_pitch)));
    }
    centre = pass->centre;
    draws = std::min(static_cast<int>(needed) + 1, Accuracy::max_noise_draws);
  }
}

}  // namespace

Result<std::vector<DirectPoint>> direct_estimate(const SensorSpec& spec, const SensorPlan& plan,
                                                 TemplateObserver& observer, const std::vector<double>& delta_t_k,
                                                 const DirectEstimateOptions& options) {
  const ImageChain chain(spec, plan, options.accuracy, options.motion);
  TrialConditions conditions{.sensor = as_planned(spec, plan),
                             .motion = options.motion,
                             .samples_per_pitch = options.samples_per_pitch,
                             .phases_per_axis = options.accuracy.phases_per_axis,
                             .search_step_samples = observer.spec().search_step_samples,
                             .orientations = options.orientations};
  if (options.samples_per_pitch == 0) conditions.samples_per_pitch = conditions.sensor.samples_per_pitch();
  if (conditions.sensor.super_resolution_frames == 0) conditions.sensor.microscan = conditions.samples_per_pitch;
  const SensorSpec sensor = conditions.sensor;
  SizeLadder ladder(chain, observer, std::move(conditions), options);
  const double white_k = std::sqrt(white_variance_k2(sensor, plan, observer.spec().sensor_noise_factor));
  std::vector<DirectPoint> points;
  for (const double contrast : delta_t_k) {
    const double magnitude = std::abs(contrast);
    if (!(magnitude > 0)) return fail(ErrorCode::invalid_input, "a contrast of 0 K has no threshold");
    const WhiteNoise white{.sensor = white_k / magnitude, .internal = observer.spec().internal_noise};
    auto point = estimate_contrast(ladder, contrast, white, options.accuracy, [&](double s75) {
      return predicted_direct_seconds(observer.spec(), sensor, s75, Accuracy::max_noise_draws,
                                      options.accuracy.phases_per_axis);
    });
    if (!point) return tl::unexpected(point.error());
    points.push_back(std::move(*point));
  }
  return points;
}

double predicted_direct_seconds(const TemplateObserverSpec& observer, const SensorSpec& sensor, double s75_pitch,
                                int noise_draws, int phases_per_axis) {
  const double steps = 2 * observer.search_range_samples / observer.search_step_samples + 1;
  const double templates = 4 * steps * steps;
  const double n = sensor.samples_per_pitch();
  const double half = std::ceil(observer.window_size_factor * s75_pitch + observer.window_margin_pitch);
  const double samples = std::pow(2 * half * n, 2);
  const double phases = std::pow(phases_per_axis / n, 2);
  // Building a bank costs as much as sixty of its projections. A draw is projected, and compared at every phase.
  const double per_size = (noise_draws + 60.0) * templates * samples + noise_draws * templates * phases;
  return 5 * per_size * 5e-11;
}

}  // namespace todbench
