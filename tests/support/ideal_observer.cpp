// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/ideal_observer.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace todbench {
namespace {

constexpr int phases_per_sample = 16;

class PreparedIdealObserver final : public PreparedObserver {
 public:
  PreparedIdealObserver(std::vector<cv::Mat1d> fine, int window) : fine_(std::move(fine)), window_(window) {}

  [[nodiscard]] int window_samples() const override { return window_; }
  [[nodiscard]] double search_samples() const override { return 0; }

  [[nodiscard]] Choice choose(const Patch& patch, double contrast_k, const RandomStream& noise) const override {
    CV_Assert(patch.kelvin.rows == window_ && patch.kelvin.cols == window_);
    const int dx = static_cast<int>(std::lround(patch.phase.x * phases_per_sample));
    const int dy = static_cast<int>(std::lround(patch.phase.y * phases_per_sample));
    const double background = patch.kelvin(0, 0);
    Choice choice;
    choice.alternatives = static_cast<int>(fine_.size());
    int best = 0;
    for (int o = 0; o < choice.alternatives; ++o) {
      choice.scores[static_cast<std::size_t>(o)] = log_likelihood(o, patch.kelvin, background, contrast_k, dx, dy);
      const double ahead = choice.scores[static_cast<std::size_t>(o)] - choice.scores[static_cast<std::size_t>(best)];
      if (ahead > 0 || (ahead == 0 && o > 0 && noise.uniform(static_cast<std::uint64_t>(o)) < 1.0 / (o + 1))) best = o;
    }
    choice.alternative = best;
    return choice;
  }

  /// This observer adds no noise: the best alternatives share the answer.
  [[nodiscard]] GradedChoice judge(const Patch& patch, double contrast_k, const RandomStream& noise,
                                   int /*draws*/) const override {
    GradedChoice out{.choice = choose(patch, contrast_k, noise), .answers = {}};
    const auto end = out.choice.scores.begin() + out.choice.alternatives;
    const double top = *std::max_element(out.choice.scores.begin(), end);
    const auto best = std::count(out.choice.scores.begin(), end, top);
    for (std::size_t o = 0; o < static_cast<std::size_t>(out.choice.alternatives); ++o)
      out.answers.probability[o] = out.choice.scores[o] == top ? 1 / static_cast<double>(best) : 0;
    return out;
  }

 private:
  /// <g, t> - |t|^2 / 2 with the means over the window removed (the background is not known), g in units of the
  /// contrast.
  [[nodiscard]] double log_likelihood(int o, const cv::Mat1d& kelvin, double background, double contrast_k, int dx,
                                      int dy) const {
    const cv::Mat1d& fine = fine_[static_cast<std::size_t>(o)];
    const int n = fine.rows;
    const int half = window_ / 2;
    double gt = 0, tt = 0, g_sum = 0, t_sum = 0;
    for (int j = 0; j < window_; ++j) {
      const int y = (((2 * (j - half) + 1) * phases_per_sample / 2 - dy) % n + n) % n;
      for (int i = 0; i < window_; ++i) {
        const int x = (((2 * (i - half) + 1) * phases_per_sample / 2 - dx) % n + n) % n;
        const double t = fine(y, x);
        const double g = (kelvin(j, i) - background) / contrast_k;
        gt += g * t;
        tt += t * t;
        g_sum += g;
        t_sum += t;
      }
    }
    const double count = static_cast<double>(window_) * window_;
    return gt - g_sum * t_sum / count - (tt - t_sum * t_sum / count) / 2;
  }

  std::vector<cv::Mat1d> fine_;
  int window_;
};

}  // namespace

IdealObserver::IdealObserver(std::string name, Alternatives alternatives, TransferFunction filter,
                             double band_per_sample)
    : name_(std::move(name)),
      alternatives_(std::move(alternatives)),
      filter_(std::move(filter)),
      band_per_sample_(band_per_sample) {
  CV_Assert(alternatives_.size() >= 2 && alternatives_.size() <= Choice::max_alternatives &&
            band_per_sample_ < phases_per_sample / 2.0);
}

Result<std::shared_ptr<const PreparedObserver>> IdealObserver::prepare(double size_samples, int /*samples_per_pitch*/) {
  if (!(size_samples > 0 && size_samples < 200)) {
    return fail(ErrorCode::invalid_input,
                "observer " + name_ + ": the target size must be above 0 and below 200 samples");
  }
  const std::scoped_lock lock(mutex_);
  auto& slot = prepared_[size_samples];
  if (slot == nullptr) {
    const int half = static_cast<int>(std::ceil(0.9 * size_samples + 2));
    const int period = 2 * half + 4;
    const FilterTable filter({.period = period, .band = static_cast<int>(std::floor(band_per_sample_ * period))},
                             filter_);
    std::vector<cv::Mat1d> fine;
    for (const auto& shape : alternatives_) {
      fine.push_back(PolygonImage(placed(shape, size_samples, {0, 0}), filter).fine_image(phases_per_sample));
    }
    slot = std::make_shared<const PreparedIdealObserver>(std::move(fine), 2 * half);
  }
  return slot;
}

}  // namespace todbench
