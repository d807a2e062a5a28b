// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/run_constancy.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/mean.h"

namespace todbench {
namespace {

/// The triangles of one set-up relative to the set contrast: 1 if the camera shows that contrast.
struct SetUpTransfer {
  std::vector<double> triangles;
  double span_k = 0;  ///< between the contrasts; of a single one: that contrast
  bool of_one_contrast = false;
};

bool same_places(const ContrastMeasurement& a, const ContrastMeasurement& b) {
  return std::ranges::equal(a.references, b.references, [](const ReferenceTriangle& one, const ReferenceTriangle& two) {
    return cv::norm(one.place_px - two.place_px) < 0.5 * std::min(one.size_px, two.size_px);
  });
}

SetUpTransfer transfer_of(std::span<const ContrastMeasurement> set_up) {
  const auto size = [](const ContrastMeasurement& one) { return std::abs(one.set_delta_t_k); };
  const ContrastMeasurement& largest = *std::ranges::max_element(set_up, {}, size);
  const ContrastMeasurement& other = *std::ranges::max_element(
      set_up, {}, [&](const ContrastMeasurement& one) { return std::abs(one.set_delta_t_k - largest.set_delta_t_k); });
  const bool of_one = other.set_delta_t_k == largest.set_delta_t_k;
  const double set_k = largest.set_delta_t_k - (of_one ? 0 : other.set_delta_t_k);
  SetUpTransfer out{.triangles = {}, .span_k = std::abs(set_k), .of_one_contrast = of_one};
  for (std::size_t i = 0; i < largest.references.size(); ++i) {
    const double seen_k = largest.references[i].value - (of_one ? 0 : other.references[i].value);
    out.triangles.push_back(seen_k / set_k);
  }
  return out;
}

/// A set-up ends when the places of its triangles change or one of its contrasts recurs.
std::vector<SetUpTransfer> transfers(std::span<const ContrastMeasurement> all) {
  std::vector<SetUpTransfer> out;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin + 1;
    const auto seen = [&](double set_k) {
      return std::ranges::any_of(all.subspan(begin, end - begin),
                                 [&](const ContrastMeasurement& one) { return one.set_delta_t_k == set_k; });
    };
    while (end < all.size() && same_places(all[begin], all[end]) && !seen(all[end].set_delta_t_k)) ++end;
    if (!all[begin].references.empty()) out.push_back(transfer_of(all.subspan(begin, end - begin)));
    begin = end;
  }
  // Set-ups with small contrasts only hardly determine the gain, and their pattern is relatively large.
  double largest_k = 0;
  for (const SetUpTransfer& one : out) largest_k = std::max(largest_k, one.span_k);
  std::erase_if(out, [&](const SetUpTransfer& one) { return one.span_k < 0.5 * largest_k; });
  return out;
}

/// Mean of the set-ups' means, and the variance factor of each part of the error.
struct Group {
  double mean = 0;
  double of_triangles = 0;  ///< sum of 1/n over the set-ups, over their number squared
  double of_shared = 0;     ///< the same for the part common to the triangles of a set-up
};

Group group_of(std::span<const SetUpTransfer> set_ups) {
  Group out;
  const auto count = static_cast<double>(set_ups.size());
  for (const SetUpTransfer& one : set_ups) {
    out.mean += arithmetic_mean(one.triangles) / count;
    out.of_triangles += 1 / static_cast<double>(one.triangles.size()) / (count * count);
    out.of_shared += one.of_one_contrast ? 1 / (count * count) : 0;
  }
  return out;
}

/// Relative variance of the mean square of differences at a lag, for one independent sample per frame. Differences of
/// white noise that share a frame have a correlation of -1/2.
double variance_at_lag(int frames, int lag) {
  const double pairs = std::max(1, frames - lag);
  return (2 * pairs + std::max(0.0, pairs - lag)) / (pairs * pairs);
}

/// Relative variance of the ratio of the mean squares that gives the lag-1 correlation, likewise.
double variance_of_ratio(int frames) {
  const int lag = std::clamp(frames / 4, 2, 8);
  const double pairs = std::max(1, frames - lag), successive = std::max(1, frames - 1);
  const double common = (2 * pairs - 1) / (pairs * successive);
  return variance_at_lag(frames, 1) + variance_at_lag(frames, lag) - 2 * common;
}

double per_sample(const PictureNoise& one) {
  const double lines = std::max(1, one.lines);
  return (1 + 1 / lines) / (4 * lines);
}

/// Part of the limit that comes from the contrasts by which the noise of two averages was divided.
double limit_of_contrasts(std::span<const PictureNoise> noise, const PictureNoise& first, const PictureNoise& later) {
  if (first.triangles < 2 || later.triangles < 2) return 0;
  double squares = 0, freedom = 0;
  for (const PictureNoise& one : noise) {
    if (one.set_delta_t_k != first.set_delta_t_k || one.triangles < 2) continue;
    squares += (one.triangles - 1) * one.triangle_scatter * one.triangle_scatter;
    freedom += one.triangles - 1;
  }
  const double variance = squares / freedom * (2 + 1.0 / first.triangles + 1.0 / later.triangles);
  const double tail = transfer_false_alarm / 2 / static_cast<double>(noise.size());
  return distribution::quantile_above(tail, freedom) * std::hypot(std::sqrt(variance), transfer_systematic_u);
}

/// Keeps the figure that is larger relative to its limit.
void keep_larger(std::optional<ConstancyFigure>& worst, const ConstancyFigure& figure) {
  if (!worst || std::abs(figure.value) * worst->limit > std::abs(worst->value) * figure.limit) worst = figure;
}

/// The change that is largest relative to its limit.
template <typename Change>
std::optional<ConstancyFigure> largest_change(std::span<const PictureNoise> noise, Change change_of) {
  std::optional<ConstancyFigure> found;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const auto same = [&](const PictureNoise& one) { return one.set_delta_t_k == noise[i].set_delta_t_k; };
    if (std::any_of(noise.begin(), noise.begin() + static_cast<std::ptrdiff_t>(i), same)) continue;
    for (std::size_t later = i + 1; later < noise.size(); ++later) {
      if (!same(noise[later])) continue;
      if (const std::optional<ConstancyFigure> change = change_of(noise[i], noise[later])) keep_larger(found, *change);
    }
  }
  return found;
}

