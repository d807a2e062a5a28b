#include "sim_devices/sensor/picture_stages.h"

#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "hvs/shape/gauss_legendre.h"

namespace todbench {
namespace {

constexpr int tap_reach = 8;

std::vector<float> normals(const RandomStream& stream, int count) {
  std::vector<float> out(static_cast<std::size_t>(count));
  stream.fill_normal(out);
  return out;
}

}  // namespace

void add_line_noise(cv::Mat1f& picture, const SensorSpec& spec, const RandomStream& rows, const RandomStream& columns,
                    double weight) {
  const int n = spec.samples_per_pitch();
  if (spec.row_noise_k > 0) {
    // One number per sample row and sub-exposure along it.
    const auto offsets = normals(rows, picture.rows * n);
    const auto sd = static_cast<float>(weight * spec.row_noise_k);
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.cols; ++column)
        picture(row, column) += sd * offsets[static_cast<std::size_t>(row * n + column % n)];
    }
  }
  if (spec.column_noise_k > 0) {
    const auto offsets = normals(columns, picture.cols * n);
    const auto sd = static_cast<float>(weight * spec.column_noise_k);
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.cols; ++column)
        picture(row, column) += sd * offsets[static_cast<std::size_t>(column * n + row % n)];
    }
  }
}

cv::Mat1b dead_detectors(cv::Size detectors, double share, const RandomStream& stream) {
  cv::Mat1b dead(detectors, std::uint8_t{0});
  for (int row = 0; row < dead.rows; ++row) {
    for (int column = 0; column < dead.cols; ++column) {
      const auto index =
          static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(dead.cols) + static_cast<std::uint64_t>(column);
      dead(row, column) = stream.uniform(index) < share ? 1 : 0;
    }
  }
  return dead;
}

void replace_dead(cv::Mat1f& picture, const cv::Mat1b& dead, int samples_per_pitch) {
  constexpr std::array<std::array<int, 2>, 4> neighbours{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  for (int row = 0; row < dead.rows; ++row) {
    for (int column = 0; column < dead.cols; ++column) {
      if (dead(row, column) == 0) continue;
      for (int sample = 0; sample < samples_per_pitch * samples_per_pitch; ++sample) {
        const int y = row * samples_per_pitch + sample / samples_per_pitch;
        const int x = column * samples_per_pitch + sample % samples_per_pitch;
        float sum = 0;
        int live = 0;
        for (const auto& [dy, dx] : neighbours) {
          const int r = row + dy, c = column + dx;
          if (r < 0 || c < 0 || r >= dead.rows || c >= dead.cols || dead(r, c) != 0) continue;
          sum += picture(y + dy * samples_per_pitch, x + dx * samples_per_pitch);
          ++live;
        }
        if (live > 0) picture(y, x) = sum / static_cast<float>(live);
      }
    }
  }
}

std::vector<double> taps_of(const std::function<double(double)>& response) {
  std::vector<double> taps(2 * tap_reach + 1, 0.0);
  double sum = 0;
  for (int k = 0; k <= tap_reach; ++k) {
    double integral = 0;
    for (const auto& [x, weight] : gauss_legendre(48)) {
      const double f = 0.25 + 0.25 * x;  // 0 to 1/2, and as much on the other side
      integral += 0.5 * weight * response(f) * std::cos(2 * std::numbers::pi * f * k);
    }
    taps[static_cast<std::size_t>(tap_reach + k)] = taps[static_cast<std::size_t>(tap_reach - k)] = integral;
    sum += (k == 0 ? 1 : 2) * integral;
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

double display_response(const SensorSpec& spec, double f_per_sample) {
  const double angle = std::numbers::pi * f_per_sample;
  const double blur = std::exp(-2 * std::pow(angle * spec.display_blur_samples, 2));
  if (spec.display == DisplayReconstruction::sample_and_hold || angle == 0) return blur;
  return blur * std::sin(angle) / angle;
}

bool has_display(const SensorSpec& spec) {
  return spec.display != DisplayReconstruction::sample_and_hold || spec.display_blur_samples > 0;
}

cv::Mat1f filtered(const cv::Mat1f& picture, const std::vector<double>& taps) {
  cv::Mat1f out;
  cv::sepFilter2D(picture, out, CV_32F, taps, taps, {-1, -1}, 0, cv::BORDER_REFLECT_101);
  return out;
}

}  // namespace todbench
