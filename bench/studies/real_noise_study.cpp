// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/real_noise_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "hvs/observer/share_won.h"
#include "sim_devices/sensor/image_chain.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double size_step = 1.08;
constexpr int smallest_index = -16, largest_index = 40;  ///< 0.29 to 21.7 pitches
constexpr int phases_per_axis = 4;
constexpr int alternatives = 4;

/// Proportion correct of each block (or part of the picture), with its number of windows.
struct BlockProportions {
  std::vector<double> correct, total;
  [[nodiscard]] double without(std::size_t left_out) const {
    double c = 0, n = 0;
    for (std::size_t b = 0; b < correct.size(); ++b) {
      if (b == left_out) continue;
      c += correct[b], n += total[b];
    }
    return n > 0 ? c / n : 0;
  }
  [[nodiscard]] double mean() const { return without(correct.size()); }
};

/// ln((P - 0.25) / (1 - P)): ln 2 at 75 %, nearly straight in ln size.
double transformed(double p) {
  const double inside = std::clamp(p, 0.2501, 0.9999);
  return std::log((inside - 0.25) / (1 - inside));
}

/// A window of noise: its scores, its block, and the observer's internal noise for it.
struct Draw {
  std::vector<float> noise, internal;
  std::size_t block = 0;
};

/// One size under one noise.
class SizeStudy {
 public:
  SizeStudy(const ImageChain& chain, std::shared_ptr<const TemplateBank> bank, double size_pitch)
      : bank_(std::move(bank)) {
    for (int apex = 0; apex < alternatives; ++apex) {
      const auto image = chain.image(triangle(size_pitch, static_cast<Apex>(apex)));
      for (int p = 0; p < phases_per_axis * phases_per_axis; ++p) responses_[apex].push_back(response(image, p));
    }
  }

  /// Draws windows at equal distances in the list of all windows side by side in the frames.
  void draw(const RecordedNoise& noise, const RealNoiseOptions& options, std::uint64_t index) {
    const int side = bank_->window_samples();
    const auto corners = usable_corners(noise, side);
    const std::size_t all = corners.size() * noise.frames.size();
    const auto wanted = std::min(all, static_cast<std::size_t>(options.draws));
    const RandomStream stream = RandomStream(options.seed, "real_noise.internal").sub(index);
    blocks_ = noise.blocks >= 4 ? static_cast<std::size_t>(noise.blocks) : 16;
    for (std::size_t d = 0; d < wanted; ++d) {
      const std::size_t which = d * all / wanted;
      const std::size_t frame = which / corners.size();
      const cv::Point corner = corners[which % corners.size()];
      Draw draw;
      draw.block = noise.blocks >= 4 ? static_cast<std::size_t>(noise.block_of_frame[frame])
                                     : static_cast<std::size_t>(4 * (4 * corner.y / noise.frames[0].rows) +
                                                                4 * corner.x / noise.frames[0].cols);
      cv::Mat1f window = noise.frames[frame](cv::Rect(corner, cv::Size(side, side))).clone() / noise.temporal_noise;
      draw.noise.resize(bank_->padded_templates());
      bank_->project(std::span(window.ptr<float>(), window.total()), draw.noise);
      stream.sub(d).fill_normal(std::span(window.ptr<float>(), window.total()));
      draw.internal.resize(bank_->padded_templates());
      bank_->project(std::span(window.ptr<float>(), window.total()), draw.internal);
      draws_.push_back(std::move(draw));
    }
  }

  [[nodiscard]] bool drawn() const { return !draws_.empty(); }

  /// `noise` and `internal`: standard deviations relative to the contrast.
  [[nodiscard]] BlockProportions proportions(double noise, double internal) const {
    BlockProportions result{std::vector<double>(blocks_, 0.0), std::vector<double>(blocks_, 0.0)};
    std::vector<float> mixed(bank_->padded_templates());
    for (const auto& draw : draws_) {
      for (std::size_t i = 0; i < mixed.size(); ++i) {
        mixed[i] = static_cast<float>(noise) * draw.noise[i] + static_cast<float>(internal) * draw.internal[i];
      }
      for (std::size_t apex = 0; apex < alternatives; ++apex) {
        for (const auto& signal : responses_[apex]) {
          result.correct[draw.block] +=
              share_won(signal, mixed, 1.0F, bank_->places(), alternatives, static_cast<int>(apex));
          result.total[draw.block] += 1;
        }
      }
    }
    return result;
  }

