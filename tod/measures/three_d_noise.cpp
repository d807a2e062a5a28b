// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/three_d_noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "tod/measures/temporal_noise.h"

namespace todbench {
namespace {

using enum NoiseComponent;

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// Sum of squares about the means over frames: `values` contains `width` numbers of each frame.
double squares_in_time(const std::vector<double>& values, std::size_t width) {
  const std::size_t frames = values.size() / width;
  double sum = 0;
  for (std::size_t i = 0; i < width; ++i) {
    double mean = 0;
    for (std::size_t k = 0; k < frames; ++k) mean += values[k * width + i];
    mean /= static_cast<double>(frames);
    for (std::size_t k = 0; k < frames; ++k) sum += std::pow(values[k * width + i] - mean, 2);
  }
  return sum;
}

/// Sum of squares of the difference of the last two frames; `values` contains `width` numbers of each.
double step_squares(const std::vector<double>& values, std::size_t width) {
  double sum = 0;
  for (std::size_t i = values.size() - width; i < values.size(); ++i) sum += std::pow(values[i] - values[i - width], 2);
  return sum;
}

/// Sums of squares of the fixed components, in the mean of all frames.
struct FixedSquares {
  double v = 0, h = 0, vh = 0;
};

FixedSquares fixed_squares(const cv::Mat1d& mean_frame) {
  // About the middle of the picture, so that counts of any size keep their last digits.
  const cv::Mat1d picture = mean_frame - cv::mean(mean_frame)[0];
  cv::Mat1d rows, columns;
  cv::reduce(picture, rows, 1, cv::REDUCE_AVG);
  cv::reduce(picture, columns, 0, cv::REDUCE_AVG);
  const double mean = cv::mean(rows)[0];
  FixedSquares sum;
  for (int y = 0; y < picture.rows; ++y) {
    sum.v += std::pow(rows(y) - mean, 2);
    for (int x = 0; x < picture.cols; ++x) sum.vh += std::pow(picture(y, x) - rows(y) - columns(x) + mean, 2);
  }
  for (int x = 0; x < picture.cols; ++x) sum.h += std::pow(columns(x) - mean, 2);
  return sum;
}

/// The relative distances of a mean square's confidence limits from it (Graybill and Wang 1980).
struct Reach {
  double down = 0, up = 0;
};

constexpr double each_side = 0.025;

Reach reach_of(double degrees_of_freedom) {
  const distribution::ChiSquared squares(degrees_of_freedom);
  return {1 - degrees_of_freedom / distribution::quantile(complement(squares, each_side)),
          degrees_of_freedom / distribution::quantile(squares, each_side) - 1};
}

/// Additional term of a difference of two mean squares that makes the limit exact if one of them vanishes (Ting et al.
/// 1990). `ratio`: quantile of F on this side.
double cross_term(double ratio, double of_plus, double of_minus) {
  return (std::pow(ratio - 1, 2) - std::pow(of_plus * ratio, 2) - of_minus * of_minus) / ratio;
}

}  // namespace

std::string_view to_string(NoiseComponent component) {
  switch (component) {
    case t:
      return "t";
    case v:
      return "v";
    case h:
      return "h";
    case tv:
      return "tv";
    case th:
      return "th";
    case vh:
      return "vh";
    case tvh:
      return "tvh";
  }
  return "";
}

namespace {

/// Expected mean squares of noise of first order over its variance.
struct Memory {
  double in_time = 1;  ///< about the mean of this many frames
  double in_mean = 1;  ///< of that mean, times the frames
};

Memory memory_of(double rho, int frames) {
  if (rho == 0) return {};
  const double n = frames;
  Memory memory;
  double power = 1;
  for (int k = 1; k < frames; ++k) memory.in_mean += 2 * (1 - k / n) * (power *= rho);
  memory.in_time = 1 - (memory.in_mean - 1) / (n - 1);
  return memory;
}

/// Degrees of freedom of a mean square. The variance of noise of first order is as certain as from (1 - rho^2) / (1 +
/// rho^2) of its values (Bartlett 1946).
double freedom_of(const NoiseTable& table, NoiseComponent component) {
  const double rho = table.pixel_memory, freedom = table.degrees_of_freedom[component];
  return component == tvh && rho != 0 ? std::max(1.0, freedom * (1 - rho * rho) / (1 + rho * rho)) : freedom;
}

/// An estimate is a sum of mean squares with factors, from their expected values (Scheffé 1959, ch. 7).
struct MeanSquareTerm {
  NoiseComponent of;
  double factor;
};

std::vector<MeanSquareTerm> terms_of(const NoiseTable& table, NoiseComponent component) {
  const double n = table.frames, m = table.rows, l = table.columns;
  const Memory memory = memory_of(table.pixel_memory, table.frames);
  switch (component) {
    case t:
      return {{t, 1 / (m * l)}, {tv, -1 / (m * l)}, {th, -1 / (m * l)}, {tvh, 1 / (m * l)}};
    case v:
      return {{v, 1 / (n * l)}, {tv, -1 / (n * l)}, {vh, -1 / (n * l)}, {tvh, 1 / (n * l)}};
    case h:
      return {{h, 1 / (n * m)}, {th, -1 / (n * m)}, {vh, -1 / (n * m)}, {tvh, 1 / (n * m)}};
    case tv:
      return {{tv, 1 / l}, {tvh, -1 / l}};
    case th:
      return {{th, 1 / m}, {tvh, -1 / m}};
    case vh:
      return {{vh, 1 / n}, {tvh, -memory.in_mean / memory.in_time / n}};
    case tvh:
      return {{tvh, 1 / memory.in_time}};
  }
  return {};
}

}  // namespace

ComponentEstimate estimate_of(const NoiseTable& table, NoiseComponent component) {
  const std::vector<MeanSquareTerm> terms = terms_of(table, component);
  ComponentEstimate estimate;
  double below = 0, above = 0;
  for (const auto& [of, factor] : terms) {
    const double part = factor * table.mean_squares[of];
    const Reach reach = reach_of(freedom_of(table, of));
    estimate.variance += part;
    below += std::pow((factor > 0 ? reach.down : reach.up) * part, 2);
    above += std::pow((factor > 0 ? reach.up : reach.down) * part, 2);
  }
  if (terms.size() == 2) {
    const double plus = freedom_of(table, terms[0].of), minus = freedom_of(table, terms[1].of);
    const distribution::FisherF ratio(plus, minus);
    const Reach of_plus = reach_of(plus), of_minus = reach_of(minus);
    const double product =
        -terms[0].factor * terms[1].factor * table.mean_squares[terms[0].of] * table.mean_squares[terms[1].of];
    below += cross_term(distribution::quantile(complement(ratio, each_side)), of_plus.down, of_minus.up) * product;
    above += cross_term(distribution::quantile(ratio, each_side), of_plus.up, of_minus.down) * product;
    const double absent = -terms[1].factor * table.mean_squares[terms[1].of];  // expected without the component
    if (absent > 0)
      estimate.p_absent = cdf(complement(ratio, terms[0].factor * table.mean_squares[terms[0].of] / absent));
  }
  if (table.pixel_memory != 0) {
    NoiseTable forgetful = table;
    forgetful.pixel_memory = 0;
    double plain = 0;
    for (const auto& [of, factor] : terms_of(forgetful, component)) plain += factor * table.mean_squares[of];
    const double change = std::pow(0.5 * (estimate.variance - plain), 2);
    below += change, above += change;
  }
  estimate.low = estimate.variance - std::sqrt(std::max(0.0, below));
  estimate.high = estimate.variance + std::sqrt(std::max(0.0, above));
  return estimate;
}

ComponentEstimate temporal_variance(const NoiseTable& table) {
  ComponentEstimate estimate;
  double below = 0, above = 0;
  const double in_time = memory_of(table.pixel_memory, table.frames).in_time;
  for (const NoiseComponent of : {t, tv, th, tvh}) {
    const double squares = table.mean_squares[of] * table.degrees_of_freedom[of];
    // The part of the variance in time that memory removes is also missing in the means of rows, columns and frames.
    const double kept = of == tvh ? table.mean_squares[tvh] * (1 / in_time - 1) : 0;
    const double part = squares / (table.rows * table.columns * (table.frames - 1.0)) + kept;
    const Reach reach = reach_of(freedom_of(table, of));
    estimate.variance += part;
    below += std::pow(reach.down * part, 2) + std::pow(0.5 * kept, 2);
    above += std::pow(reach.up * part, 2) + std::pow(0.5 * kept, 2);
  }
  estimate.low = estimate.variance - std::sqrt(below);
  estimate.high = estimate.variance + std::sqrt(above);
  return estimate;
}

template <typename Pixel>
Result<void> NoiseCube::add_frame(const cv::Mat_<Pixel>& frame) {
  if (frame.empty()) return fail(ErrorCode::invalid_input, "a frame is empty");
  if (frames_ == 0) {
    frame.convertTo(first_, CV_64F);
    change_ = cv::Mat1d::zeros(frame.size());
    last_ = cv::Mat1d::zeros(frame.size());
    row_steps_.assign(static_cast<std::size_t>(frame.rows), 0.0);
  }
  if (frame.size() != first_.size()) return fail(ErrorCode::invalid_input, "the frames have different sizes");
  const int rows = frame.rows, columns = frame.cols;
  std::vector<double> row_sums(static_cast<std::size_t>(rows)), column_sums(static_cast<std::size_t>(columns));
  double sum = 0;
  for (int y = 0; y < rows; ++y) {
    const Pixel* value = frame[y];
    const double* reference = first_[y];
    double of_row = 0;
    for (int x = 0; x < columns; ++x) {
      const double change = static_cast<double>(value[x]) - reference[x];
      of_row += change;
      column_sums[static_cast<std::size_t>(x)] += change;
    }
    row_sums[static_cast<std::size_t>(y)] = of_row;
    sum += of_row;
  }
  if (!std::isfinite(sum)) return fail(ErrorCode::invalid_input, "a frame contains a value that is not finite");
  const double mean = sum / (static_cast<double>(rows) * columns);
  double steps = 0;
  for (int y = 0; y < rows; ++y) {
    const Pixel* value = frame[y];
    const double* reference = first_[y];
    double* total = change_[y];
    double* last = last_[y];
    double squares = 0, step_squares = 0, step_sum = 0;
    for (int x = 0; x < columns; ++x) {
      const double change = static_cast<double>(value[x]) - reference[x] - mean;
      const double step = change - last[x];
      total[x] += change;
      squares += change * change;
      step_squares += step * step;
      step_sum += step;
      last[x] = change;
    }
    squares_ += squares;
    steps += step_squares;
    row_steps_[static_cast<std::size_t>(y)] += step_squares - step_sum * step_sum / columns;
  }
  frame_means_.push_back(mean);
  for (const double of_row : row_sums) row_means_.push_back(of_row / columns - mean);
  for (const double of_column : column_sums) column_means_.push_back(of_column / rows - mean);
  if (frames_ > 0) {
    const double in_rows = columns * step_squares(row_means_, static_cast<std::size_t>(rows));
    const double in_columns = rows * step_squares(column_means_, static_cast<std::size_t>(columns));
    steps_.push_back(std::max(0.0, steps - in_rows - in_columns) / ((rows - 1.0) * (columns - 1.0)));
  }
  ++frames_;
  return {};
}

Result<void> NoiseCube::add(const cv::Mat1w& frame) {
  return add_frame(frame);
}
Result<void> NoiseCube::add(const cv::Mat1f& frame) {
  return add_frame(frame);
}
Result<void> NoiseCube::add(const cv::Mat1d& frame) {
  return add_frame(frame);
}

Result<NoiseTable> NoiseCube::table() const {
  return table_without(cv::Mat1d::zeros(first_.size()));
}

Result<NoiseTable> NoiseCube::table_without(const cv::Mat1d& fixed_picture) const {
  if (frames_ < 2 || first_.rows < 2 || first_.cols < 2)
    return fail(ErrorCode::invalid_input, "3-D noise needs at least two frames of two rows and two columns");
  const double n = frames_, m = first_.rows, l = first_.cols;
  // Squares about each pixel's mean over time are those of tv, th and tvh; the frames' own means are already removed.
  const double in_time = squares_ - change_.dot(change_) / n;
  const double s_tv = l * squares_in_time(row_means_, static_cast<std::size_t>(first_.rows));
  const double s_th = m * squares_in_time(column_means_, static_cast<std::size_t>(first_.cols));
  const double mean = std::accumulate(frame_means_.begin(), frame_means_.end(), 0.0) / n;
  std::vector<double> about_mean = frame_means_;
  for (double& value : about_mean) value -= mean;
  const FixedSquares fixed = fixed_squares(mean_frame() - fixed_picture);
  NoiseTable table;
  table.frames = frames_, table.rows = first_.rows, table.columns = first_.cols;
  ByComponent& freedom = table.degrees_of_freedom;
  freedom[t] = n - 1, freedom[v] = m - 1, freedom[h] = l - 1;
  freedom[tv] = (n - 1) * (m - 1), freedom[th] = (n - 1) * (l - 1), freedom[vh] = (m - 1) * (l - 1);
  freedom[tvh] = (n - 1) * (m - 1) * (l - 1);
  ByComponent& squares = table.mean_squares;
  squares[t] = m * l * sum_of_squares(about_mean), squares[v] = n * l * fixed.v, squares[h] = n * m * fixed.h;
  squares[tv] = s_tv, squares[th] = s_th, squares[vh] = n * fixed.vh;
  squares[tvh] = std::max(0.0, in_time - s_tv - s_th);
  for (const NoiseComponent component : noise_components) squares[component] /= freedom[component];
  return table;
}

std::optional<int> NoiseCube::abrupt_change() const {
  if (frames_ < 5 || first_.rows < 2 || first_.cols < 2) return std::nullopt;
  std::vector<double> sorted = steps_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (!(*middle > 0)) return std::nullopt;
  constexpr double least_ratio = 1.69, by_chance = 1e-9;  // 1.3 times the difference
  const double freedom = (first_.rows - 1.0) * (first_.cols - 1.0);
  const distribution::FisherF ratios(freedom, freedom);
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const double ratio = steps_[k] / *middle;
    if (ratio > least_ratio && cdf(complement(ratios, ratio)) < by_chance / frames_) return static_cast<int>(k) + 1;
  }
  return std::nullopt;
}