/// Noise with memory is in both the previous picture and the first frame: over all unchanged pixels it would look like
/// a residue.
constexpr double changed = 4;
constexpr double residue_errors = 5, most_residue_error = 0.05;

/// Returns the direction from a picture to the previous one, in the pixels that changed.
cv::Mat1d direction_to(const cv::Mat1d& before, const cv::Mat1d& mean, double noise) {
  const cv::Mat1d old = before - mean;
  cv::Mat1d direction = old - cv::mean(old)[0];
  direction.setTo(0, cv::abs(direction) < changed * noise);
  return direction;
}

/// Returns the median over the pixels of their standard deviation in time.
double median_deviation(std::span<const cv::Mat1w> pictures, const cv::Mat1d& mean) {
  cv::Mat1d squares = cv::Mat1d::zeros(mean.size());
  for (const cv::Mat1w& picture : pictures) {
    cv::Mat1d change;
    picture.convertTo(change, CV_64F);
    change -= mean;
    squares += change.mul(change);
  }
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.total() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle / static_cast<double>(pictures.size() - 1));
}

}  // namespace

std::optional<ConstancyFigure> transfer_change(std::span<const ContrastMeasurement> measurements) {
  const std::vector<SetUpTransfer> set_ups = transfers(measurements);
  double squares = 0, freedom = 0;
  for (const SetUpTransfer& one : set_ups) {
    const double mean = arithmetic_mean(one.triangles);
    for (const double value : one.triangles) squares += (value - mean) * (value - mean);
    freedom += static_cast<double>(one.triangles.size()) - 1;
  }
  if (set_ups.size() < 2 || freedom < 1) return std::nullopt;
  const double variance = squares / freedom;
  const double tail = transfer_false_alarm / 2 / static_cast<double>(set_ups.size() - 1);
  const double quantile = distribution::quantile_above(tail, freedom);
  std::optional<ConstancyFigure> worst;
  for (std::size_t first = 1; first < set_ups.size(); ++first) {
    const Group before = group_of(std::span(set_ups).first(first)), after = group_of(std::span(set_ups).subspan(first));
    if (!(std::abs(before.mean) > 0)) continue;
    const double of_scatter =
        std::sqrt(variance * (before.of_triangles + after.of_triangles + before.of_shared + after.of_shared));
    const ConstancyFigure figure{after.mean / before.mean - 1,
                                 quantile * std::hypot(of_scatter / before.mean, transfer_systematic_u)};
    keep_larger(worst, figure);
  }
  return worst;
}

