// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/shift_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "tod/registration/blurred_polygon.h"

namespace todbench {
namespace {

using Column = std::vector<double>;

double dot(const Column& a, const Column& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// v - share * u
void subtract(Column& v, const Column& u, double share) {
  for (std::size_t i = 0; i < v.size(); ++i) v[i] -= share * u[i];
}

Column column(const cv::Mat1d& picture, cv::Rect window) {
  Column values;
  values.reserve(static_cast<std::size_t>(window.area()));
  for (int y = window.y; y < window.y + window.height; ++y) {
    for (int x = window.x; x < window.x + window.width; ++x) values.push_back(picture(y, x));
  }
  return values;
}

Column column(const cv::Mat1d& whole) {
  return column(whole, cv::Rect({0, 0}, whole.size()));
}

/// Removes the best plane (an unknown background with its gradient) from v. In a rectangle centred coordinates are
/// orthogonal.
void remove_plane(Column& v, cv::Size size) {
  const double cx = (size.width - 1) / 2.0;
  const double cy = (size.height - 1) / 2.0;
  double s = 0, sx = 0, sy = 0, xx = 0, yy = 0;
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x, ++i) {
      s += v[i];
      sx += v[i] * (x - cx);
      sy += v[i] * (y - cy);
      xx += (x - cx) * (x - cx);
      yy += (y - cy) * (y - cy);
    }
  }
  i = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x, ++i) v[i] -= s / size.area() + sx / xx * (x - cx) + sy / yy * (y - cy);
  }
}

constexpr double window_margin_px = 3;

cv::Rect window_round(const Polygon& polygon, cv::Point2d shift) {
  double left = polygon[0].x, right = left, top = polygon[0].y, bottom = top;
  for (const cv::Point2d& p : polygon) {
    left = std::min(left, p.x);
    right = std::max(right, p.x);
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
  }
  const cv::Point low(static_cast<int>(std::floor(left + shift.x - window_margin_px)),
                      static_cast<int>(std::floor(top + shift.y - window_margin_px)));
  const cv::Point high(static_cast<int>(std::ceil(right + shift.x + window_margin_px)),
                       static_cast<int>(std::ceil(bottom + shift.y + window_margin_px)));
  return {low, cv::Size(high.x - low.x + 1, high.y - low.y + 1)};
}

bool contains(const cv::Mat1d& picture, cv::Rect window) {
  return window.x >= 0 && window.y >= 0 && window.x + window.width <= picture.cols &&
         window.y + window.height <= picture.rows;
}

Polygon moved_by(const Polygon& polygon, cv::Point2d shift) {
  Polygon result = polygon;
  for (cv::Point2d& p : result) p += shift;
  return result;
}

/// The linearised comparison at one shift. Contrast and plane of each polygon are projected out (variable projection),
/// so that only the shift remains.
struct Linearised {
  cv::Matx22d normal = cv::Matx22d::zeros();
  cv::Vec2d gradient{0, 0};
  double residual = 0, total = 0;  ///< sums of squares
  double overlap = 0, energy = 0;  ///< template times picture, template squared
  int samples = 0;
  std::vector<double> amplitudes, energies;
};

void add(Linearised& sum, Column data, const BlurredPolygon& model, cv::Size size) {
  Column shape = column(model.value);
  Column dx = column(model.d_shift_x);
  Column dy = column(model.d_shift_y);
  for (Column* c : {&data, &shape, &dx, &dy}) remove_plane(*c, size);
  const double energy = dot(shape, shape);
  const double overlap = dot(shape, data);
  const double amplitude = overlap / energy;
  sum.total += dot(data, data);
  subtract(data, shape, amplitude);
  subtract(dx, shape, dot(dx, shape) / energy);
  subtract(dy, shape, dot(dy, shape) / energy);
  sum.residual += dot(data, data);
  sum.normal += amplitude * amplitude * cv::Matx22d(dot(dx, dx), dot(dx, dy), dot(dx, dy), dot(dy, dy));
  sum.gradient += amplitude * cv::Vec2d(dot(dx, data), dot(dy, data));
  sum.overlap += overlap;
  sum.energy += energy;
  sum.samples += size.area();
  sum.amplitudes.push_back(amplitude);
  sum.energies.push_back(energy);
}

ShiftFit summary(const Linearised& at, cv::Point2d shift) {
  ShiftFit fit;
  fit.shift = shift;
  fit.amplitudes = at.amplitudes;
  // Four parameters per polygon (contrast and plane) and two of the shift.
  const double freedom = std::max(1.0, at.samples - 4.0 * static_cast<double>(at.amplitudes.size()) - 2);
  const double variance = at.residual / freedom;
  const cv::Matx22d covariance = at.normal.inv() * variance;
  fit.standard_error = {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1))};
  fit.residual_rms = std::sqrt(variance);
  fit.unexplained = at.total > 0 ? at.residual / at.total : 1;
  // Noise under one common contrast includes the scatter of the contrasts.
  const double common = at.overlap / at.energy;
  const double common_variance = std::max(0.0, at.total - common * at.overlap) / freedom;
  fit.joint_significance =
      common_variance > 0 ? common / std::sqrt(common_variance / at.energy) : (common > 0 ? 1e9 : -1e9);
  for (const double energy : at.energies) fit.amplitude_errors.push_back(std::sqrt(variance / energy));
  return fit;
}

