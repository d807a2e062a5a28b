// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/plate_tails.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace todbench {
namespace {

constexpr double clear_of_border_px = 4;
constexpr double smooth_from_px = 12;  // from every edge: blocks of pixels count as one sample
constexpr int block_px = 4;
constexpr double shading_unit_px = 50;
constexpr double widest_share = 0.25;  // of the plate: wider halos are a loss of contrast of everything on it
constexpr std::size_t shading_columns = 7;

TailRectangle rectangle_of(const Polygon& outline) {
  return {0.25 * (outline[0] + outline[1] + outline[2] + outline[3]),
          0.25 * (outline[1] + outline[2] - outline[0] - outline[3]),
          0.25 * (outline[2] + outline[3] - outline[0] - outline[1])};
}

/// Coordinates along the sides of a rectangle, with half its sides.
struct Local {
  double u, v, half_u, half_v;
  /// Distance from the border, negative inside.
  [[nodiscard]] double distance() const {
    const double du = std::abs(u) - half_u, dv = std::abs(v) - half_v;
    return std::max(du, dv) <= 0 ? std::max(du, dv) : std::hypot(std::max(du, 0.0), std::max(dv, 0.0));
  }
};

Local local(const TailRectangle& rectangle, cv::Point2d at) {
  const double half_u = cv::norm(rectangle.half_u), half_v = cv::norm(rectangle.half_v);
  return {(at - rectangle.middle).dot(rectangle.half_u) / half_u,
          (at - rectangle.middle).dot(rectangle.half_v) / half_v, half_u, half_v};
}

/// A rectangle after a normal blur.
double blurred(const TailRectangle& rectangle, cv::Point2d at, double sigma) {
  const Local l = local(rectangle, at);
  const auto share = [&](double x, double half) {
    const double root = sigma * std::numbers::sqrt2;
    return 0.5 * (std::erf((x + half) / root) - std::erf((x - half) / root));
  };
  return share(l.u, l.half_u) * share(l.v, l.half_v);
}

/// Level, step, place and blur of a cut-out from the pixels near its border.
struct CoarseFit {
  double level = 0, step = 0, sigma = 0.6;
  cv::Point2d shift{0, 0};
};

std::optional<CoarseFit> coarse_fit(const cv::Mat1d& picture, const TailRectangle& rectangle) {
  constexpr double near_px = 5;
  std::vector<cv::Point> pixels;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x)
      if (std::abs(local(rectangle, cv::Point2d(x, y)).distance()) < near_px) pixels.emplace_back(x, y);
  }
  if (pixels.size() < 40) return std::nullopt;
  CoarseFit fit;
  for (int round = 0; round < 12; ++round) {
    TailRectangle moved = rectangle;
    moved.middle += fit.shift;
    cv::Matx<double, 5, 5> gram = cv::Matx<double, 5, 5>::zeros();
    cv::Vec<double, 5> right = cv::Vec<double, 5>::all(0);
    for (const cv::Point& pixel : pixels) {
      constexpr double h = 0.01;
      const cv::Point2d at = pixel;
      const double value = blurred(moved, at, fit.sigma);
      const double dx = (blurred(moved, at - cv::Point2d(h, 0), fit.sigma) - value) / h;
      const double dy = (blurred(moved, at - cv::Point2d(0, h), fit.sigma) - value) / h;
      const double ds = (blurred(moved, at, fit.sigma + h) - value) / h;
      const double scale = fit.step == 0 ? 1 : fit.step;
      const cv::Vec<double, 5> row(1, value, scale * dx, scale * dy, scale * ds);
      const double left = picture(pixel) - fit.level - fit.step * value;
      // Level and step first: without them there is no direction of the place.
      gram += row * row.t(), right += left * row;
    }
    const bool first = fit.step == 0;
    if (first) {
      for (int k = 2; k < 5; ++k) {
        for (int j = 0; j < 5; ++j) gram(k, j) = gram(j, k) = k == j ? 1 : 0;
        right(k) = 0;
      }
    }
    cv::Vec<double, 5> change;
    if (!cv::solve(gram, right, change, cv::DECOMP_CHOLESKY)) return std::nullopt;
    fit.level += change[0], fit.step += change[1];
    fit.shift += {std::clamp(change[2], -0.5, 0.5), std::clamp(change[3], -0.5, 0.5)};
    fit.sigma = std::clamp(fit.sigma + std::clamp(change[4], -0.2, 0.2), 0.2, 6.0);
  }
  constexpr double farthest_px = 2;
  if (!(std::abs(fit.step) > 0) || !(cv::norm(fit.shift) < farthest_px)) return std::nullopt;
  return fit;
}

