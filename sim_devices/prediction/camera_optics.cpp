// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/camera_optics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "acquisition/base/median.h"
#include "sim_devices/sensor/image_chain.h"
#include "tod/plate/plate_outlines.h"

namespace todbench {
namespace {

constexpr double reach_px = 3;                                     ///< outside a triangle
constexpr double least_ratio = 0.45, most_ratio = 2.2;             ///< of f-numbers
constexpr double most_variance = 4;                                ///< of the aberration, pitch^2
constexpr double variance_step = 0.01, ratio_step = 0.02;          ///< of the derivatives
constexpr double model_error = 1e-4;                               ///< of a picture of contrast 1
constexpr double outlier = 8, robust_outlier = 4;                  ///< standard deviations
constexpr double most_outliers = 0.05;                             ///< share of the pixels
constexpr int nuisances = 6;                                       ///< of a triangle: amplitude, plane, shift
constexpr double most_variance_move = 0.1, most_ratio_move = 0.3;  ///< of an iteration
constexpr int most_iterations = 40;

double signed_distance(const Polygon& polygon, cv::Point2d at) {
  double inside = std::numeric_limits<double>::infinity(), nearest = inside;
  const double orientation = (polygon[1] - polygon[0]).cross(polygon[2] - polygon[1]) > 0 ? 1 : -1;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const cv::Point2d edge = polygon[(i + 1) % polygon.size()] - polygon[i], to = at - polygon[i];
    inside = std::min(inside, orientation * edge.cross(to) / cv::norm(edge));
    nearest = std::min(nearest, cv::norm(to - std::clamp(to.dot(edge) / edge.dot(edge), 0.0, 1.0) * edge));
  }
  return inside >= 0 ? inside : -nearest;
}

cv::Rect bounds(const Polygon& polygon, double margin) {
  cv::Point2d low = polygon[0], high = polygon[0];
  for (const cv::Point2d& p : polygon) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const cv::Point from(static_cast<int>(std::floor(low.x - margin)), static_cast<int>(std::floor(low.y - margin)));
  const cv::Point to(static_cast<int>(std::ceil(high.x + margin)), static_cast<int>(std::ceil(high.y + margin)));
  return {from, to + cv::Point(1, 1)};
}

/// A large triangle and the pixels in which it is compared.
struct Window {
  cv::Rect rect;
  Polygon shape_pitch;   ///< about its centroid
  cv::Point2d centroid;  ///< px
  std::vector<cv::Point> pixels;
  std::vector<char> used;
  cv::Point2d shift{};  ///< px
};

/// Images of one shape at the optics of the estimate, and one step away in either parameter.
struct Images {
  PolygonImage at, wider, slower;
};

class Renderer {
 public:
  Renderer(const SensorSpec& twin, const SensorPlan& plan, const cv::Vec2d& theta, int wavelengths)
      : at_(spec(twin, theta), plan, accuracy(wavelengths)),
        wider_(spec(twin, theta + cv::Vec2d(variance_step, 0)), plan, accuracy(wavelengths)),
        slower_(spec(twin, theta + cv::Vec2d(0, ratio_step)), plan, accuracy(wavelengths)) {}

  [[nodiscard]] Images images(const Polygon& shape) const {
    return {at_.image(shape), wider_.image(shape), slower_.image(shape)};
  }

