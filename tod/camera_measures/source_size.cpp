// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/source_size.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "acquisition/base/distributions.h"
#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "tod/camera_measures/plate_offset.h"
#include "tod/camera_measures/plate_tails.h"

namespace todbench {
namespace {

constexpr double clear_of_edge_px = 2.5;  // of the window in the middle of a cut-out
constexpr int largest_window_px = 5;
constexpr double least_curve_px = 4;
constexpr double curve_ratio = 1.15;
constexpr double least_p = 0.001;
constexpr double method =
    0.001;  // of a ratio: sigmas of halos in steps, the core of the blur, pixels beside the middle

/// A square in whose middle the signal is taken.
struct Place {
  std::string name;
  bool spot = false;
  cv::Point2d middle_px;
  double size_px = 0;
  int window_px = 1;  ///< side of the square of averaged pixels, odd
};

int window_of(double size_px) {
  const int half = static_cast<int>(std::floor(0.5 * size_px - clear_of_edge_px));
  return std::clamp(2 * half + 1, 1, largest_window_px);
}

/// Name of the ring to which a rectangle belongs; empty: none.
std::string ring_of(const std::string& rectangle) {
  const auto colon = rectangle.find(':');
  return rectangle.starts_with("ring") && colon != std::string::npos ? rectangle.substr(0, colon) : std::string();
}

/// The opaque square inside the parts of a ring: the largest that touches none of them.
Place spot_of(const std::string& ring, const std::vector<Polygon>& parts) {
  cv::Point2d middle(0, 0);
  cv::Rect2d whole = box_of(parts.front());
  for (const Polygon& part : parts) whole |= box_of(part);
  middle = 0.5 * (whole.tl() + whole.br());
  double half = HUGE_VAL;
  for (const Polygon& part : parts) {
    const cv::Rect2d box = box_of(part);
    const double dx = std::max(box.x - middle.x, middle.x - box.br().x);
    const double dy = std::max(box.y - middle.y, middle.y - box.br().y);
    half = std::min(half, std::max(dx, dy));
  }
  return {ring, true, middle, 2 * half, window_of(2 * half)};
}

std::vector<Place> places_of(const TargetPlate& plate, const std::vector<Polygon>& outlines) {
  std::vector<Place> places;
  std::map<std::string, std::vector<Polygon>> rings;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    const Polygon& outline = outlines[i];
    const std::string ring = ring_of(plate.rectangles[i].name);
    if (!ring.empty()) {
      rings[ring].push_back(outline);
      continue;
    }
    const double side = std::min(cv::norm(outline[1] - outline[0]), cv::norm(outline[2] - outline[1]));
    places.push_back({plate.rectangles[i].name, false, 0.5 * (outline[0] + outline[2]), side, window_of(side)});
  }
  std::ranges::sort(places, {}, &Place::size_px);
  std::vector<Place> spots;
  for (const auto& [name, parts] : rings) spots.push_back(spot_of(name, parts));
  std::ranges::sort(spots, {}, &Place::size_px);
  places.insert(places.end(), spots.begin(), spots.end());
  return places;
}

cv::Rect window(const Place& place) {
  const cv::Point middle(static_cast<int>(std::lround(place.middle_px.x)),
                         static_cast<int>(std::lround(place.middle_px.y)));
  const int half = place.window_px / 2;
  return {middle.x - half, middle.y - half, place.window_px, place.window_px};
}

/// Noise of the mean over a window of that side in the signal, from the difference of the outer pictures. Whole windows
/// are compared, so that noise of rows and columns counts.
double noise_of_window(const cv::Mat1d& change, int side) {
  std::vector<double> means;
  for (int y = 0; y + side <= change.rows; y += side) {
    for (int x = 0; x + side <= change.cols; x += side)
      means.push_back(cv::mean(change(cv::Rect(x, y, side, side)))[0]);
  }
  const double mean = cv::mean(means)[0];
  double squares = 0;
  for (const double value : means) squares += (value - mean) * (value - mean);
  // The change holds two means of equal noise, the signal one and the mean of two: 1.5 / 2.
  return std::sqrt(0.75 * squares / std::max<double>(1, static_cast<double>(means.size()) - 1));
}

/// Spread of the pixels' responsivity: standard deviation in the middle of the reference without a plane and without
/// noise, over the signal.
double responsivity_sd(const cv::Mat1d& signal, const Place& reference, double pixel_noise_k) {
  const int half = std::max(2, static_cast<int>(0.25 * reference.size_px));
  const cv::Rect middle = window({.name = {}, .middle_px = reference.middle_px, .window_px = 2 * half + 1}) &
                          cv::Rect({0, 0}, signal.size());
  const cv::Mat1d part = signal(middle);
  cv::Matx33d gram = cv::Matx33d::zeros();
  cv::Vec3d right(0, 0, 0);
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      const cv::Vec3d row(1, x - 0.5 * (part.cols - 1), y - 0.5 * (part.rows - 1));
      gram += row * row.t(), right += part(y, x) * row;
    }
  }
  const cv::Vec3d plane = gram.solve(right, cv::DECOMP_CHOLESKY);
  double squares = 0;
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x)
      squares += std::pow(part(y, x) - plane.dot({1, x - 0.5 * (part.cols - 1), y - 0.5 * (part.rows - 1)}), 2);
  }
  const double variance = squares / (static_cast<double>(part.total()) - 3) - pixel_noise_k * pixel_noise_k;
  return std::sqrt(std::max(0.0, variance)) / std::abs(plane[0]);
}

