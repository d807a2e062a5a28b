// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/scene_image.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "hvs/shape/gauss_legendre.h"
#include "sim_devices/sensor/cell_responses.h"
#include "sim_devices/sensor/effect_readout.h"

namespace todbench {
namespace {

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int margin_pitches = 48;

/// Pitches beyond the margin from which a halo spreads light into the frame.
int halo_margin_pitches(const SensorSpec& spec, const SensorPlan& plan) {
  const double most_samples = std::max(1.0, 1 / spec.pitch_aspect());
  return static_cast<int>(std::ceil(most_samples * spread_of({.spec = spec, .plan = plan}).halo_reach));
}

/// Elements of a picture that overlap a cell along one axis, with the integral of each polynomial over each of them.
struct Overlap {
  int first = 0, count = 0;
  std::vector<double> integrals;  ///< [element][order]
};
/// Cell i reaches from i to i + 1; element k is centred at first + k size.
std::vector<Overlap> overlaps(int cells, int elements, double size, double first, int degree) {
  std::vector<Overlap> out(static_cast<std::size_t>(cells));
  const double start = first - size / 2;
  for (int cell = 0; cell < cells; ++cell) {
    Overlap& own = out[static_cast<std::size_t>(cell)];
    const int begin = std::max(0, static_cast<int>(std::floor((cell - start) / size)));
    const int end = std::min(elements, static_cast<int>(std::ceil((cell + 1 - start) / size)));
    if (end <= begin) continue;
    own.first = begin;
    own.count = end - begin;
    for (int k = begin; k < end; ++k) {
      const double x0 = std::clamp(start + k * size - cell, 0.0, 1.0) - 0.5;
      const double x1 = std::clamp(start + (k + 1) * size - cell, 0.0, 1.0) - 0.5;
      const LegendreValues low = legendre(x0, degree), high = legendre(x1, degree);
      own.integrals.push_back(x1 - x0);
      for (std::size_t a = 1; a <= static_cast<std::size_t>(degree); ++a) own.integrals.push_back(high.q[a] - low.q[a]);
    }
  }
  return out;
}

}  // namespace

struct SceneImager::Tables {
  SensorSpec spec;
  SensorPlan plan;
  SampleTransfer transfer;
  cv::Point2d way_pitch;  ///< between the fields of an interlaced frame
  int margin;             ///< samples
  int degree;
  std::vector<std::pair<int, int>> pairs;
  cv::Mat1f responses;

  Tables(SensorSpec s, SensorPlan p, const Accuracy& accuracy, SceneMotion motion)
      : spec(std::move(s)),
        plan(std::move(p)),
        transfer({.spec = spec, .plan = plan, .wavelengths = accuracy.wavelengths, .motion = motion}, accuracy),
        way_pitch(plan.simulates(Effect::readout) ? way_between_fields(spec, motion) : cv::Point2d(0, 0)),
        margin((margin_pitches + halo_margin_pitches(spec, plan)) * spec.samples_per_pitch()),
        degree(std::clamp(static_cast<int>(std::ceil(2.4 * transfer.band_per_sample())) + 3, 4, largest_degree)),
        pairs(legendre_pairs(degree)),
        responses(coefficient_responses(transfer, degree)) {}
};

/// Means of the cells, and coefficients of the cells that have any.
struct SceneImager::Cells {
  cv::Mat1d inside, steps;        ///< of the column itself, and of all columns to its right
  cv::Mat1i rows;                 ///< of `coefficients`; -1: none
  std::vector<cv::Point> places;  ///< by row
  std::vector<float> coefficients;
  std::size_t per_cell;
  int degree;
  std::vector<QuadratureNode> rule;

  Cells(cv::Size size, std::size_t coefficients_per_cell, int highest)
      : inside(size, 0.0),
        steps(size, 0.0),
        rows(size, -1),
        per_cell(coefficients_per_cell),
        degree(highest),
        rule(gauss_legendre(highest / 2 + 1)) {}

  float* of(int column, int row) {
    int& at = rows(row, column);
    if (at < 0) {
      at = static_cast<int>(places.size());
      places.emplace_back(column, row);
      coefficients.resize(coefficients.size() + per_cell, 0.0F);
    }
    return coefficients.data() + static_cast<std::size_t>(at) * per_cell;
  }

  /// Cell (i, j) reaches from (i, j) to (i + 1, j + 1).
  void add(StepEdge edge);
  [[nodiscard]] cv::Mat1d means() const;

