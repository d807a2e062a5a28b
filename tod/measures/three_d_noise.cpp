#include "tod/measures/three_d_noise.h"

#include <algorithm>
#include <cmath>

namespace todbench {

double ThreeDNoise::temporal() const {
  return std::sqrt(tvh * tvh + tv * tv + th * th + t * t);
}

Result<ThreeDNoise> three_d_noise(std::span<const cv::Mat1f> frames) {
  if (frames.size() < 2 || frames[0].rows < 2 || frames[0].cols < 2)
    return fail(ErrorCode::invalid_input, "3D noise needs at least two frames of two rows and two columns");
  const int count = static_cast<int>(frames.size()), rows = frames[0].rows, columns = frames[0].cols;
  // Means over one direction and over two; sums in double, differences from the first frame's first pixel.
  const double base = static_cast<double>(frames[0](0, 0));
  cv::Mat1d tv(count, rows, 0.0), th(count, columns, 0.0), vh(rows, columns, 0.0);
  for (int k = 0; k < count; ++k) {
    const cv::Mat1f& frame = frames[static_cast<std::size_t>(k)];
    if (frame.size() != frames[0].size()) return fail(ErrorCode::invalid_input, "frames of different sizes");
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const double value = static_cast<double>(frame(y, x)) - base;
        tv(k, y) += value / columns, th(k, x) += value / rows, vh(y, x) += value / count;
      }
    }
  }
  const auto means = [](const cv::Mat1d& table, int dimension) {
    cv::Mat1d out;
    cv::reduce(table, out, dimension, cv::REDUCE_AVG);
    return out;
  };
  const cv::Mat1d t = means(tv, 1), v = means(tv, 0), h = means(th, 0);
  const double mean = cv::mean(t)[0];
  double s_t = 0, s_v = 0, s_h = 0, s_tv = 0, s_th = 0, s_vh = 0, s_tvh = 0;
  for (int k = 0; k < count; ++k) s_t += std::pow(t(k) - mean, 2);
  for (int y = 0; y < rows; ++y) s_v += std::pow(v(y) - mean, 2);
  for (int x = 0; x < columns; ++x) s_h += std::pow(h(x) - mean, 2);
  for (int k = 0; k < count; ++k) {
    for (int y = 0; y < rows; ++y) s_tv += std::pow(tv(k, y) - t(k) - v(y) + mean, 2);
    for (int x = 0; x < columns; ++x) s_th += std::pow(th(k, x) - t(k) - h(x) + mean, 2);
  }
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) s_vh += std::pow(vh(y, x) - v(y) - h(x) + mean, 2);
  }
  for (int k = 0; k < count; ++k) {
    const cv::Mat1f& frame = frames[static_cast<std::size_t>(k)];
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const double value = static_cast<double>(frame(y, x)) - base;
        s_tvh += std::pow(value - tv(k, y) - th(k, x) - vh(y, x) + t(k) + v(y) + h(x) - mean, 2);
      }
    }
  }
  // Expected mean squares of a crossed three-way table without repetition (Scheffé 1959, ch. 7).
  const double n = count, m = rows, l = columns;
  const double q_tvh = s_tvh / ((n - 1) * (m - 1) * (l - 1));
  const double q_tv = l * s_tv / ((n - 1) * (m - 1)), q_th = m * s_th / ((n - 1) * (l - 1));
  const double q_vh = n * s_vh / ((m - 1) * (l - 1));
  const double q_t = m * l * s_t / (n - 1), q_v = n * l * s_v / (m - 1), q_h = n * m * s_h / (l - 1);
  const auto root = [](double variance) { return std::sqrt(std::max(0.0, variance)); };
  ThreeDNoise noise;
  noise.tvh = root(q_tvh);
  noise.tv = root((q_tv - q_tvh) / l);
  noise.th = root((q_th - q_tvh) / m);
  noise.vh = root((q_vh - q_tvh) / n);
  noise.t = root((q_t - q_tv - q_th + q_tvh) / (m * l));
  noise.v = root((q_v - q_tv - q_vh + q_tvh) / (n * l));
  noise.h = root((q_h - q_th - q_vh + q_tvh) / (n * m));
  return noise;
}

}  // namespace todbench
