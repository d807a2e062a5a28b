// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of plates with known truth, made without any code of the registration: area coverage by counting points on a
// fine grid, then a Gaussian for the optics and a box for the detector.
#pragma once

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "tests/support/source_file.h"
#include "tod/plate/target_plate.h"

namespace todbench::testing {

inline TargetPlate shipped_plate(const std::string& name) {
  const toml::table file = toml::parse_file(source_file("tod/plate/") + name + ".toml");
  TargetPlate plate;
  plate.name = file["name"].value<std::string>().value();
  plate.description = file["description"].value<std::string>().value();
  plate.width_mm = file["width_mm"].value<double>().value();
  plate.height_mm = file["height_mm"].value<double>().value();
  int row_number = 0;
  for (const toml::node& node : *file["row"].as_array()) {
    const toml::table& row = *node.as_table();
    ++row_number;
    const toml::array& x = *row["x_mm"].as_array();
    const toml::array& apex = *row["apex"].as_array();
    if (x.size() != apex.size()) throw std::runtime_error("x_mm and apex differ in length");
    for (std::size_t i = 0; i < x.size(); ++i) {
      PlateTriangle t;
      t.name = "row " + std::to_string(row_number) + ", triangle " + std::to_string(i + 1);
      t.position_mm = {x[i].value<double>().value(), row["y_mm"].value<double>().value()};
      t.size_mm = row["size_mm"].value<double>().value();
      t.apex = apex_from(apex[i].value<std::string>().value()).value();
      plate.triangles.push_back(t);
    }
  }
  return plate;
}

inline constexpr double mm_per_pixel = 2.617;  // 1.3085 mrad at 2 m
inline constexpr double expected_scale = 1 / mm_per_pixel;

/// What the camera sees. The defaults are a plate in the middle of a 160 x 140 picture.
struct PictureSpec {
  cv::Size size{160, 140};
  double contrast_k = 16.9;
  double noise_k = 0;
  double gaussian_px = 0.3;
  double scale = expected_scale;
  double stretch = 1;  ///< scale along the rows of the picture over that along its columns
  double rotation_deg = 0;
  cv::Point2d centre_px{79.8, 69.7};
  cv::Point2d tilt_per_mm{0, 0};  ///< third row of the homography
  cv::Point2d gradient_k{0, 0};   ///< of the background over the whole picture
  std::uint64_t seed = 1;
};

inline cv::Matx33d true_mapping(const PictureSpec& spec) {
  const double angle = spec.rotation_deg * std::numbers::pi / 180;
  const cv::Matx33d turn(spec.scale * std::cos(angle), -spec.scale * std::sin(angle), 0, spec.scale * std::sin(angle),
                         spec.scale * std::cos(angle), 0, spec.tilt_per_mm.x, spec.tilt_per_mm.y, 1);
  const double wide = std::sqrt(spec.stretch);
  return cv::Matx33d(wide, 0, spec.centre_px.x, 0, 1 / wide, spec.centre_px.y, 0, 0, 1) * turn;
}

inline cv::Point2d mapped(const cv::Matx33d& h, cv::Point2d p) {
  const cv::Vec3d q = h * cv::Vec3d(p.x, p.y, 1);
  return {q[0] / q[2], q[1] / q[2]};
}

/// Adds a convex polygon of contrast `k`. Cells of 0.1 px with one centred on every pixel centre: the box of nine cells
/// is 0.9 px wide and centred on the pixel. Coverage is exact along x and counted on ten lines per cell along y: edges
/// are right to 0.005 px.
inline void add_triangle(cv::Mat1d& picture, const std::vector<cv::Point2d>& corners, double k, double gaussian_px) {
  constexpr int fine = 10;
  constexpr int lines = 10;
  constexpr int margin = 4;
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  for (const cv::Point2d& c : corners) {
    low_x = std::min(low_x, c.x);
    low_y = std::min(low_y, c.y);
    high_x = std::max(high_x, c.x);
    high_y = std::max(high_y, c.y);
  }
  const int left = static_cast<int>(std::floor(low_x)) - margin;
  const int top = static_cast<int>(std::floor(low_y)) - margin;
  const int width = static_cast<int>(std::ceil(high_x)) + margin - left;
  const int height = static_cast<int>(std::ceil(high_y)) + margin - top;
  cv::Mat1d cover = cv::Mat1d::zeros(height * fine + 1, width * fine + 1);
  for (int line = 0; line < cover.rows * lines; ++line) {
    const double y = top + ((line + 0.5) / lines - 0.5) / fine;
    double from = 1e9, to = -1e9;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const cv::Point2d a = corners[i];
      const cv::Point2d b = corners[(i + 1) % corners.size()];
      if ((a.y < y) == (b.y < y)) continue;
      const double x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
      from = std::min(from, x);
      to = std::max(to, x);
    }
    if (from >= to) continue;
    const double first = (from - left) * fine + 0.5;  // in cells; cell c reaches from c to c + 1
    const double last = (to - left) * fine + 0.5;
    for (int c = static_cast<int>(first); c <= static_cast<int>(last); ++c) {
      cover(line / lines, c) += (std::min(last, c + 1.0) - std::max(first, static_cast<double>(c))) / lines;
    }
  }
  cv::GaussianBlur(cover, cover, {61, 61}, gaussian_px * fine, gaussian_px * fine);
  cv::blur(cover, cover, {9, 9});
  for (int y = 0; y <= height; ++y) {
    for (int x = 0; x <= width; ++x) {
      if (top + y < 0 || left + x < 0 || top + y >= picture.rows || left + x >= picture.cols) continue;
      picture(top + y, left + x) += k * cover(y * fine, x * fine);
    }
  }
}

inline void add_noise(cv::Mat1d& picture, double noise_k, std::uint64_t seed) {
  std::vector<float> normal(picture.total());
  RandomStream(seed, "test.noise").fill_normal(normal);
  auto pixel = picture.begin();
  for (const float z : normal) *pixel++ += noise_k * z;
}

inline cv::Mat1d plate_picture(const TargetPlate& plate, const PictureSpec& spec) {
  cv::Mat1d picture(spec.size);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      picture(y, x) = 300 + spec.gradient_k.x * x / picture.cols + spec.gradient_k.y * y / picture.rows;
    }
  }
  const cv::Matx33d h = true_mapping(spec);
  for (const PlateTriangle& t : plate.triangles) {
    std::vector<cv::Point2d> corners = triangle(t.size_mm, t.apex, t.position_mm);
    for (cv::Point2d& c : corners) c = mapped(h, c);
    add_triangle(picture, corners, spec.contrast_k, spec.gaussian_px);
  }
  add_noise(picture, spec.noise_k, spec.seed);
  return picture;
}

}  // namespace todbench::testing