 private:
  static SensorSpec spec(SensorSpec twin, cv::Vec2d theta) {
    twin.aberration_sigma_pitch = std::sqrt(std::max(0.0, theta[0]));
    twin.f_number *= theta[1];
    return twin;
  }
  /// Folded signal due to periodicity is part of the background, which is fitted.
  static Accuracy accuracy(int wavelengths) {
    Accuracy out = Accuracy::draft();
    out.wavelengths = wavelengths;
    out.band_tolerance = 1e-4;
    return out;
  }
  ImageChain at_, wider_, slower_;
};

/// Residuals of a window and their derivatives: the two common parameters, then the nuisance parameters.
struct Expansion {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd values;
  Eigen::MatrixXd unit;  ///< value, d variance, d ratio, d x, d y of the picture of contrast 1
};

Expansion expansion_of(const cv::Mat1d& picture, const Window& window, const Images& images, int samples) {
  const double step = 1.0 / samples;
  const cv::Point2d corner(window.rect.x - window.centroid.x - window.shift.x,
                           window.rect.y - window.centroid.y - window.shift.y);
  const auto sampled = [&](const PolygonImage& image, cv::Point2d moved) {
    return image.sample((corner - moved) * step, step, window.rect.size());
  };
  constexpr double h = 0.01;
  const cv::Mat1d value = sampled(images.at, {}), wider = sampled(images.wider, {}),
                  slower = sampled(images.slower, {});
  const cv::Mat1d right = sampled(images.at, {h, 0}), left = sampled(images.at, {-h, 0});
  const cv::Mat1d down = sampled(images.at, {0, h}), up = sampled(images.at, {0, -h});
  const auto n = static_cast<Eigen::Index>(window.pixels.size());
  Expansion out{Eigen::MatrixXd::Zero(n, nuisances + 2), Eigen::VectorXd(n), Eigen::MatrixXd(n, 5)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const cv::Point at = window.pixels[static_cast<std::size_t>(i)];
    const cv::Point in = at - window.rect.tl();
    out.values(i) = picture(at);
    out.unit(i, 0) = value(in);
    out.unit(i, 1) = (wider(in) - value(in)) / variance_step;
    out.unit(i, 2) = (slower(in) - value(in)) / ratio_step;
    out.unit(i, 3) = (right(in) - left(in)) / (2 * h);
    out.unit(i, 4) = (down(in) - up(in)) / (2 * h);
    out.jacobian(i, 2) = value(in);
    out.jacobian(i, 3) = 1;
    out.jacobian(i, 4) = at.x - window.centroid.x;
    out.jacobian(i, 5) = at.y - window.centroid.y;
  }
  return out;
}

/// Amplitude and plane for the present shape, and residuals of the pixels in use.
struct Linear {
  double amplitude = 0;
  Eigen::VectorXd residuals;
};

Linear linear_fit(const Expansion& expansion, const std::vector<char>& used) {
  Eigen::MatrixXd base = expansion.jacobian.middleCols(2, 4);
  Eigen::VectorXd values = expansion.values;
  for (Eigen::Index i = 0; i < base.rows(); ++i) {
    if (used[static_cast<std::size_t>(i)]) continue;
    base.row(i).setZero();
    values(i) = 0;
  }
  const Eigen::Vector4d found = base.colPivHouseholderQr().solve(values);
  return {found(0), expansion.values - expansion.jacobian.middleCols(2, 4) * found};
}

/// Marks pixels far from the model: residuals beyond eight times the noise and four times the spread of all residuals,
/// which outliers increase; if these are more than 5 %, only the worst. Pixels that were marked wrongly return when the
/// fit has moved.
bool leave_out(Window& window, const Eigen::VectorXd& residuals, double noise) {
  std::vector<double> sizes;
  for (Eigen::Index i = 0; i < residuals.size(); ++i) sizes.push_back(std::abs(residuals(i)));
  std::vector<double> sorted = sizes;
  const auto most = static_cast<std::ptrdiff_t>(most_outliers * static_cast<double>(sizes.size()));
  std::nth_element(sorted.begin(), sorted.begin() + most, sorted.end(), std::greater<>());
  const double limit =
      std::max({outlier * noise, robust_outlier * 1.4826 * median(sizes), sorted[static_cast<std::size_t>(most)]});
  std::vector<char> used;
  for (const double size : sizes) used.push_back(size <= limit ? 1 : 0);
  const bool changed = used != window.used;
  window.used = std::move(used);
  return changed;
}

std::vector<Window> windows_of(const OpticsPicture& shown, const std::vector<Polygon>& outlines, int samples) {
  std::vector<Window> out;
  const cv::Rect whole({}, shown.picture.size());
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const PlateTriangle& t = shown.mounted_plate.triangles[k];
    if (t.size_mm * shown.registration.scale_at(t.position_mm) < shown.min_size_px) continue;
    Window window{.rect = bounds(outlines[k], reach_px),
                  .shape_pitch = {},
                  .centroid = centroid(outlines[k]),
                  .pixels = {},
                  .used = {}};
    if ((window.rect & whole) != window.rect) continue;
    for (const cv::Point2d& corner : outlines[k])
      window.shape_pitch.push_back((corner - window.centroid) * (1.0 / samples));
    for (int y = window.rect.y; y < window.rect.br().y; ++y) {
      for (int x = window.rect.x; x < window.rect.br().x; ++x) {
        const cv::Point2d at(x, y);
        if (signed_distance(outlines[k], at) < -reach_px) continue;
        const bool free = std::ranges::none_of(outlines, [&](const Polygon& other) {
          return &other != &outlines[k] && signed_distance(other, at) > -reach_px;
        });
        if (free) window.pixels.emplace_back(x, y);
      }
    }
    if (window.pixels.size() < 4 * nuisances) continue;
    window.used.assign(window.pixels.size(), 1);
    out.push_back(std::move(window));
  }
  return out;
}

