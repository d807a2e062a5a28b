// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/layout_matching.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

cv::Point2d map(const cv::Matx33d& h, cv::Point2d p) {
  return {h(0, 0) * p.x + h(0, 1) * p.y + h(0, 2), h(1, 0) * p.x + h(1, 1) * p.y + h(1, 2)};
}

cv::Matx33d similarity(double a, double b, cv::Point2d from, cv::Point2d to) {
  return {a, -b, to.x - a * from.x + b * from.y, b, a, to.y - b * from.x - a * from.y, 0, 0, 1};
}

double scale_of(const cv::Matx33d& similarity) {
  return std::hypot(similarity(0, 0), similarity(1, 0));
}

/// Largest distance of a triangle from its predicted place: 1 px, or 0.3 of its size, for blobs cut off centre and an
/// oblique view of the plate.
double tolerance_px(double size_px) {
  return std::max(1.0, 0.3 * size_px);
}

class Matcher {
 public:
  Matcher(std::span<const PlateTriangle> triangles, std::span<const Blob> blobs, const MatchLimits& limits)
      : triangles_(triangles), blobs_(blobs), limits_(limits) {}

  std::optional<LayoutMatch> best() {
    if (triangles_.size() == 1) {
      for (const Blob& blob : blobs_) {
        consider(similarity(limits_.expected_scale_px_per_mm, 0, triangles_[0].position_mm, blob.centre));
      }
    }
    for (const auto& [i, j] : baselines()) {
      for (std::size_t a = 0; a < blobs_.size(); ++a) {
        for (std::size_t b = 0; b < blobs_.size(); ++b) {
          if (a != b) try_pair(i, j, a, b);
        }
      }
    }
    return best_;
  }