std::optional<ConstancyFigure> noise_change(std::span<const PictureNoise> noise) {
  const auto variance = [](const PictureNoise& one) { return variance_at_lag(one.frames, 1) * per_sample(one) / 4; };
  return largest_change(
      noise, [&](const PictureNoise& first, const PictureNoise& later) -> std::optional<ConstancyFigure> {
        if (!(first.noise_k > 0 && later.noise_k > 0)) return std::nullopt;
        const double error = std::sqrt(variance(first) + variance(later));
        const double limit = std::hypot(constancy_errors * error, limit_of_contrasts(noise, first, later));
        return ConstancyFigure{std::log(later.noise_k / first.noise_k), std::max(most_noise_change, limit)};
      });
}

std::optional<ConstancyFigure> presented_change(std::span<const PresentedContrast> presented) {
  std::optional<ConstancyFigure> worst;
  for (const PresentedContrast& one : presented) {
    if (one.presentations == 0 || one.measured == 0) continue;
    const double count = one.presentations, shared = one.shared / count;
    const double error = one.errors / count * std::sqrt(shared + (1 - shared) / count);
    const double relative = std::hypot(error, one.measured_error) / std::abs(one.measured);
    const ConstancyFigure figure{one.sum / count / one.measured - 1,
                                 std::hypot(constancy_errors * relative, most_presented_change)};
    keep_larger(worst, figure);
  }
  return worst;
}

std::optional<ConstancyFigure> correlation_change(std::span<const PictureNoise> noise) {
  const auto variance = [](const PictureNoise& one) { return variance_of_ratio(one.frames) * per_sample(one); };
  return largest_change(noise,
                        [&](const PictureNoise& first, const PictureNoise& later) -> std::optional<ConstancyFigure> {
                          if (!first.lag1_correlation || !later.lag1_correlation) return std::nullopt;
                          const double error = std::sqrt(variance(first) + variance(later));
                          return ConstancyFigure{*later.lag1_correlation - *first.lag1_correlation,
                                                 std::max(most_correlation_change, constancy_errors * error)};
                        });
}

std::optional<PictureResidue> judged_residue(const cv::Mat1d& before, std::span<const cv::Mat1w> pictures,
                                             const cv::Mat1d& mean) {
  if (before.empty() || pictures.size() < 8 || mean.size() != before.size()) return std::nullopt;
  const double noise = median_deviation(pictures, mean);
  const cv::Mat1d direction = direction_to(before, mean, noise);
  const double squares = direction.dot(direction);
  const double error = squares > 0 ? noise * std::sqrt(2 / squares) : INFINITY;
  if (!(error < most_residue_error)) return std::nullopt;
  // The direction has a mean of zero only before small changes are removed from it.
  const cv::Mat1d weights = direction - cv::mean(direction)[0];
  std::vector<double> shares;
  for (const cv::Mat1w& picture : pictures) shares.push_back(weights.dot(cv::Mat1d(picture)) / squares);
  const std::span<const double> late = std::span<const double>(shares).subspan(shares.size() / 2);
  const double rest = arithmetic_mean(late);
  double scatter = 0;
  for (const double share : late) scatter += (share - rest) * (share - rest) / static_cast<double>(late.size() - 1);
  return PictureResidue{shares.front() - rest,
                        std::max(least_residue_share, residue_errors * std::hypot(error, std::sqrt(scatter))), true};
}

std::optional<PictureResidue> picture_residue(const cv::Mat1d& before, const cv::Mat1d& first, const cv::Mat1d& last,
                                              const cv::Mat1d& mean, double noise_k) {
  if (before.size() != mean.size()) return std::nullopt;
  // The change of a whole frame is an offset of the camera.
  const cv::Mat1d both = first - last;
  const cv::Mat1d change = both - cv::mean(both)[0];
  const cv::Mat1d direction = direction_to(before, mean, noise_k);
  const double squares = direction.dot(direction);
  const double error = squares > 0 ? noise_k * std::sqrt(2 / squares) : INFINITY;
  if (!(error < most_residue_error)) return std::nullopt;
  return PictureResidue{direction.dot(change) / squares, std::max(least_residue_share, residue_errors * error)};
}

}  // namespace todbench