/// Minimum of the parabola (curvature, slope) within the bounds.
cv::Vec2d bounded_minimum(const cv::Matx22d& curvature, const cv::Vec2d& slope) {
  const auto value = [&](const cv::Vec2d& x) { return 0.5 * x.dot(curvature * x) + slope.dot(x); };
  const auto inside = [](const cv::Vec2d& x) {
    return x[0] >= 0 && x[0] <= most_variance && x[1] >= least_ratio && x[1] <= most_ratio;
  };
  const double determinant = cv::determinant(curvature);
  if (determinant > 1e-12 * curvature(0, 0) * curvature(1, 1)) {
    const cv::Vec2d free = curvature.inv() * -slope;
    if (inside(free)) return free;
  }
  cv::Vec2d best(0, 1);
  double lowest = std::numeric_limits<double>::infinity();
  const auto try_one = [&](const cv::Vec2d& x) {
    if (!(value(x) < lowest)) return;
    lowest = value(x);
    best = x;
  };
  for (const double variance : {0.0, most_variance})
    try_one(
        {variance, std::clamp(-(slope[1] + curvature(1, 0) * variance) / curvature(1, 1), least_ratio, most_ratio)});
  for (const double ratio : {least_ratio, most_ratio})
    try_one({std::clamp(-(slope[0] + curvature(0, 1) * ratio) / curvature(0, 0), 0.0, most_variance), ratio});
  return best;
}

}  // namespace

bool CameraOptics::differs(double probability) const {
  // A chi-square with two degrees of freedom exceeds x with probability exp(-x / 2).
  return twin_statistic > -2 * std::log(probability);
}

bool CameraOpticsFit::models(const SensorSpec& twin) {
  return twin.modules.empty() && twin.display_blur_samples == 0 && twin.edge_boost == 0 &&
         twin.display == DisplayReconstruction::sample_and_hold && twin.distortion_percent == 0 &&
         twin.distortion_r4_percent == 0 && twin.super_resolution_frames == 0 && twin.turbulence_cn2_m_minus_2_3 == 0;
}

CameraOpticsFit::CameraOpticsFit(const SensorSpec& twin, int samples_per_pitch, int wavelengths)
    : twin_(twin),
      samples_per_pitch_(samples_per_pitch),
      wavelengths_(wavelengths),
      of_twin_(std::pow(twin.aberration_sigma_pitch, 2), 1) {
  // Later processing of samples and noise is not part of the image.
  SensorSpec blurred = twin_;
  blurred.aberration_sigma_pitch = std::max(0.1, twin.aberration_sigma_pitch);
  plan_ = full_plan(blurred, {}, {});
}