/// Data on the place of one polygon: the picture without contrast and background, and its derivatives by the shift.
struct PlaceWindow {
  cv::Rect window;
  cv::Point2d from_centre;
  Column data, shape, dx, dy;

  /// Derivatives of a pixel by shift and rotation, for a contrast of 1.
  [[nodiscard]] cv::Vec3d derivative(std::size_t i) const {
    return {dx[i], dy[i], from_centre.x * dy[i] - from_centre.y * dx[i]};
  }
};

cv::Point2d middle(const Polygon& polygon) {
  cv::Point2d sum(0, 0);
  for (const cv::Point2d& p : polygon) sum += p;
  return sum / static_cast<double>(polygon.size());
}

/// One number for each parameter of fit_place(): shift x, shift y and rotation, then the amplitude.
struct ParameterTerms {
  cv::Vec3d place;
  double amplitude = 0;
};

/// The largest variances of three assumptions on the noise: white, common to rows, common to columns.
ParameterTerms largest_variances(std::span<const PlaceWindow> windows, const cv::Matx33d& inverse, double amplitude,
                                 const cv::Vec3d& found, double energy, double white) {
  std::map<int, ParameterTerms> rows, columns;  // scores
  for (const PlaceWindow& w : windows) {
    for (std::size_t i = 0; i < w.data.size(); ++i) {
      const cv::Vec3d derivative = amplitude * w.derivative(i);
      const double residual = w.data[i] - derivative.dot(found);
      const int at = static_cast<int>(i);
      for (ParameterTerms* line : {&rows[w.window.y + at / w.window.width], &columns[w.window.x + at % w.window.width]})
        line->place += residual * derivative, line->amplitude += residual * w.shape[i] / energy;
    }
  }
  ParameterTerms largest{white * cv::Vec3d(inverse(0, 0), inverse(1, 1), inverse(2, 2)), white / energy};
  for (const auto* clusters : {&rows, &columns}) {
    cv::Matx33d middle_part = cv::Matx33d::zeros();
    double of_amplitude = 0;
    for (const auto& [index, score] : *clusters) {
      middle_part += score.place * score.place.t();
      of_amplitude += score.amplitude * score.amplitude;
    }
    const cv::Matx33d covariance = inverse * middle_part * inverse;
    for (int k = 0; k < 3; ++k) largest.place[k] = std::max(largest.place[k], covariance(k, k));
    largest.amplitude = std::max(largest.amplitude, of_amplitude);
  }
  return largest;
}

}  // namespace

cv::Rect place_window(const Polygon& polygon) {
  return window_round(polygon, {0, 0});
}

std::optional<PlaceFit> fit_place(const cv::Mat1d& picture, std::span<const Polygon> polygons, double blur_px,
                                  cv::Point2d centre) {
  std::vector<PlaceWindow> windows;
  double energy = 0, overlap = 0, residual = 0, samples = 0;
  cv::Matx33d normal = cv::Matx33d::zeros();
  cv::Vec3d gradient(0, 0, 0);
  for (const Polygon& polygon : polygons) {
    PlaceWindow w{.window = place_window(polygon),
                  .from_centre = middle(polygon) - centre,
                  .data = {},
                  .shape = {},
                  .dx = {},
                  .dy = {}};
    if (!contains(picture, w.window)) return std::nullopt;
    const BlurredPolygon model = blurred_polygon(polygon, blur_px, w.window);
    w.data = column(picture, w.window), w.shape = column(model.value);
    w.dx = column(model.d_shift_x), w.dy = column(model.d_shift_y);
    for (Column* c : {&w.data, &w.shape, &w.dx, &w.dy}) remove_plane(*c, w.window.size());
    const double own_energy = dot(w.shape, w.shape), own_overlap = dot(w.shape, w.data);
    energy += own_energy, overlap += own_overlap;
    // Each has its own contrast here, so that a slightly wrong blur does not look like a shift.
    for (Column* c : {&w.dx, &w.dy}) subtract(*c, w.shape, dot(*c, w.shape) / own_energy);
    subtract(w.data, w.shape, own_overlap / own_energy);
    for (std::size_t i = 0; i < w.data.size(); ++i) {
      const cv::Vec3d derivative = w.derivative(i);
      normal += derivative * derivative.t();
      gradient += derivative * w.data[i];
    }
    residual += dot(w.data, w.data);
    samples += w.window.area();
    windows.push_back(std::move(w));
  }
  if (windows.size() < 3) {
    for (int k = 0; k < 3; ++k) normal(2, k) = normal(k, 2) = k == 2 ? 1 : 0;
    gradient[2] = 0;
  }
  if (!(energy > 0) || !(cv::determinant(normal) > 0) || overlap == 0) return std::nullopt;
  PlaceFit fit;
  fit.amplitude = overlap / energy;
  const cv::Vec3d found = normal.inv() * gradient / fit.amplitude;
  residual = std::max(0.0, residual - fit.amplitude * found.dot(gradient));
  // Four parameters of each polygon, shift and rotation.
  const double variance = residual / std::max(1.0, samples - 4.0 * static_cast<double>(windows.size()) - 3);
  const cv::Matx33d inverse = normal.inv() * (1 / (fit.amplitude * fit.amplitude));
  const ParameterTerms largest = largest_variances(windows, inverse, fit.amplitude, found, energy, variance);
  const cv::Vec3d& errors = largest.place;
  fit.amplitude_error = std::sqrt(largest.amplitude);
  fit.shift = {found[0], found[1]};
  fit.standard_error = {std::sqrt(errors[0]), std::sqrt(errors[1])};
  if (windows.size() >= 3) fit.turn_rad = found[2], fit.turn_error_rad = std::sqrt(errors[2]);
  fit.residual_rms = std::sqrt(variance);
  return fit;
}

