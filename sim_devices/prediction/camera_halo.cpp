// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/camera_halo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "tod/plate/plate_outlines.h"

namespace todbench {
namespace {

constexpr std::array sigmas_px{3.0, 4.5, 7.0, 10.0, 15.0, 22.0};
constexpr int cell_px = 4, cells_of_block = 4;
constexpr double clear_pitches = 4;
constexpr double least_share = 0.005, least_certainty = 5;
constexpr double least_of_twin = 0.2;  ///< of its halo, whose far parts simulated pictures leave out
constexpr float least_weight = 0.5F;   ///< of a cell: share of pixels that are clear of triangles

/// Covered share of every pixel, from 4 x 4 points.
cv::Mat1f coverage(const std::vector<Polygon>& outlines, cv::Size size) {
  constexpr int points = 4, fraction_bits = 8;
  cv::Mat1b fine(size * points, 0);
  for (const Polygon& outline : outlines) {
    std::vector<cv::Point> corners;
    for (const cv::Point2d& p : outline) {
      const cv::Point2d at = ((p + cv::Point2d(0.5, 0.5)) * points - cv::Point2d(0.5, 0.5)) * (1 << fraction_bits);
      corners.emplace_back(cv::Point(cvRound(at.x), cvRound(at.y)));
    }
    cv::fillConvexPoly(fine, corners, 1, cv::LINE_8, fraction_bits);
  }
  cv::Mat1f covered;
  fine.convertTo(covered, CV_32F);
  cv::resize(covered, covered, size, 0, 0, cv::INTER_AREA);
  return covered;
}

/// The tail of diffraction at a distance, a / (4 pi^2 r^3) per pixel, of covered pixels.
cv::Mat1f diffraction_tail(const cv::Mat1f& covered, double slope_px, double aspect) {
  constexpr int reach = 40;
  cv::Mat1f kernel(2 * reach + 1, 2 * reach + 1, 0.0F);
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const double r = std::hypot(x, aspect * y);
      if (r < 2) continue;
      kernel(y + reach, x + reach) =
          static_cast<float>(aspect * slope_px / (4 * std::pow(std::numbers::pi, 2) * r * r * r));
    }
  }
  cv::Mat1f tail;
  cv::filter2D(covered, tail, -1, kernel, {-1, -1}, 0, cv::BORDER_CONSTANT);
  return tail;
}