  /// Mean variance of the differences between central templates.
  [[nodiscard]] double template_variance() const {
    double sum = 0, n = 0;
    const auto places = static_cast<std::size_t>(bank_->places());
    const auto centre = static_cast<std::size_t>(bank_->central_place());
    for (const auto& draw : draws_) {
      for (std::size_t a = 0; a < alternatives; ++a) {
        for (std::size_t b = a + 1; b < alternatives; ++b) {
          sum += std::pow(static_cast<double>(draw.noise[a * places + centre] - draw.noise[b * places + centre]), 2);
          n += 1;
        }
      }
    }
    return sum / n;
  }

  [[nodiscard]] const TemplateBank& bank() const { return *bank_; }

 private:
  [[nodiscard]] std::vector<float> response(const PolygonImage& image, int phase) const {
    const int side = bank_->window_samples();
    const auto first = [&](int p) { return -0.5 + (p + 0.5) / phases_per_axis - 0.5 * side + 0.5; };
    const cv::Mat1d values =
        image.sample({first(phase % phases_per_axis), first(phase / phases_per_axis)}, 1.0, {side, side});
    cv::Mat1f patch;
    values.convertTo(patch, CV_32F);
    std::vector<float> scores(bank_->padded_templates());
    bank_->project(std::span(patch.ptr<float>(), patch.total()), scores);
    return scores;
  }

  [[nodiscard]] static std::vector<cv::Point> usable_corners(const RecordedNoise& noise, int side) {
    std::vector<cv::Point> corners;
    for (int y = 0; y + side <= noise.usable.rows; y += side) {
      for (int x = 0; x + side <= noise.usable.cols; x += side) {
        if (cv::countNonZero(noise.usable(cv::Rect(x, y, side, side))) == side * side) corners.emplace_back(x, y);
      }
    }
    return corners;
  }

  std::shared_ptr<const TemplateBank> bank_;
  std::array<std::vector<std::vector<float>>, alternatives> responses_;
  std::vector<Draw> draws_;
  std::size_t blocks_ = 0;
};

/// All sizes under one noise.
class Ladder {
 public:
  Ladder(const RecordedNoise& noise, const ImageChain& chain, TemplateObserver& observer,
         const RealNoiseOptions& options)
      : noise_(noise), chain_(chain), observer_(observer), options_(options) {}

  [[nodiscard]] Result<const SizeStudy*> size(int index) {
    if (options_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    auto& slot = sizes_[index];
    if (slot == nullptr) {
      const double size_pitch = std::pow(size_step, index);
      TODBENCH_TRY(auto bank, observer_.bank(size_pitch, 1));
      slot = std::make_unique<SizeStudy>(chain_, bank, size_pitch);
      slot->draw(noise_, options_, static_cast<std::uint64_t>(index - smallest_index));
    }
    if (!slot->drawn())
      return fail(ErrorCode::invalid_input, "every window of this size in the recording contains excluded pixels");
    return slot.get();
  }

  /// Crossing of P = 75 %, the first from above, linear between neighbouring sizes.
  [[nodiscard]] Result<SizeEstimate> s75(double noise, double internal) {
    std::optional<BlockProportions> above;
    for (int index = 10; index <= largest_index; index += 5) {
      TODBENCH_TRY(auto study, size(index));
      auto p = study->proportions(noise, internal);
      if (p.mean() < 0.8) continue;
      above = std::move(p);
      for (int below = index - 1; below >= smallest_index; --below) {
        TODBENCH_TRY(auto next, size(below));
        auto q = next->proportions(noise, internal);
        if (q.mean() < 0.75) return crossing(below, q, *above);
        above = std::move(q);
      }
      break;
    }
    return fail(ErrorCode::invalid_input, "at this contrast there is no threshold between 0.3 and 21 pitches");
  }

 private:
  static SizeEstimate crossing(int index, const BlockProportions& low, const BlockProportions& high) {
    const auto ln_size = [&](std::size_t left_out) {
      const double a = transformed(low.without(left_out)), b = transformed(high.without(left_out));
      return std::log(size_step) * (index + (std::numbers::ln2 - a) / std::max(b - a, 1e-6));
    };
    const std::size_t blocks = low.correct.size();
    const double whole = ln_size(blocks);
    std::vector<double> parts;
    for (std::size_t b = 0; b < blocks; ++b) {
      if (low.total[b] > 0 && high.total[b] > 0) parts.push_back(ln_size(b));
    }
    double mean = 0, squares = 0;
    for (const double part : parts) mean += part / static_cast<double>(parts.size());
    for (const double part : parts) squares += (part - mean) * (part - mean);
    const auto n = static_cast<double>(parts.size());
    return {std::exp(whole), std::sqrt(squares * (n - 1) / n)};
  }

  const RecordedNoise& noise_;
  const ImageChain& chain_;
  TemplateObserver& observer_;
  RealNoiseOptions options_;
  std::map<int, std::unique_ptr<SizeStudy>> sizes_;
};

/// Uses row and column sums of the template differences: the effect of common row and column noise on the decisions.
void explain(NoiseAcuity& point, const TemplateBank& bank, const ThreeDNoise& c) {
  double norm = 0, rows = 0, columns = 0;
  for (int a = 0; a < alternatives; ++a) {
    for (int b = a + 1; b < alternatives; ++b) {
      const cv::Mat1f difference = bank.image(a, bank.central_place()) - bank.image(b, bank.central_place());
      cv::Mat1f row_sums, column_sums;
      cv::reduce(difference, row_sums, 1, cv::REDUCE_SUM);
      cv::reduce(difference, column_sums, 0, cv::REDUCE_SUM);
      norm += cv::norm(difference, cv::NORM_L2SQR);
      rows += cv::norm(row_sums, cv::NORM_L2SQR);
      columns += cv::norm(column_sums, cv::NORM_L2SQR);
    }
  }
  const double total = c.temporal() * c.temporal();
  point.pixel_share = c.tvh * c.tvh / total;
  point.row_share = c.tv * c.tv / total * rows / norm;
  point.column_share = c.th * c.th / total * columns / norm;
  point.correlated_share = point.template_noise_ratio * point.template_noise_ratio - point.pixel_share -
                           point.row_share - point.column_share;
}

int nearest_index(double size_pitch) {
  return std::clamp(static_cast<int>(std::lround(std::log(size_pitch) / std::log(size_step))), smallest_index,
                    largest_index);
}

}  // namespace