 private:
  void add_left_of_picture(double y0, double y1, double step);
  void add_piece(cv::Point2d p, cv::Point2d q, double step);
};

/// A part left of the picture is a step in front of its first column.
void SceneImager::Cells::add_left_of_picture(double y0, double y1, double step) {
  const double sign = y1 > y0 ? 1 : -1;
  const double top = std::min(y0, y1), bottom = std::max(y0, y1);
  for (int row = static_cast<int>(std::floor(top)); row < bottom && row < inside.rows; ++row) {
    const double dy = std::min(bottom, row + 1.0) - std::max(top, static_cast<double>(row));
    if (row < 0 || dy <= 0) continue;
    inside(row, 0) += sign * step * dy;
    steps(row, 0) += sign * step * dy;
  }
}

/// Adds a piece of an edge within one cell.
void SceneImager::Cells::add_piece(cv::Point2d p, cv::Point2d q, double step) {
  const cv::Point2d middle = (p + q) / 2, d = q - p;
  const int column = static_cast<int>(std::floor(middle.x)), row = static_cast<int>(std::floor(middle.y));
  if (row < 0 || row >= inside.rows || column < 0 || column >= inside.cols) return;
  inside(row, column) += step * d.y * (1 - (middle.x - column));
  steps(row, column) += step * d.y;
  float* sums = of(column, row);
  const cv::Point2d centre(column + 0.5, row + 0.5);
  for (const auto& [node, weight] : rule) {
    const cv::Point2d place = middle + d * (node / 2) - centre;
    const LegendreValues x = legendre(place.x, degree), y = legendre(place.y, degree);
    const double dy = -step * d.y * weight / 2, dx = step * d.x * weight / 2;
    std::size_t k = 0;
    for (int b = 1; b <= degree; ++b) sums[k++] += static_cast<float>(dx * y.q[static_cast<std::size_t>(b)]);
    for (int a = 1; a <= degree; ++a) {
      const double factor = dy * x.q[static_cast<std::size_t>(a)];
      for (int b = 0; a + b <= degree; ++b) sums[k++] += static_cast<float>(factor * y.p[static_cast<std::size_t>(b)]);
    }
  }
}

void SceneImager::Cells::add(StepEdge edge) {
  const cv::Point2d d = edge.b - edge.a;
  // Fractions of the length between which the edge lies in the rows, and at which it crosses lines of the grid.
  double from = 0, to = 1;
  if (d.y == 0) {
    if (edge.a.y < 0 || edge.a.y >= inside.rows) return;
  } else {
    const double t0 = (0 - edge.a.y) / d.y, t1 = (inside.rows - edge.a.y) / d.y;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  if (to <= from) return;
  const double width = inside.cols;
  std::vector<double> cuts{from, to};
  const auto add_lines = [&](double start, double slope, double last) {
    if (slope == 0) return;
    const double p = std::clamp(start + slope * from, 0.0, last), q = std::clamp(start + slope * to, 0.0, last);
    for (double line = std::ceil(std::min(p, q)); line <= std::max(p, q); ++line) {
      const double t = (line - start) / slope;
      if (t > from && t < to) cuts.push_back(t);
    }
  };
  add_lines(edge.a.x, d.x, width);
  // Rows matter only within the picture; left of it, whole stretches are added at once.
  add_lines(edge.a.y, d.y, inside.rows);
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (cuts[i + 1] <= cuts[i]) continue;
    const cv::Point2d p = edge.a + d * cuts[i], q = edge.a + d * cuts[i + 1];
    const double x = (p.x + q.x) / 2;
    if (x >= width) continue;
    if (x < 0) {
      add_left_of_picture(p.y, q.y, edge.step);
    } else {
      add_piece(p, q, edge.step);
    }
  }
}

SceneImager::SceneImager(SensorSpec spec, SensorPlan plan, Accuracy accuracy, SceneMotion motion)
    : tables_(std::make_unique<const Tables>(std::move(spec), std::move(plan), accuracy, motion)) {}

SceneImager::~SceneImager() = default;

std::shared_ptr<const cv::Mat> SceneImager::cell_response(cv::Size whole) const {
  const std::scoped_lock lock(mutex_);
  auto& slot = cell_responses_[{whole.width, whole.height}];
  if (slot == nullptr) slot = std::make_shared<const cv::Mat>(unit_cell_response(tables_->transfer, whole));
  return slot;
}

cv::Mat1d SceneImager::Cells::means() const {
  cv::Mat1d out(inside.size());
  for (int j = 0; j < out.rows; ++j) {
    double left = 0;
    for (int i = 0; i < out.cols; ++i) {
      out(j, i) = left + inside(j, i);
      left += steps(j, i);
    }
  }
  return out;
}

cv::Mat1d SceneImager::means(std::span<const StepEdge> edges, cv::Size size) {
  Cells cells(size, 2, 1);
  for (const auto& edge : edges) cells.add({edge.a + cv::Point2d(0.5, 0.5), edge.b + cv::Point2d(0.5, 0.5), edge.step});
  return cells.means();
}

cv::Mat1d SceneImager::imaged(const Cells& cells, cv::Size size) const {
  const cv::Mat1d means = cells.means();
  cv::Mat spectrum;
  cv::dft(means, spectrum, cv::DFT_COMPLEX_OUTPUT);
  cv::mulSpectrums(spectrum, *cell_response(means.size()), spectrum, 0);
  cv::Mat1d filtered_means;
  cv::dft(spectrum, filtered_means, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
  cv::Mat1d out = filtered_means(cv::Rect(tables_->margin, tables_->margin, size.width, size.height)).clone();
  constexpr std::size_t chunk = 2048;
  const Eigen::Map<const FloatRows> responses(tables_->responses.ptr<float>(), tables_->responses.rows,
                                              tables_->responses.cols);
  const auto width = static_cast<Eigen::Index>(cells.per_cell);
  for (std::size_t first = 0; first < cells.places.size(); first += chunk) {
    const std::size_t count = std::min(chunk, cells.places.size() - first);
    const Eigen::Map<const FloatRows> own(cells.coefficients.data() + first * cells.per_cell,
                                          static_cast<Eigen::Index>(count), width);
    const FloatRows added = own * responses;
    for (std::size_t c = 0; c < count; ++c) {
      const cv::Point place = cells.places[first + c] - cv::Point(tables_->margin, tables_->margin);
      const float* values = added.data() + static_cast<std::ptrdiff_t>(c) * response_side * response_side;
      for (int j = std::max(-cell_reach, -place.y); j <= cell_reach && place.y + j < size.height; ++j) {
        for (int i = std::max(-cell_reach, -place.x); i <= cell_reach && place.x + i < size.width; ++i)
          out(place.y + j, place.x + i) +=
              static_cast<double>(values[(j + cell_reach) * response_side + i + cell_reach]);
      }
    }
  }
  return out;
}

cv::Size SceneImager::padded(cv::Size size) const {
  const auto up = [&](int n) {
    int best = cv::getOptimalDFTSize(n + 2 * tables_->margin);
    while (best % 2 != 0) best = cv::getOptimalDFTSize(best + 1);
    return best;
  };
  return {up(size.width), up(size.height)};
}

cv::Mat1d SceneImager::image(std::span<const StepEdge> edges, cv::Size size) const {
  const int n = tables_->spec.samples_per_pitch();
  return in_fields(tables_->way_pitch, n, [&](cv::Point2d displacement_pitch) {
    Cells cells(padded(size), tables_->pairs.size(), tables_->degree);
    const cv::Point2d shift = cv::Point2d(tables_->margin + 0.5, tables_->margin + 0.5) + displacement_pitch * n;
    for (const auto& edge : edges) cells.add({edge.a + shift, edge.b + shift, edge.step});
    return imaged(cells, size);
  });
}

cv::Mat1d SceneImager::image(const cv::Mat1d& picture, double pixel_samples, cv::Point2d first, cv::Size size) const {
  const int n = tables_->spec.samples_per_pitch();
  return in_fields(tables_->way_pitch, n, [&](cv::Point2d displacement_pitch) {
    return at_one_time(picture, pixel_samples, first + displacement_pitch * n, size);
  });
}

cv::Mat1d SceneImager::at_one_time(const cv::Mat1d& picture, double pixel_samples, cv::Point2d first,
                                   cv::Size size) const {
  CV_Assert(pixel_samples > 0 && pixel_samples <= 1 && !picture.empty());
  const int degree = tables_->degree;
  const cv::Size whole = padded(size);
  const double shift = tables_->margin + 0.5;
  const auto columns = overlaps(whole.width, picture.cols, pixel_samples, first.x + shift, degree);
  const auto rows = overlaps(whole.height, picture.rows, pixel_samples, first.y + shift, degree);
  Cells cells(whole, tables_->pairs.size(), degree);
  const auto orders = static_cast<std::size_t>(degree) + 1;
  std::vector<double> along(orders);
  std::vector<double> sums(orders * orders);
  for (int row = 0; row < whole.height; ++row) {
    const Overlap& y = rows[static_cast<std::size_t>(row)];
    for (int column = 0; column < whole.width && y.count > 0; ++column) {
      const Overlap& x = columns[static_cast<std::size_t>(column)];
      if (x.count == 0) continue;
      std::fill(sums.begin(), sums.end(), 0.0);
      for (int j = 0; j < y.count; ++j) {
        const double* values = picture[y.first + j] + x.first;
        std::fill(along.begin(), along.end(), 0.0);
        for (int i = 0; i < x.count; ++i) {
          for (std::size_t a = 0; a < orders; ++a)
            along[a] += values[i] * x.integrals[static_cast<std::size_t>(i) * orders + a];
        }
        for (std::size_t a = 0; a < orders; ++a) {
          for (std::size_t b = 0; a + b < orders; ++b)
            sums[a * orders + b] += along[a] * y.integrals[static_cast<std::size_t>(j) * orders + b];
        }
      }
      cells.inside(row, column) = sums[0];
      // Skip elements that are further from the frame than their responses reach.
      const bool near = row >= tables_->margin - cell_reach && row < tables_->margin + size.height + cell_reach &&
                        column >= tables_->margin - cell_reach && column < tables_->margin + size.width + cell_reach;
      if (!near) continue;
      float* own = cells.of(column, row);
      for (std::size_t k = 0; k < tables_->pairs.size(); ++k) {
        const auto [a, b] = tables_->pairs[k];
        own[k] = static_cast<float>(sums[static_cast<std::size_t>(a) * orders + static_cast<std::size_t>(b)]);
      }
    }
  }
  return imaged(cells, size);
}

}  // namespace todbench