std::optional<ShiftFit> fit_shift(const cv::Mat1d& picture, std::span<const Polygon> polygons, double blur_px,
                                  cv::Point2d start, double reach_px) {
  std::vector<cv::Rect> windows;
  std::vector<Column> data;
  for (const Polygon& polygon : polygons) {
    windows.push_back(window_round(polygon, start));
    if (!contains(picture, windows.back())) return std::nullopt;
    data.push_back(column(picture, windows.back()));
  }
  constexpr int most_steps = 30;
  constexpr double longest_step_px = 0.7;  // valid range of Gauss-Newton: about the width of an edge
  constexpr double enough_px = 1e-4;
  cv::Point2d shift = start;
  for (int step = 0; step < most_steps; ++step) {
    Linearised at;
    for (std::size_t k = 0; k < polygons.size(); ++k) {
      add(at, data[k], blurred_polygon(moved_by(polygons[k], shift), blur_px, windows[k]), windows[k].size());
    }
    if (!(cv::determinant(at.normal) > 0)) return std::nullopt;
    const cv::Vec2d wanted = at.normal.inv() * at.gradient;
    const double length = cv::norm(wanted);
    if (!std::isfinite(length)) return std::nullopt;
    if (length < enough_px) return summary(at, shift + cv::Point2d(wanted[0], wanted[1]));
    const double share = std::min(1.0, longest_step_px / length);
    shift += share * cv::Point2d(wanted[0], wanted[1]);
    if (cv::norm(shift - start) > reach_px) return std::nullopt;
  }
  return std::nullopt;
}

double misfit(const cv::Mat1d& picture, std::span<const Polygon> polygons, double blur_px) {
  Linearised at;
  for (const Polygon& polygon : polygons) {
    const cv::Rect window = window_round(polygon, {0, 0});
    if (!contains(picture, window)) continue;
    add(at, column(picture, window), blurred_polygon(polygon, blur_px, window), window.size());
  }
  return at.residual;
}

std::optional<cv::Point> coarse_offset(const cv::Mat1d& picture, std::span<const Polygon> polygons, double blur_px,
                                       int reach_px) {
  std::vector<cv::Rect> windows;
  std::vector<Column> shapes;
  double energy = 0;
  for (const Polygon& polygon : polygons) {
    windows.push_back(window_round(polygon, {0, 0}));
    shapes.push_back(column(blurred_polygon(polygon, blur_px, windows.back()).value));
    remove_plane(shapes.back(), windows.back().size());
    energy += dot(shapes.back(), shapes.back());
  }
  std::optional<cv::Point> best;
  double best_share = -1;
  for (int y = -reach_px; y <= reach_px; ++y) {
    for (int x = -reach_px; x <= reach_px; ++x) {
      double overlap = 0;
      double total = 0;
      bool inside = true;
      for (std::size_t k = 0; inside && k < windows.size(); ++k) {
        const cv::Rect window = windows[k] + cv::Point(x, y);
        inside = contains(picture, window);
        if (!inside) break;
        Column data = column(picture, window);
        remove_plane(data, window.size());
        overlap += dot(shapes[k], data);
        total += dot(data, data);
      }
      const double share = total > 0 ? overlap * overlap / (energy * total) : 0;
      if (!inside || share <= best_share) continue;
      best_share = share;
      best = cv::Point(x, y);
    }
  }
  return best;
}

}  // namespace todbench