 private:
  /// Pairs of triangles, the farthest apart first: they determine scale and rotation best. Limited in number, because
  /// each is tried with every pair of blobs; 60 include all pairs of eleven triangles.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> baselines() const {
    constexpr std::size_t most = 60;
    std::vector<std::pair<std::size_t, std::size_t>> all;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      for (std::size_t j = i + 1; j < triangles_.size(); ++j) all.emplace_back(i, j);
    }
    const auto length = [&](const auto& p) {
      return cv::norm(triangles_[p.first].position_mm - triangles_[p.second].position_mm);
    };
    std::ranges::stable_sort(all, [&](const auto& p, const auto& q) { return length(p) > length(q); });
    all.resize(std::min(all.size(), most));
    return all;
  }

  [[nodiscard]] bool compatible(std::size_t triangle, const Blob& blob, double scale) const {
    const double ratio = blob.size_px / (triangles_[triangle].size_mm * scale);
    return ratio > 0.55 && ratio < 1.7;
  }

  void try_pair(std::size_t i, std::size_t j, std::size_t a, std::size_t b) {
    // All cut-outs show the same black body; blur dims a small one to about 0.7.
    if (blobs_[a].strength > 2.5 * blobs_[b].strength || blobs_[b].strength > 2.5 * blobs_[a].strength) return;
    const cv::Point2d on_plate = triangles_[j].position_mm - triangles_[i].position_mm;
    const cv::Point2d in_picture = blobs_[b].centre - blobs_[a].centre;
    const double square = on_plate.dot(on_plate);
    const double cosine = on_plate.dot(in_picture) / square;
    const double sine = on_plate.cross(in_picture) / square;
    const double scale = std::hypot(cosine, sine);
    if (std::abs(scale / limits_.expected_scale_px_per_mm - 1) > limits_.scale_range) return;
    if (std::abs(std::atan2(sine, cosine)) > limits_.rotation_range_deg * std::numbers::pi / 180) return;
    if (!compatible(i, blobs_[a], scale) || !compatible(j, blobs_[b], scale)) return;
    consider(similarity(cosine, sine, triangles_[i].position_mm, blobs_[a].centre), blobs_[a].strength);
  }

  void consider(const cv::Matx33d& hypothesis, double strength = 0) {
    LayoutMatch match = paired(hypothesis, strength);
    if (best_ && best_->better_than(match)) return;
    // Repeated with the similarity of all its pairs: the first one carries the errors of two blobs only.
    for (int round = 0; round < 2 && match.pairs.size() >= 2; ++round) {
      std::vector<cv::Point2d> plate, pixels;
      for (const auto& [t, b] : match.pairs) {
        plate.push_back(triangles_[t].position_mm);
        pixels.push_back(blobs_[b].centre);
      }
      match = paired(fit_similarity(plate, pixels, limits_.expected_scale_px_per_mm), strength);
    }
    const double error = squared_error(match);
    if (match.pairs.empty()) return;
    const bool tied = best_ && !best_->better_than(match) && !match.better_than(*best_);
    if (best_ && (best_->better_than(match) || (tied && error >= best_error_))) return;
    best_ = std::move(match);
    best_error_ = error;
  }

  [[nodiscard]] LayoutMatch paired(const cv::Matx33d& hypothesis, double strength) const {
    LayoutMatch match;
    match.plate_to_pixel = hypothesis;
    const double scale = scale_of(hypothesis);
    std::vector<bool> used(blobs_.size(), false);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const cv::Point2d place = map(hypothesis, triangles_[t].position_mm);
      const double size = triangles_[t].size_mm * scale;
      std::size_t nearest = blobs_.size();
      double distance = tolerance_px(size);
      for (std::size_t b = 0; b < blobs_.size(); ++b) {
        const double d = cv::norm(blobs_[b].centre - place);
        if (d >= distance || used[b] || !compatible(t, blobs_[b], scale)) continue;
        if (strength > 0 && (blobs_[b].strength > 2.5 * strength || strength > 2.5 * blobs_[b].strength)) continue;
        nearest = b;
        distance = d;
      }
      if (nearest < blobs_.size()) {
        used[nearest] = true;
        match.pairs.emplace_back(t, nearest);
      } else if (place.x > size && place.y > size && place.x < limits_.picture.width - 1 - size &&
                 place.y < limits_.picture.height - 1 - size) {
        ++match.missing;
      }
    }
    return match;
  }

  [[nodiscard]] double squared_error(const LayoutMatch& match) const {
    double sum = 0;
    for (const auto& [t, b] : match.pairs) {
      const cv::Point2d d = blobs_[b].centre - map(match.plate_to_pixel, triangles_[t].position_mm);
      sum += d.dot(d);
    }
    return sum;
  }

  std::span<const PlateTriangle> triangles_;
  std::span<const Blob> blobs_;
  const MatchLimits& limits_;
  std::optional<LayoutMatch> best_;
  double best_error_ = 0;
};

}  // namespace

cv::Matx33d fit_similarity(std::span<const cv::Point2d> plate_mm, std::span<const cv::Point2d> pixels,
                           double default_scale) {
  const double n = static_cast<double>(pixels.size());
  cv::Point2d plate_mean{0, 0}, pixel_mean{0, 0};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    plate_mean += plate_mm[i] / n;
    pixel_mean += pixels[i] / n;
  }
  double square = 0, along = 0, across = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const cv::Point2d p = plate_mm[i] - plate_mean;
    const cv::Point2d q = pixels[i] - pixel_mean;
    square += p.dot(p);
    along += p.dot(q);
    across += p.cross(q);
  }
  if (square == 0) return similarity(default_scale, 0, plate_mean, pixel_mean);
  return similarity(along / square, across / square, plate_mean, pixel_mean);
}

std::optional<LayoutMatch> match_layout(std::span<const PlateTriangle> triangles, std::span<const Blob> blobs,
                                        const MatchLimits& limits) {
  return Matcher(triangles, blobs, limits).best();
}

}  // namespace todbench