CameraOpticsFit::Noise CameraOpticsFit::noise_of(const OpticsPicture& shown, const std::vector<Polygon>& outlines) {
  constexpr int side = 12;
  constexpr double clear_px = 5;
  constexpr std::size_t enough = 60;
  cv::Rect area = bounds(outlines[0], 0);
  for (const Polygon& outline : outlines) area |= bounds(outline, 0);
  area &= cv::Rect({}, shown.picture.size());
  cv::Mat1b free(shown.picture.size(), 1);
  for (const Polygon& outline : outlines) {
    const cv::Rect near = bounds(outline, clear_px) & cv::Rect({}, shown.picture.size());
    for (int y = near.y; y < near.br().y; ++y)
      for (int x = near.x; x < near.br().x; ++x)
        if (signed_distance(outline, cv::Point2d(x, y)) > -clear_px) free(y, x) = 0;
  }
  std::vector<double> variances;
  for (int top = area.y; top + side <= area.br().y; top += side) {
    for (int left = area.x; left + side <= area.br().x; left += side) {
      std::vector<cv::Vec3d> places;
      std::vector<double> values;
      for (int y = top; y < top + side; ++y) {
        for (int x = left; x < left + side; ++x) {
          if (free(y, x) == 0) continue;
          places.emplace_back(1, x - left, y - top);
          values.push_back(shown.picture(y, x));
        }
      }
      if (values.size() < enough) continue;
      // Single bad pixels do not represent the others.
      const double middle = median(values);
      std::vector<double> off;
      for (const double v : values) off.push_back(std::abs(v - middle));
      const double limit = outlier * 1.4826 * median(off);
      std::vector<Eigen::Index> kept;
      for (std::size_t i = 0; i < values.size(); ++i)
        if (std::abs(values[i] - middle) <= limit || limit == 0) kept.push_back(static_cast<Eigen::Index>(i));
      const auto n = static_cast<Eigen::Index>(kept.size());
      Eigen::MatrixXd base(n, 3);
      Eigen::VectorXd own(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto at = static_cast<std::size_t>(kept[static_cast<std::size_t>(i)]);
        for (int k = 0; k < 3; ++k) base(i, k) = places[at][k];
        own(i) = values[at] - middle;
      }
      const Eigen::VectorXd plane = base.colPivHouseholderQr().solve(own);
      variances.push_back((own - base * plane).squaredNorm() / static_cast<double>(n - 3));
    }
  }
  Noise out{.temporal_variance = shown.averaged_noise_k * shown.averaged_noise_k};
  out.blocks = static_cast<int>(variances.size());
  if (variances.size() < 4) {
    out.variance = out.temporal_variance;
    out.scatter = std::sqrt(2.0 / (side * side));
    out.blocks = 4;
    return out;
  }
  const auto count = static_cast<double>(variances.size());
  for (const double v : variances) out.variance += v / count;
  double squares = 0;
  for (const double v : variances) squares += std::pow(v / out.variance - 1, 2);
  out.scatter = out.variance > 0 ? std::sqrt(squares / (count - 1)) : 0;
  return out;
}

CameraOpticsFit::Theta CameraOpticsFit::joint(const Parabola* another) const {
  cv::Matx22d curvature = cv::Matx22d::zeros();
  cv::Vec2d slope(0, 0);
  const auto take = [&](const Parabola& one) {
    curvature += one.curvature;
    slope += one.slope - one.curvature * one.at;
  };
  for (const Parabola& one : parabolas_) take(one);
  if (another != nullptr) take(*another);
  return bounded_minimum(curvature, slope);
}

