#include "sim_devices/prediction/direct_estimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>
#include <optional>

#include "hvs/score_maxima.h"
#include "sim_devices/sensor/image_chain.h"
#include "tod/test_pattern.h"

namespace todbench {
namespace {

constexpr double size_step = 1.08;   ///< sizes are powers of it, so that contrasts share banks and noise
constexpr int smallest_index = -20;  ///< 0.21 pitch
constexpr int largest_index = 48;    ///< 40 pitches
constexpr int scout_draws = 64;

double size_of(int index) {
  return std::pow(size_step, index);
}

/// Proportion correct at one size with its variance.
struct Proportion {
  double mean = 0, variance = 0;
};

/// One size: responses to the signal for every phase, and projected noise, both drawn once and shared by contrasts.
class SizeTrial {
 public:
  SizeTrial(const ImageChain& chain, std::shared_ptr<const TemplateBank> bank, double size_pitch,
            const DirectEstimateOptions& options, RandomStream stream)
      : bank_(std::move(bank)), options_(options), stream_(stream) {
    const cv::Mat1d fine = chain.image(triangle(size_pitch, Apex::up)).fine_image(chain.points_per_pitch());
    const int per_axis = std::max(1, options.accuracy.phases_per_axis / options.samples_per_pitch);
    for (int j = 0; j < per_axis; ++j) {
      for (int i = 0; i < per_axis; ++i) responses_.push_back(response(fine, chain.points_per_pitch(), i, j, per_axis));
    }
  }

  /// Noise per sample relative to the contrast: `white` (temporal, quantisation, internal) and `fixed` (shared by the
  /// samples of a detector).
  [[nodiscard]] Proportion proportion(double white, double fixed, int draws) {
    while (static_cast<int>(noise_.size()) < draws) draw(fixed > 0);
    if (fixed > 0) {
      for (int d = 0; d < draws; ++d) {
        if (patterns_[static_cast<std::size_t>(d)].empty())
          patterns_[static_cast<std::size_t>(d)] = pattern(static_cast<std::uint64_t>(d));
      }
    }
    double sum = 0, squares = 0;
    std::vector<float> mixed(bank_->padded_templates());
    for (int d = 0; d < draws; ++d) {
      const auto& z = noise_[static_cast<std::size_t>(d)];
      std::span<const float> total(z);
      if (fixed > 0) {
        const auto& f = patterns_[static_cast<std::size_t>(d)];
        const auto ratio = static_cast<float>(white > 0 ? fixed / white : 0);
        for (std::size_t t = 0; t < mixed.size(); ++t) mixed[t] = white > 0 ? z[t] + ratio * f[t] : f[t];
        total = mixed;
      }
      const double p = correct_share(total, static_cast<float>(white > 0 ? white : fixed));
      sum += p;
      squares += p * p;
    }
    const double mean = sum / draws;
    return {mean, std::max(0.0, squares / draws - mean * mean) / std::max(1, draws - 1)};
  }

 private:
  [[nodiscard]] std::vector<float> response(const cv::Mat1d& fine, int per_pitch, int i, int j, int per_axis) const {
    const int window = bank_->window_samples();
    const int stride = per_pitch / options_.samples_per_pitch;
    const int n = fine.rows;
    // Window centre relative to the centroid: -1/2 + (i + 1/2) / per_axis samples; samples at k + 1/2 from it.
    const auto first = [&](int phase) { return (2 * phase + 1) * stride / (2 * per_axis) - window / 2 * stride; };
    std::vector<float> patch(static_cast<std::size_t>(window) * static_cast<std::size_t>(window));
    for (int row = 0; row < window; ++row) {
      const int y = ((first(j) + row * stride) % n + n) % n;
      for (int column = 0; column < window; ++column) {
        const int x = ((first(i) + column * stride) % n + n) % n;
        patch[static_cast<std::size_t>(row * window + column)] = static_cast<float>(fine(y, x));
      }
    }
    std::vector<float> scores(bank_->padded_templates());
    bank_->project(patch, scores);
    return scores;
  }

  void draw(bool with_pattern) {
    const auto window = static_cast<std::size_t>(bank_->window_samples());
    const auto index = static_cast<std::uint64_t>(noise_.size());
    std::vector<float> samples(window * window);
    stream_.sub(2 * index).fill_normal(samples);
    noise_.emplace_back(bank_->padded_templates());
    bank_->project(samples, noise_.back());
    patterns_.push_back(with_pattern ? pattern(index) : std::vector<float>{});
  }

  [[nodiscard]] std::vector<float> pattern(std::uint64_t index) const {
    const int window = bank_->window_samples();
    const int detectors = window / options_.samples_per_pitch;
    std::vector<float> offsets(static_cast<std::size_t>(detectors) * static_cast<std::size_t>(detectors));
    stream_.sub(2 * index + 1).fill_normal(offsets);
    std::vector<float> samples(static_cast<std::size_t>(window) * static_cast<std::size_t>(window));
    for (int row = 0; row < window; ++row) {
      for (int column = 0; column < window; ++column) {
        samples[static_cast<std::size_t>(row * window + column)] = offsets[static_cast<std::size_t>(
            row / options_.samples_per_pitch * detectors + column / options_.samples_per_pitch)];
      }
    }
    std::vector<float> scores(bank_->padded_templates());
    bank_->project(samples, scores);
    return scores;
  }