bool NoiseCube::few_pairs_stand_out() const {
  if (steps_.empty()) return true;
  constexpr double standing_out = 1.3;
  constexpr std::ptrdiff_t few = 3;
  std::vector<double> sorted = steps_;
  std::sort(sorted.begin(), sorted.end());
  const double limit = standing_out * sorted[sorted.size() / 2];
  return std::distance(std::upper_bound(sorted.begin(), sorted.end(), limit), sorted.end()) <= few;
}

bool NoiseCube::noise_changes() const {
  if (frames_ < 8 || first_.rows < 2 || first_.cols < 2) return false;
  const std::size_t half = steps_.size() / 2;
  const auto mean = [](std::span<const double> steps) {
    return std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
  };
  const double before = mean(std::span(steps_).first(half)), after = mean(std::span(steps_).last(half));
  return mean_squares_differ(before, after, (first_.rows - 1.0) * (first_.cols - 1.0) * static_cast<double>(half));
}

std::optional<int> NoiseCube::row_outside_picture() const {
  constexpr int edge = 4;  // rows that may be telemetry, and as many to compare with
  constexpr double most_steps = 100, most_roughness = 10;
  const int rows = first_.rows;
  if (frames_ < 2 || rows < 4 * edge || first_.cols < 2) return std::nullopt;
  const cv::Mat1d mean = mean_frame();
  const auto roughness = [&](int row) {
    double sum = 0;
    for (int x = 1; x < mean.cols; ++x) sum += std::abs(mean(row, x) - mean(row, x - 1));
    return sum;
  };
  for (const bool upper : {true, false}) {
    const auto row_at = [&](int from_edge) { return upper ? from_edge : rows - 1 - from_edge; };
    double steps = 0, rough = 0;
    for (int k = edge; k < 2 * edge; ++k) {
      steps = std::max(steps, row_steps_[static_cast<std::size_t>(row_at(k))]);
      rough = std::max(rough, roughness(row_at(k)));
    }
    for (int k = 0; k < edge; ++k) {
      const int row = row_at(k);
      if (row_steps_[static_cast<std::size_t>(row)] > most_steps * steps || roughness(row) > most_roughness * rough)
        return row;
    }
  }
  return std::nullopt;
}