std::optional<CameraOpticsFit::Parabola> CameraOpticsFit::parabola(const OpticsPicture& shown,
                                                                   const std::vector<Polygon>& outlines,
                                                                   double noise_variance) const {
  std::vector<Window> windows = windows_of(shown, outlines, samples_per_pitch_);
  if (windows.empty()) return std::nullopt;
  Theta theta = parabolas_.empty() ? of_twin_ : joint(nullptr);
  bool checked_outliers = false;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const Renderer renderer(twin_, plan_, theta, wavelengths_);
    Parabola out{.at = theta,
                 .curvature = cv::Matx22d::zeros(),
                 .slope = {},
                 .chi2 = 0,
                 .freedom = 0,
                 .windows = static_cast<int>(windows.size())};
    std::vector<cv::Point2d> moves;
    std::vector<Eigen::Matrix2d> shift_by_theta;
    bool marked = false;
    for (Window& window : windows) {
      const Images images = renderer.images(window.shape_pitch);
      Expansion expansion = expansion_of(shown.picture, window, images, samples_per_pitch_);
      Linear linear = linear_fit(expansion, window.used);
      const double variance = noise_variance + std::pow(model_error * linear.amplitude, 2);
      if (checked_outliers && iteration > 0)
        marked = leave_out(window, linear.residuals, std::sqrt(variance)) || marked;
      expansion.jacobian.col(0) = linear.amplitude * expansion.unit.col(1);
      expansion.jacobian.col(1) = linear.amplitude * expansion.unit.col(2);
      expansion.jacobian.col(6) = linear.amplitude * expansion.unit.col(3);
      expansion.jacobian.col(7) = linear.amplitude * expansion.unit.col(4);
      double pixels = 0;
      for (Eigen::Index i = 0; i < linear.residuals.size(); ++i) {
        if (window.used[static_cast<std::size_t>(i)]) {
          ++pixels;
          continue;
        }
        expansion.jacobian.row(i).setZero();
        linear.residuals(i) = 0;
      }
      const Eigen::MatrixXd normal = expansion.jacobian.transpose() * expansion.jacobian;
      const Eigen::VectorXd right = expansion.jacobian.transpose() * linear.residuals;
      const Eigen::LDLT<Eigen::MatrixXd> own(normal.bottomRightCorner(nuisances, nuisances));
      const Eigen::MatrixXd cross = normal.topRightCorner(2, nuisances);
      const Eigen::MatrixXd back = own.solve(cross.transpose());
      const Eigen::VectorXd free = own.solve(right.tail(nuisances));
      const Eigen::Matrix2d curvature = (normal.topLeftCorner(2, 2) - cross * back) / variance;
      const Eigen::Vector2d slope = -(right.head(2) - cross * free) / variance;
      for (int i = 0; i < 2; ++i) {
        out.slope[i] += slope(i);
        for (int k = 0; k < 2; ++k) out.curvature(i, k) += curvature(i, k);
      }
      out.chi2 += (linear.residuals.squaredNorm() - right.tail(nuisances).dot(free)) / variance;
      out.freedom += pixels - nuisances;
      moves.emplace_back(free(4), free(5));
      shift_by_theta.emplace_back(back.middleRows(4, 2));
    }
    Theta next = joint(&out);
    // Far from the optimum the parabola is unreliable. The direction stays: sigma and f-number replace each other.
    Theta change = next - theta;
    change *= std::min({1.0, most_variance_move / std::max(std::abs(change[0]), 1e-9),
                        most_ratio_move / std::max(std::abs(change[1]), 1e-9)});
    next = theta + change;
    double moved = 0;
    for (std::size_t k = 0; k < windows.size(); ++k) {
      const Eigen::Vector2d with = shift_by_theta[k] * Eigen::Vector2d(change[0], change[1]);
      cv::Point2d move = moves[k] - cv::Point2d(with(0), with(1));
      const double size = cv::norm(move);
      if (!std::isfinite(size)) return std::nullopt;
      if (size > 0.3) move *= 0.3 / size;
      windows[k].shift += move;
      if (cv::norm(windows[k].shift) > 1.5) return std::nullopt;
      moved = std::max(moved, cv::norm(move));
    }
    const double chi2_gain = std::abs(0.5 * change.dot(out.curvature * change));
    const bool settled = moved < 2e-3 && chi2_gain < 0.02;
    if (settled && checked_outliers && !marked) return out;
    if (settled) checked_outliers = true;
    theta = next;
  }
  return std::nullopt;
}