  /// Share of the phases at which the true alternative (the first) wins; a tie counts its fair part.
  [[nodiscard]] double correct_share(std::span<const float> noise, float scale) const {
    float maxima[Choice::max_alternatives];
    const std::span<float> tops(maxima, static_cast<std::size_t>(bank_->alternatives()));
    double correct = 0;
    for (const auto& signal : responses_) {
      score_maxima(signal, noise, scale, bank_->places(), tops);
      const float best = *std::max_element(tops.begin(), tops.end());
      if (tops[0] == best) correct += 1.0 / static_cast<double>(std::count(tops.begin(), tops.end(), best));
    }
    return correct / static_cast<double>(responses_.size());
  }

  std::shared_ptr<const TemplateBank> bank_;
  DirectEstimateOptions options_;
  RandomStream stream_;
  std::vector<std::vector<float>> responses_;  ///< per phase
  std::vector<std::vector<float>> noise_;      ///< per draw, unit white noise projected
  std::vector<std::vector<float>> patterns_;   ///< per draw, unit fixed pattern projected; empty until needed
};

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
  SizeLadder(const ImageChain& chain, TemplateObserver& observer, const DirectEstimateOptions& options)
      : chain_(chain), observer_(observer), options_(options), stream_(options.seed, "direct_estimate") {}

  [[nodiscard]] Result<Proportion> proportion(int index, double white, double fixed, int draws) {
    if (options_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    auto& slot = sizes_[index];
    if (slot == nullptr) {
      const double size = size_of(index);
      auto bank = observer_.bank(size * options_.samples_per_pitch, options_.samples_per_pitch);
      if (!bank) return tl::unexpected(bank.error());
      slot = std::make_unique<SizeTrial>(chain_, *bank, size, options_,
                                         stream_.sub(static_cast<std::uint64_t>(index - smallest_index)));
    }
    return slot->proportion(white, fixed, draws);
  }

 private:
  const ImageChain& chain_;
  TemplateObserver& observer_;
  DirectEstimateOptions options_;
  RandomStream stream_;
  std::map<int, std::unique_ptr<SizeTrial>> sizes_;
};

/// The largest index whose proportion is below 75 % while that of the next is not: the first crossing from above.
Result<int> bracket(SizeLadder& ladder, double white, double fixed, double contrast) {
  int index = 9;  // 2 pitches
  for (;; index += 4) {
    if (index > largest_index) {
      char text[128];
      std::snprintf(text, sizeof text, "at a contrast of %g K no size up to %.0f pitches is judged 75 %% correct",
                    contrast, size_of(largest_index));
      return fail(ErrorCode::invalid_input, text);
    }
    const auto p = ladder.proportion(index, white, fixed, scout_draws);
    if (!p) return tl::unexpected(p.error());
    if (p->mean > 0.8) break;
  }
  for (--index; index >= smallest_index; --index) {
    const auto p = ladder.proportion(index, white, fixed, scout_draws);
    if (!p) return tl::unexpected(p.error());
    if (p->mean < 0.75) return index;
  }
  return fail(ErrorCode::invalid_input,
              "even the smallest target is judged correctly: there is no threshold above 0.2 pitch");
}

Result<DirectPoint> estimate_contrast(SizeLadder& ladder, double contrast, double white, double fixed,
                                      const Accuracy& accuracy) {
  const auto below = bracket(ladder, white, fixed, contrast);
  if (!below) return tl::unexpected(below.error());
  int centre = *below;
  const double resolution = 0.25 / (accuracy.noise_draws * accuracy.phases_per_axis);
  for (int attempt = 0; attempt < 4; ++attempt) {
    centre = std::clamp(centre, smallest_index + 2, largest_index - 2);
    DirectPoint point;
    point.delta_t_k = contrast;
    std::vector<double> xs;
    std::vector<Proportion> ps;
    for (int k = centre - 2; k <= centre + 2; ++k) {
      const auto p = ladder.proportion(k, white, fixed, accuracy.noise_draws);
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
    return point;
  }
  return fail(ErrorCode::invalid_input,
              "the proportion correct does not rise with size near 75 %: the contrast has no threshold");
}

}  // namespace

Result<std::vector<DirectPoint>> direct_estimate(const SensorSpec& spec, const SensorPlan& plan,
                                                 TemplateObserver& observer, const std::vector<double>& delta_t_k,
                                                 const DirectEstimateOptions& options) {
  const ImageChain chain(spec, plan, options.accuracy);
  SizeLadder ladder(chain, observer, options);
  const double netd = plan.simulates(Effect::temporal_noise) ? spec.netd_k * observer.spec().sensor_noise_factor : 0;
  const double step = plan.simulates(Effect::quantisation) ? spec.kelvin_per_count : 0;
  const double fixed_k = plan.simulates(Effect::fixed_pattern) ? spec.fixed_pattern_k : 0;
  std::vector<DirectPoint> points;
  for (const double contrast : delta_t_k) {
    const double magnitude = std::abs(contrast);
    if (!(magnitude > 0)) return fail(ErrorCode::invalid_input, "a contrast of 0 K has no threshold");
    const double white = std::sqrt((netd * netd + step * step / 12) / (magnitude * magnitude) +
                                   observer.spec().internal_noise * observer.spec().internal_noise);
    auto point = estimate_contrast(ladder, contrast, white, fixed_k / magnitude, options.accuracy);
    if (!point) return tl::unexpected(point.error());
    points.push_back(std::move(*point));
  }
  return points;
}

}  // namespace todbench