Result<std::vector<NoiseAcuity>> real_noise_study(const RecordedNoise& noise, const SensorSpec& sensor,
                                                  TemplateObserver& observer, const RealNoiseOptions& options) {
  const ImageChain chain(sensor, full_plan(sensor, {}, {}), Accuracy::normal());
  const RecordedNoise white_noise = white_like(noise, options.seed);
  Ladder real(noise, chain, observer, options), white(white_noise, chain, observer, options);
  const auto& spec = observer.spec();
  std::vector<NoiseAcuity> points;
  for (const double contrast : options.contrast_over_noise) {
    if (!(contrast > 0)) return fail(ErrorCode::invalid_input, "a contrast of 0 has no threshold");
    NoiseAcuity point;
    point.contrast_over_noise = contrast;
    const double q = 1 / contrast;
    // An observer of limited efficiency adds white noise in proportion to the sensor's.
    const double internal =
        std::hypot(spec.internal_noise, q * std::sqrt(spec.sensor_noise_factor * spec.sensor_noise_factor - 1));
    TODBENCH_TRY(const auto under_real, real.s75(q, internal));
    TODBENCH_TRY(const auto under_white, white.s75(q, internal));
    point.real = under_real;
    point.white = under_white;
    point.acuity_ratio = under_white.s75_pitch / under_real.s75_pitch;
    const double clusters = noise.blocks >= 4 ? noise.blocks : 16;
    const double reach = distribution::quantile(distribution::StudentsT(clusters - 1), 0.975) *
                         std::hypot(point.real.se_ln, point.white.se_ln);
    point.ratio_ci95 = {point.acuity_ratio * std::exp(-reach), point.acuity_ratio * std::exp(reach)};
    const int index = nearest_index(point.real.s75_pitch);
    const auto real_size = real.size(index), white_size = white.size(index);
    if (!real_size) return tl::unexpected(real_size.error());
    if (!white_size) return tl::unexpected(white_size.error());
    point.template_noise_ratio = std::sqrt((*real_size)->template_variance() / (*white_size)->template_variance());
    TODBENCH_TRY(const auto predicted, white.s75(q * point.template_noise_ratio, internal));
    point.predicted_ratio = under_white.s75_pitch / predicted.s75_pitch;
    if (const auto whole = white.s75(q * options.whole_to_successive, internal); whole)
      point.memory_acuity_ratio = under_white.s75_pitch / whole->s75_pitch;
    else if (whole.error().code == ErrorCode::interrupted)
      return tl::unexpected(whole.error());
    explain(point, (*real_size)->bank(), noise.components);
    points.push_back(point);
  }
  return points;
}

}  // namespace todbench