/// Signal that the tails x give at a place, without level and shading.
double lit(const std::vector<double>& x, const std::vector<double>& columns) {
  double sum = 0;
  for (std::size_t i = edge_tails::step; i < edge_tails::first_shading; ++i) sum += x[i] * columns[i];
  return sum;
}

/// The columns of a place on the plate, averaged over its window.
std::vector<double> columns_at(const PlateTails& tails, const Place& place) {
  std::vector<double> sum(tails.fit.unknowns()), one(tails.fit.unknowns());
  const cv::Rect pixels = window(place);
  for (int y = pixels.y; y < pixels.br().y; ++y) {
    for (int x = pixels.x; x < pixels.br().x; ++x) {
      tails.columns(cv::Point2d(x, y), one);
      for (std::size_t i = 0; i < one.size(); ++i) sum[i] += one[i] / pixels.area();
    }
  }
  return sum;
}

/// The columns in the middle of a square source alone.
std::vector<double> columns_of(double side_px) {
  std::vector<double> columns(edge_tails::first_shading);
  set_tail_columns({{{0, 0}, {0.5 * side_px, 0}, {0, 0.5 * side_px}}}, {0, 0}, columns);
  return columns;
}

/// Ratio of the signals of a square source and the reference, with the extremes of the tails within 95 %.
Estimate curve_at(const PlateTails& tails, double side_px, double reference_px) {
  const std::vector<double> small = columns_of(side_px), large = columns_of(reference_px);
  const auto ratio = [&](const std::vector<double>& x) { return lit(x, small) / lit(x, large); };
  const double value = ratio(tails.fit.stated()), best = ratio(tails.fit.best());
  std::vector<double> rising(tails.fit.unknowns()), falling(tails.fit.unknowns());
  for (std::size_t i = edge_tails::step; i < edge_tails::first_shading; ++i) {
    rising[i] = small[i] - best * large[i];
    falling[i] = -rising[i];
  }
  const double high = ratio(tails.fit.farthest(rising)), low = ratio(tails.fit.farthest(falling));
  return {value, std::min({low, best, value}), std::max({high, best, value})};
}

/// The lit picture minus the mean of the others.
cv::Mat1d signal_of(const SourcePictures& pictures) {
  return pictures.lit - 0.5 * (pictures.before + pictures.after);
}

/// Compares the points with the fitted tails, and widens the curve if noise does not explain the distance.
void compare_points(SourceSize& found, const PlateTails& tails, const std::vector<Place>& places,
                    const std::vector<double>& u) {
  const std::vector<double>& x = tails.fit.stated();
  const double reference = lit(x, columns_at(tails, places.back()));
  double farthest = 0;
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    SourceSizePoint& point = found.points[i];
    point.fitted = lit(x, columns_at(tails, places[i])) / reference;
    const double apart = point.ratio.value - point.fitted;
    const Estimate of_fit = found.loss(point.size_px);
    const double fit_u = 0.5 * (of_fit.high - of_fit.low) / normal_z95;
    found.chi2 += apart * apart / (u[i] * u[i] + fit_u * fit_u);
    farthest = std::max(farthest, std::abs(apart));
  }
  found.degrees_of_freedom = static_cast<int>(found.points.size());
  found.consistent = 1 - cdf(distribution::ChiSquared(found.degrees_of_freedom), found.chi2) > least_p;
  if (found.consistent) return;
  for (std::size_t i = 0; i < found.ratio.size(); ++i) {
    // Nothing is lost at the side of the reference itself.
    if (found.size_px[i] >= found.reference_px) continue;
    found.ratio[i].low -= farthest, found.ratio[i].high += farthest;
  }
}

}  // namespace

Estimate SourceSize::loss(double side_px) const {
  const auto next = std::ranges::lower_bound(size_px, side_px);
  const auto at = static_cast<std::size_t>(std::distance(size_px.begin(), next));
  const std::size_t above = std::min(at, size_px.size() - 1), below = above > 0 ? above - 1 : 0;
  const double span = size_px[above] - size_px[below];
  const double share = span > 0 ? std::clamp((side_px - size_px[below]) / span, 0.0, 1.0) : 0;
  const auto between = [&](double Estimate::*member) {
    return 1 - (ratio[below].*member + share * (ratio[above].*member - ratio[below].*member));
  };
  return {between(&Estimate::value), between(&Estimate::high), between(&Estimate::low)};
}