/// Pixels of the plate that are at least `clear_px` from its border and from every triangle.
cv::Mat1b clear_pixels(const OpticsPicture& shown, const cv::Mat1f& covered, double clear_px) {
  const TargetPlate& plate = shown.mounted_plate;
  std::vector<cv::Point> border;
  for (const cv::Point2d corner : {cv::Point2d(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
    border.emplace_back(shown.registration.pixel({0.5 * plate.width_mm * corner.x, 0.5 * plate.height_mm * corner.y}));
  cv::Mat1b free(covered.size(), 0);
  cv::fillConvexPoly(free, border, 1);
  free.setTo(0, covered > 0);
  // Outside the picture is no border of the plate.
  cv::Mat1b padded;
  const int reach = static_cast<int>(std::ceil(clear_px));
  cv::copyMakeBorder(free, padded, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  cv::Mat1f distance;
  cv::distanceTransform(padded, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance(cv::Rect({1, 1}, free.size())) > reach;
}

/// Means of the marked pixels of every cell.
cv::Mat1f cell_means(const cv::Mat1f& picture, const cv::Mat1f& marked, const cv::Mat1f& weight) {
  cv::Mat1f product = picture.mul(marked), out;
  cv::resize(product, out, weight.size(), 0, 0, cv::INTER_AREA);
  for (int i = 0; i < static_cast<int>(out.total()); ++i) {
    float& value = out(i / out.cols, i % out.cols);
    value = weight(i / out.cols, i % out.cols) > 0 ? value / weight(i / out.cols, i % out.cols) : 0;
  }
  return out;
}

/// Takes a weighted plane out of a picture of cells.
void take_plane(cv::Mat1d& picture, const cv::Mat1f& weight) {
  cv::Matx33d gram = cv::Matx33d::zeros();
  cv::Vec3d right(0, 0, 0);
  const auto row = [&](int y, int x) {
    return cv::Vec3d(1, static_cast<double>(x) / picture.cols - 0.5, static_cast<double>(y) / picture.rows - 0.5);
  };
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double w = weight(y, x);
      gram += w * row(y, x) * row(y, x).t();
      right += w * picture(y, x) * row(y, x);
    }
  }
  const cv::Vec3d plane = gram.inv(cv::DECOMP_SVD) * right;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) picture(y, x) -= plane.dot(row(y, x));
}

}  // namespace

CameraHaloFit::CameraHaloFit(const SensorSpec& twin, int samples_per_pitch)
    : diffraction_px_(4 / std::numbers::pi * 0.5 * (twin.wavelength_min_um + twin.wavelength_max_um) * twin.f_number /
                      twin.pitch_um * samples_per_pitch),
      clear_px_(clear_pitches * samples_per_pitch),
      aspect_(twin.pitch_aspect()),
      twin_share_(twin.halo_share),
      twin_sigma_px_(twin.halo_sigma_pitch * samples_per_pitch) {}

void CameraHaloFit::add(const OpticsPicture& shown, double delta_t_k) {
  const cv::Size size = shown.picture.size();
  const cv::Size cells(size.width / cell_px, size.height / cell_px);
  if (delta_t_k == 0 || cells.empty() || (!looks_.empty() && looks_[0].weight.size() != cells)) return;
  std::vector<Polygon> outlines;
  for (const PlateTriangle& t : shown.mounted_plate.triangles)
    outlines.push_back(outline_in_picture(shown.registration.plate_to_pixel, t, t.apex));
  const cv::Rect whole({0, 0}, cells * cell_px);
  const cv::Mat1f covered = coverage(outlines, size);
  cv::Mat1f marked;
  clear_pixels(shown, covered, clear_px_)(whole).convertTo(marked, CV_32F, 1 / 255.0);
  Look look;
  cv::resize(marked, look.weight, cells, 0, 0, cv::INTER_AREA);
  look.weight.setTo(0, look.weight < least_weight);
  cv::Mat1f level;
  shown.picture.convertTo(level, CV_32F, 1 / delta_t_k);
  if (twin_share_ > 0 && twin_sigma_px_ > 0) {
    cv::Mat1f spread;
    cv::GaussianBlur(covered, spread, {}, twin_sigma_px_, twin_sigma_px_ / aspect_, cv::BORDER_CONSTANT);
    level -= twin_share_ * spread;
  }
  look.level = cell_means(level(whole), marked, look.weight);
  look.tail = cell_means(diffraction_tail(covered, diffraction_px_, aspect_)(whole), marked, look.weight);
  for (const double sigma : sigmas_px) {
    cv::Mat1f spread;
    cv::GaussianBlur(covered, spread, {}, sigma, sigma / aspect_, cv::BORDER_CONSTANT);
    look.haloes.push_back(cell_means(spread(whole), marked, look.weight));
  }
  looks_.push_back(std::move(look));
}

std::optional<CameraHaloFit::Estimate> CameraHaloFit::estimate(std::size_t width, double f_number_ratio) const {
  const cv::Size cells = looks_[0].weight.size();
  const auto of_halo = [&](const Look& look) { return cv::Mat1f(look.level - f_number_ratio * look.tail); };
  // What the pictures have in common at a cell is taken out of both.
  cv::Mat1d weights(cells, 0.0), level(cells, 0.0), spread(cells, 0.0);
  for (const Look& look : looks_) {
    cv::accumulate(look.weight, weights);
    cv::accumulateProduct(of_halo(look), look.weight, level);
    cv::accumulateProduct(look.haloes[width], look.weight, spread);
  }
  struct Difference {
    cv::Mat1d level, spread;
  };
  std::vector<Difference> differences;
  double product = 0, square = 0;
  for (const Look& look : looks_) {
    Difference one{cv::Mat1d(cells, 0.0), cv::Mat1d(cells, 0.0)};
    const cv::Mat1f seen = of_halo(look);
    for (int y = 0; y < cells.height; ++y) {
      for (int x = 0; x < cells.width; ++x) {
        if (look.weight(y, x) == 0) continue;
        one.level(y, x) = seen(y, x) - level(y, x) / weights(y, x);
        one.spread(y, x) = look.haloes[width](y, x) - spread(y, x) / weights(y, x);
      }
    }
    take_plane(one.level, look.weight);
    take_plane(one.spread, look.weight);
    cv::Mat1d weight;
    look.weight.convertTo(weight, CV_64F);
    product += cv::Mat1d(one.level.mul(one.spread)).dot(weight);
    square += cv::Mat1d(one.spread.mul(one.spread)).dot(weight);
    differences.push_back(std::move(one));
  }
  if (!(square > 0)) return std::nullopt;
  Estimate out{.share = product / square, .gain = product * product / square};
  std::map<std::pair<int, int>, double> blocks;
  std::map<int, double> rows, columns;
  for (std::size_t i = 0; i < looks_.size(); ++i) {
    for (int y = 0; y < cells.height; ++y) {
      for (int x = 0; x < cells.width; ++x) {
        const double g = differences[i].spread(y, x);
        const double score = looks_[i].weight(y, x) * g * (differences[i].level(y, x) - out.share * g);
        const int row = y / cells_of_block, column = x / cells_of_block;
        blocks[{row, column}] += score;
        rows[row] += score;
        columns[column] += score;
      }
    }
  }
  const auto scatter = [](const auto& sums) {
    double squares = 0;
    for (const auto& [place, sum] : sums) squares += sum * sum;
    return squares;
  };
  out.share_se = std::sqrt(std::max({scatter(blocks), scatter(rows), scatter(columns)})) / square;
  return out;
}

std::optional<CameraHalo> CameraHaloFit::result(double f_number_ratio) const {
  if (looks_.size() < 2) return std::nullopt;
  std::optional<CameraHalo> best;
  double gain = 0;
  for (std::size_t width = 0; width < sigmas_px.size(); ++width) {
    const auto found = estimate(width, f_number_ratio);
    if (!found || !(found->gain > gain)) continue;
    gain = found->gain;
    best = CameraHalo{found->share, found->share_se, sigmas_px[width]};
  }
  // A camera may have less halo than its twin, not less than none.
  const double least = twin_share_ > 0 ? -twin_share_ : 0;
  if (!best || best->share < least) return std::nullopt;
  const double noticed = std::max({least_share, least_of_twin * twin_share_, least_certainty * best->share_se});
  if (std::abs(best->share) < noticed) return std::nullopt;
  return best;
}

}  // namespace todbench