/// The columns of the model, with a plane of shading inside and a polynomial of second order outside.
TailColumns plate_columns(const std::vector<TailRectangle>& rectangles, const TailRectangle& own) {
  return [rectangles, own](cv::Point2d at, std::vector<double>& columns) {
    set_tail_columns(rectangles, at, columns);
    const double lit = columns[edge_tails::step];
    const double u = (at.x - own.middle.x) / shading_unit_px, v = (at.y - own.middle.y) / shading_unit_px;
    const std::array outside{u, v, u * u, u * v, v * v};
    double* shading = &columns[edge_tails::first_shading];
    shading[0] = lit * u, shading[1] = lit * v;
    for (std::size_t i = 0; i < outside.size(); ++i) shading[2 + i] = (1 - lit) * outside[i];
  };
}

/// Pixels that show only tails of one cut-out and shading.
struct TailRegion {
  std::vector<TailRectangle> rectangles;
  std::size_t own = 0;
  cv::Rect2d inner;
  double core = 0;

  /// Distance from the nearest border; empty for other pixels.
  [[nodiscard]] std::optional<double> distance(cv::Point2d at) const {
    if (!inner.contains(at)) return std::nullopt;
    const double from_own = local(rectangles[own], at).distance();
    double nearest = HUGE_VAL;
    for (const TailRectangle& rectangle : rectangles) {
      const double distance = local(rectangle, at).distance();
      // Bars are not squares: the area between them belongs to none.
      if (distance < from_own - 1e-9) return std::nullopt;
      nearest = std::min(nearest, std::abs(distance));
    }
    return nearest < core ? std::nullopt : std::optional(nearest);
  }
};

/// The pixels of one block as samples: single pixels, or their mean if the model is smooth.
void add_block(TailSamples& samples, const cv::Mat1d& picture, const cv::Rect& block, std::size_t number,
               const TailRegion& region, const TailColumns& columns_at, const CoarseFit& coarse) {
  double sum = 0, nearest = HUGE_VAL;
  std::vector<cv::Point> pixels;
  for (int y = block.y; y < block.br().y; ++y) {
    for (int x = block.x; x < block.br().x; ++x) {
      const auto distance = region.distance(cv::Point2d(x, y));
      if (!distance) continue;
      nearest = std::min(nearest, *distance);
      pixels.emplace_back(x, y), sum += picture(y, x);
    }
  }
  std::vector<double> columns(edge_tails::first_shading + shading_columns);
  const auto add = [&](cv::Point2d at, double value, int count) {
    columns_at(at, columns);
    samples.add(columns, (value - coarse.level) / coarse.step, count, number);
  };
  if (pixels.size() == static_cast<std::size_t>(block_px * block_px) && nearest > smooth_from_px) {
    add(cv::Point2d(block.x, block.y) + cv::Point2d(0.5, 0.5) * (block_px - 1), sum / block.area(), block.area());
    return;
  }
  for (const cv::Point& pixel : pixels) add(pixel, picture(pixel), 1);
}

}  // namespace

std::optional<PlateTails> plate_tails(const cv::Mat1d& picture, const std::vector<Polygon>& cut_outs, std::size_t which,
                                      const cv::Rect2d& plate, const TailBounds& bounds) {
  TailRegion region{.rectangles = {}, .own = which, .inner = {}};
  for (const Polygon& outline : cut_outs) region.rectangles.push_back(rectangle_of(outline));
  const auto coarse = coarse_fit(picture, region.rectangles[which]);
  if (!coarse) return std::nullopt;
  for (TailRectangle& rectangle : region.rectangles) rectangle.middle += coarse->shift;
  region.inner = cv::Rect2d(plate.x + clear_of_border_px, plate.y + clear_of_border_px,
                            plate.width - 2 * clear_of_border_px, plate.height - 2 * clear_of_border_px) &
                 cv::Rect2d(0, 0, picture.cols, picture.rows);
  region.core = std::max(1.2 * 2.563 * coarse->sigma + 1.2, 3.0);
  const TailColumns columns_at = plate_columns(region.rectangles, region.rectangles[which]);
  TailSamples samples(shading_columns);
  const int blocks_across = picture.cols / block_px + 1;
  for (int top = 0; top < picture.rows; top += block_px) {
    for (int left = 0; left < picture.cols; left += block_px) {
      const cv::Rect block = cv::Rect(left, top, block_px, block_px) & cv::Rect({0, 0}, picture.size());
      const auto number = static_cast<std::size_t>((top / (2 * block_px)) * blocks_across + left / (2 * block_px));
      add_block(samples, picture, block, number, region, columns_at, *coarse);
    }
  }
  TailBounds within = bounds;
  within.widest_pitch = std::min(bounds.widest_pitch, widest_share * std::min(region.inner.width, region.inner.height));
  auto fit = samples.fit(within);
  if (!fit) return std::nullopt;
  return PlateTails{*std::move(fit), columns_at, coarse->step};
}

PlateTails moved_to(const PlateTails& tails, cv::Point origin) {
  return {tails.fit,
          [columns = tails.columns, origin](cv::Point2d at, std::vector<double>& out) {
            columns(at + cv::Point2d(origin), out);
          },
          tails.step};
}

}  // namespace todbench