bool CameraOpticsFit::add(const OpticsPicture& shown) {
  std::vector<Polygon> outlines;
  for (const PlateTriangle& t : shown.mounted_plate.triangles)
    outlines.push_back(outline_in_picture(shown.registration.plate_to_pixel, t, t.apex));
  if (outlines.empty()) return false;
  const Noise noise = noise_of(shown, outlines);
  const auto found = parabola(shown, outlines, noise.variance);
  if (!found) return false;
  parabolas_.push_back(*found);
  noises_.push_back(noise);
  return true;
}

std::optional<CameraOptics> CameraOpticsFit::result() const {
  if (parabolas_.empty()) return std::nullopt;
  const Theta theta = joint(nullptr);
  CameraOptics out{.aberration_sigma_pitch = std::sqrt(theta[0]), .f_number_ratio = theta[1]};
  out.pictures = static_cast<int>(parabolas_.size());
  cv::Matx22d curvature = cv::Matx22d::zeros();
  double chi2 = 0, rise = 0, windows = 0;
  for (const Parabola& one : parabolas_) {
    curvature += one.curvature;
    // `chi2` belongs to the place `one.at`, which is not the minimum of the parabola.
    const auto at = [&](const Theta& where) {
      const cv::Vec2d off = where - one.at;
      return one.chi2 + 2 * one.slope.dot(off) + off.dot(one.curvature * off);
    };
    chi2 += at(theta);
    rise += at(of_twin_) - at(theta);
    out.degrees_of_freedom += one.freedom;
    windows += one.windows;
  }
  out.degrees_of_freedom -= 2;
  double scatter = 0, blocks = 0, temporal = 0, variance = 0;
  for (const Noise& noise : noises_) {
    const auto n = static_cast<double>(noises_.size());
    scatter += noise.scatter / n;
    blocks += noise.blocks;
    temporal += noise.temporal_variance / n;
    variance += noise.variance / n;
  }
  const auto pictures = static_cast<double>(noises_.size());
  // Fixed pattern is the same in all pictures, so they count as one picture for it.
  const double fixed = variance > 0 && temporal > 0 ? std::clamp(1 - temporal / variance, 0.0, 1.0) : 0;
  const double together = (1 - fixed) * (1 - fixed) + fixed * fixed * pictures;
  out.chi2 = chi2 / out.degrees_of_freedom;
  out.chi2_limit = 1 + 4 * scatter * std::sqrt(together * (1 / windows + 1 / blocks));
  const double inflation = std::max(1.0, out.chi2) * (1 + fixed * (pictures - 1));
  out.twin_statistic = std::max(0.0, rise) / inflation;
  const cv::Matx22d covariance = curvature.inv(cv::DECOMP_SVD) * inflation;
  out.f_number_ratio_se = std::sqrt(std::max(0.0, covariance(1, 1)));
  // At zero blur, sigma is not a smooth function of its square.
  const double variance_se = std::sqrt(std::max(0.0, covariance(0, 0)));
  out.aberration_se_pitch =
      theta[0] > variance_se ? variance_se / (2 * out.aberration_sigma_pitch) : 0.5 * std::sqrt(variance_se);
  out.noise_k = std::sqrt(variance);
  out.fixed_pattern_k = std::sqrt(std::max(0.0, variance - temporal));
  out.fixed_pattern_variance_se_k2 = variance * scatter / std::sqrt(blocks / pictures);
  return out;
}

}  // namespace todbench