std::optional<double> NoiseCube::lag1_correlation() const {
  const auto found = table();
  if (frames_ < 5 || !found || !(found->mean_squares[tvh] > 0)) return std::nullopt;
  const double step = std::accumulate(steps_.begin(), steps_.end(), 0.0) / static_cast<double>(steps_.size());
  const double ratio = step / (2 * found->mean_squares[tvh]);
  // (1 - rho) / in_time falls from 2 at rho = -1 to 3 / (T + 1) at 1.
  double low = -0.99, high = 0.99;
  for (int round = 0; round < 50; ++round) {
    const double rho = 0.5 * (low + high);
    ((1 - rho) / memory_of(rho, frames_).in_time > ratio ? low : high) = rho;
  }
  return 0.5 * (low + high);
}

double NoiseCube::pixel_memory() const {
  const auto rho = lag1_correlation();
  const double values = (frames_ - 1.0) * (first_.rows - 1.0) * (first_.cols - 1.0);
  const bool known = rho && *rho <= 0.95 && std::abs(*rho) > 5 / std::sqrt(values);
  return known ? *rho : 0;
}

double ThreeDNoise::temporal() const {
  return std::sqrt(tvh * tvh + tv * tv + th * th + t * t);
}

Result<ThreeDNoise> three_d_noise(std::span<const cv::Mat1f> frames) {
  NoiseCube cube;
  for (const cv::Mat1f& frame : frames) {
    TODBENCH_TRY_VOID(cube.add(frame));
  }
  TODBENCH_TRY(const auto table, cube.table());
  const auto root = [&](NoiseComponent component) {
    double variance = 0;
    for (const auto& [of, factor] : terms_of(table, component)) variance += factor * table.mean_squares[of];
    return std::sqrt(std::max(0.0, variance));
  };
  return ThreeDNoise{
      .tvh = root(tvh), .tv = root(tv), .th = root(th), .t = root(t), .vh = root(vh), .v = root(v), .h = root(h)};
}

}  // namespace todbench