Result<SourceSize> source_size(const SourcePictures& pictures, const TargetPlate& mounted_plate,
                               const Registration& where) {
  const cv::Mat1d change = pictures.after - pictures.before;
  cv::Mat1d signal = signal_of(pictures);
  if (!cv::checkRange(signal) || !cv::checkRange(change))
    return fail(ErrorCode::invalid_input, "the picture contains a value that is not finite");
  std::vector<Polygon> outlines;
  for (const PlateRectangle& rectangle : mounted_plate.rectangles) {
    outlines.push_back(outline_mm(rectangle));
    for (cv::Point2d& corner : outlines.back()) corner = where.pixel(corner);
  }
  if (outlines.empty())
    return fail(ErrorCode::invalid_input, "plate '" + mounted_plate.name +
                                              "' has no rectangles: the size-of-source "
                                              "effect needs square apertures");
  TODBENCH_TRY(const auto moved, plate_offset(signal, outlines, mounted_plate.name));
  for (Polygon& outline : outlines)
    for (cv::Point2d& corner : outline) corner += moved;
  std::vector<Place> places = places_of(mounted_plate, outlines);
  const auto last_aperture = std::ranges::find_if(places, &Place::spot) - places.begin();
  if (last_aperture < 2)
    return fail(
        ErrorCode::invalid_input,
        "plate '" + mounted_plate.name + "' has fewer than two apertures: the size-of-source effect compares them");
  // The reference last: it is no point of its own.
  std::rotate(places.begin() + last_aperture - 1, places.begin() + last_aperture, places.end());
  const Place reference = places.back();
  const cv::Rect frame({0, 0}, signal.size());
  for (const Place& place : places) {
    if ((window(place) & frame) != window(place))
      return fail(ErrorCode::calibration, "'" + place.name + "' of plate '" + mounted_plate.name +
                                              "' is outside the picture: use a smaller plate or a larger distance");
  }

  // Plate and source rise alike: the camera shows the contrast and the rise on the same scale.
  signal -= cv::mean(signal(window(reference)))[0] * pictures.plate_rise / (1 + pictures.plate_rise);

  std::size_t which = 0;
  while (mounted_plate.rectangles[which].name != reference.name) ++which;
  const double w = mounted_plate.width_mm / 2, h = mounted_plate.height_mm / 2;
  const cv::Rect2d on_plate(where.pixel({-w, -h}) + moved, where.pixel({w, h}) + moved);
  const auto tails = plate_tails(signal, outlines, which, on_plate, {.most_halo = 0.5});
  const double level_k = cv::mean(signal(window(reference)))[0];
  const double pixel_noise_k = noise_of_window(change, 1);
  if (!tails || !(std::abs(level_k) > 10 * pixel_noise_k))
    return fail(ErrorCode::calibration,
                "the reference aperture of plate '" + mounted_plate.name + "' has no signal: choose a larger contrast");

  SourceSize found{.reference_px = reference.size_px, .reference_k = level_k};
  const double spread = responsivity_sd(signal, reference, pixel_noise_k);
  std::map<int, double> noise_k;
  const auto relative_u = [&](const Place& place, double ratio) {
    auto known = noise_k.find(place.window_px);
    if (known == noise_k.end())
      known = noise_k.emplace(place.window_px, noise_of_window(change, place.window_px)).first;
    return std::hypot(known->second / level_k, ratio * spread / place.window_px);
  };
  const double reference_u = relative_u(reference, 1);
  found.reference_u_k = reference_u * std::abs(level_k);
  // A drift that bends: a quarter of the change between the outer pictures.
  const double drift = 0.25 * std::abs(cv::mean(change)[0] / level_k);
  std::vector<double> u;
  for (const Place& place : std::span(places).first(places.size() - 1)) {
    const double ratio = cv::mean(signal(window(place)))[0] / level_k;
    u.push_back(std::hypot(relative_u(place, ratio), ratio * reference_u, drift * (1 - ratio)));
    found.points.push_back(
        {place.name, place.spot, place.size_px, {ratio, ratio - normal_z95 * u.back(), ratio + normal_z95 * u.back()}});
  }
  for (double side = least_curve_px; side < reference.size_px; side *= curve_ratio) found.size_px.push_back(side);
  found.size_px.push_back(reference.size_px);
  for (const double side : found.size_px) {
    Estimate ratio = curve_at(*tails, side, reference.size_px);
    if (side < reference.size_px) ratio.low -= method, ratio.high += method;
    found.ratio.push_back(ratio);
  }
  compare_points(found, *tails, places, u);
  return found;
}

}  // namespace todbench
