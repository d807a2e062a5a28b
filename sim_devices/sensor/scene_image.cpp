#include "sim_devices/sensor/scene_image.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "hvs/shape/gauss_legendre.h"
#include "sim_devices/sensor/transfer_functions.h"

namespace todbench {
namespace {

using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int margin_pitches = 48;
constexpr int cell_reach = 6;  ///< samples beyond a cell to which its coefficients count
constexpr int response_side = 2 * cell_reach + 1;
constexpr int table_period = 32;  ///< samples; responses of coefficients have fallen by (26 / 6)^-4 where they wrap
constexpr int largest_degree = 24;
constexpr int radial_nodes = 8192;

/// Orthonormal Legendre polynomials on [-1/2, 1/2] at x: p[a], and q[a], their integrals from -1/2, which for a >= 1
/// vanish at both ends.
struct LegendreValues {
  std::array<double, largest_degree + 2> p{}, q{};
};
void legendre(double x, int degree, LegendreValues& out) {
  std::array<double, largest_degree + 2> plain{};
  plain[0] = 1;
  plain[1] = 2 * x;
  for (std::size_t n = 1; n <= static_cast<std::size_t>(degree); ++n) {
    const auto m = static_cast<double>(n);
    plain[n + 1] = ((2 * m + 1) * 2 * x * plain[n] - m * plain[n - 1]) / (m + 1);
  }
  out.p[0] = 1;
  for (std::size_t n = 1; n <= static_cast<std::size_t>(degree); ++n) {
    const double root = std::sqrt(2 * static_cast<double>(n) + 1);
    out.p[n] = root * plain[n];
    out.q[n] = (plain[n + 1] - plain[n - 1]) / (2 * root);
  }
}

/// Pairs (a, b) with 1 <= a + b <= degree, in the order of the tables.
std::vector<std::pair<int, int>> pairs_of(int degree) {
  std::vector<std::pair<int, int>> pairs;
  for (int a = 0; a <= degree; ++a) {
    for (int b = 0; a + b <= degree; ++b) {
      if (a + b > 0) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

/// Fourier transform of the orthonormal polynomial of degree a: sqrt(2a+1) (-i)^a j_a(pi u).
std::complex<double> legendre_spectrum(int a, double u) {
  const double x = std::numbers::pi * std::abs(u);
  const double value = boost::math::sph_bessel(static_cast<unsigned>(a), x) * (u < 0 && a % 2 == 1 ? -1 : 1);
  static const std::complex<double> turns[4] = {{1, 0}, {0, -1}, {-1, 0}, {0, 1}};
  return std::sqrt(2 * a + 1.0) * value * turns[a % 4];
}

/// Image formation with frequencies in cycles per sample; optics from a table by radius.
class SampleTransfer {
 public:
  SampleTransfer(const ChainScope& scope, double band_per_pitch)
      : per_pitch_(scope.spec.samples_per_pitch()),
        band_(band_per_pitch),
        footprint_(scope),
        others_(other_transfers(scope)) {
    const OpticsMtf optics(scope);
    for (int i = 0; i <= radial_nodes + 1; ++i) optics_.push_back(optics(band_ * i / radial_nodes));
  }
  [[nodiscard]] double band_per_sample() const { return band_ / per_pitch_; }
  [[nodiscard]] bool symmetric() const { return others_.empty(); }
  [[nodiscard]] double footprint(double f_per_sample) const { return footprint_(f_per_sample * per_pitch_); }
  /// At squared radial frequency; 0 beyond the band.
  [[nodiscard]] double optics(double rho_squared) const {
    const double place = std::sqrt(rho_squared) * per_pitch_ / band_ * radial_nodes;
    if (place > radial_nodes) return 0;
    const auto at = static_cast<std::size_t>(place);
    return optics_[at] + (place - static_cast<double>(at)) * (optics_[at + 1] - optics_[at]);
  }
  [[nodiscard]] std::complex<double> rest(double u, double w) const {
    std::complex<double> value = 1;
    for (const auto& other : others_) value *= other(u * per_pitch_, w * per_pitch_);
    return value;
  }

 private:
  double per_pitch_, band_;
  FootprintMtf footprint_;
  std::vector<TransferFunction> others_;
  std::vector<double> optics_;
};

double cell_sinc(double x) {
  return x == 0 ? 1 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

double band_of(const SensorSpec& spec, const SensorPlan& plan, const Accuracy& accuracy) {
  double band = 16;
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.band != nullptr && plan.simulates(effect)) band = std::min(band, row.band(spec, accuracy));
  }
  return band;
}

/// Responses of the coefficients at the samples round the cell: a row each.
FloatRows coefficient_responses(const SampleTransfer& transfer, const std::vector<std::pair<int, int>>& pairs,
                                int degree) {
  const int band = static_cast<int>(std::floor(transfer.band_per_sample() * table_period));
  const auto count = static_cast<std::size_t>(2 * band + 1);
  std::vector<std::vector<std::complex<double>>> spectra(static_cast<std::size_t>(degree) + 1);
  std::vector<double> footprint;
  for (int m = -band; m <= band; ++m) footprint.push_back(transfer.footprint(static_cast<double>(m) / table_period));
  for (int a = 0; a <= degree; ++a) {
    for (int m = -band; m <= band; ++m)
      spectra[static_cast<std::size_t>(a)].push_back(legendre_spectrum(a, static_cast<double>(m) / table_period));
  }
  std::vector<std::complex<double>> chain(count * count);
  for (int n = -band; n <= band; ++n) {
    for (int m = -band; m <= band; ++m) {
      const double u = static_cast<double>(m) / table_period, w = static_cast<double>(n) / table_period;
      const auto i = static_cast<std::size_t>(m + band), j = static_cast<std::size_t>(n + band);
      const double value = transfer.optics(u * u + w * w) * footprint[i] * footprint[j];
      chain[j * count + i] = value == 0 ? 0 : value * transfer.rest(u, w);
    }
  }
  const auto bin = [](int m) { return ((m % table_period) + table_period) % table_period; };
  FloatRows out(static_cast<Eigen::Index>(pairs.size()), response_side * response_side);
  // Along x first, folded: shared by all b of an a.
  for (std::size_t first = 0; first < pairs.size();) {
    const int a = pairs[first].first;
    cv::Mat_<std::complex<double>> along(static_cast<int>(count), table_period, std::complex<double>(0, 0));
    for (std::size_t j = 0; j < count; ++j) {
      std::complex<double>* row = along[static_cast<int>(j)];
      for (std::size_t i = 0; i < count; ++i)
        row[bin(static_cast<int>(i) - band)] += chain[j * count + i] * spectra[static_cast<std::size_t>(a)][i];
    }
    for (; first < pairs.size() && pairs[first].first == a; ++first) {
      cv::Mat2d folded(table_period, table_period, cv::Vec2d(0, 0));
      const auto& own = spectra[static_cast<std::size_t>(pairs[first].second)];
      for (std::size_t j = 0; j < count; ++j) {
        const std::complex<double>* row = along[static_cast<int>(j)];
        cv::Vec2d* sum = folded[bin(static_cast<int>(j) - band)];
        for (int k = 0; k < table_period; ++k) {
          const std::complex<double> value = row[k] * own[j];
          sum[k] += cv::Vec2d(value.real(), value.imag());
        }
      }
      cv::Mat2d image;
      cv::dft(folded, image, cv::DFT_INVERSE);
      for (int j = -cell_reach; j <= cell_reach; ++j) {
        for (int i = -cell_reach; i <= cell_reach; ++i) {
          out(static_cast<Eigen::Index>(first), (j + cell_reach) * response_side + i + cell_reach) =
              static_cast<float>(image(bin(j), bin(i))[0] / (table_period * table_period));
        }
      }
    }
  }
  return out;
}

/// The response to a unit cell, all aliases summed, at the frequencies of a periodic grid of samples.
cv::Mat2d unit_cell(const SampleTransfer& transfer, cv::Size size) {
  const double band = transfer.band_per_sample();
  const int aliases = static_cast<int>(std::ceil(band));
  struct Axis {
    std::vector<double> f, factor;  ///< [bin][alias]
  };
  const auto axis = [&](int n) {
    Axis out;
    for (int k = 0; k < n; ++k) {
      const double base = static_cast<double>(k <= n / 2 ? k : k - n) / n;
      for (int m = -aliases; m <= aliases; ++m) {
        const double f = base + m;
        out.f.push_back(f);
        out.factor.push_back(std::abs(f) > band ? 0 : transfer.footprint(f) * cell_sinc(f));
      }
    }
    return out;
  };
  const Axis x = axis(size.width), y = axis(size.height);
  const auto per = static_cast<std::size_t>(2 * aliases + 1);
  cv::Mat2d out(size);
  // Without a direction in the chain a quarter of the plane is enough.
  const int columns = size.width / 2 + 1, rows = transfer.symmetric() ? size.height / 2 + 1 : size.height;
  for (int k = 0; k < rows; ++k) {
    for (int l = 0; l < columns; ++l) {
      std::complex<double> sum = 0;
      double plain = 0;
      for (std::size_t n = 0; n < per; ++n) {
        const auto at_y = static_cast<std::size_t>(k) * per + n;
        if (y.factor[at_y] == 0) continue;
        const double w = y.f[at_y];
        for (std::size_t m = 0; m < per; ++m) {
          const auto at_x = static_cast<std::size_t>(l) * per + m;
          const double factor = x.factor[at_x] * y.factor[at_y];
          if (factor == 0) continue;
          const double value = factor * transfer.optics(x.f[at_x] * x.f[at_x] + w * w);
          if (transfer.symmetric())
            plain += value;
          else
            sum += value * transfer.rest(x.f[at_x], w);
        }
      }
      sum += plain;
      out(k, l) = {sum.real(), sum.imag()};
    }
  }
  for (int k = 0; k < size.height; ++k) {
    for (int l = 0; l < size.width; ++l) {
      if (k < rows && l < columns) continue;
      if (transfer.symmetric()) {
        out(k, l) = out(std::min(k, size.height - k), std::min(l, size.width - l));
      } else {
        const cv::Vec2d mirrored = out((size.height - k) % size.height, size.width - l);
        out(k, l) = {mirrored[0], -mirrored[1]};
      }
    }
  }
  return out;
}

/// The elements of a picture that a cell meets along one axis, with the integral of each polynomial over each of them.
struct Overlap {
  int first = 0, count = 0;
  std::vector<double> integrals;  ///< [element][order]
};
/// Cell i reaches from i to i + 1; element k is centred at first + k size.
std::vector<Overlap> overlaps(int cells, int elements, double size, double first, int degree) {
  std::vector<Overlap> out(static_cast<std::size_t>(cells));
  const double start = first - size / 2;
  LegendreValues low, high;
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
      legendre(x0, degree, low);
      legendre(x1, degree, high);
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
  int margin;  ///< samples
  int degree;
  std::vector<std::pair<int, int>> pairs;
  FloatRows responses;

  Tables(SensorSpec s, SensorPlan p, const Accuracy& accuracy, SceneMotion motion)
      : spec(std::move(s)),
        plan(std::move(p)),
        transfer({.spec = spec, .plan = plan, .wavelengths = accuracy.wavelengths, .motion = motion},
                 band_of(spec, plan, accuracy)),
        margin(margin_pitches * spec.samples_per_pitch()),
        degree(std::clamp(static_cast<int>(std::ceil(2.4 * transfer.band_per_sample())) + 3, 4, largest_degree)),
        pairs(pairs_of(degree)),
        responses(coefficient_responses(transfer, pairs, degree)) {}
};

/// Means of the cells, and coefficients of those that have any.
struct SceneImager::Cells {
  cv::Mat1d inside, steps;        ///< of the column itself, and of everything to its right
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

/// What lies left of the picture is a step before its first column.
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

/// A piece within one cell.
void SceneImager::Cells::add_piece(cv::Point2d p, cv::Point2d q, double step) {
  const cv::Point2d middle = (p + q) / 2, d = q - p;
  const int column = static_cast<int>(std::floor(middle.x)), row = static_cast<int>(std::floor(middle.y));
  if (row < 0 || row >= inside.rows || column < 0 || column >= inside.cols) return;
  inside(row, column) += step * d.y * (1 - (middle.x - column));
  steps(row, column) += step * d.y;
  float* sums = of(column, row);
  const cv::Point2d centre(column + 0.5, row + 0.5);
  LegendreValues x, y;
  for (const auto& [node, weight] : rule) {
    const cv::Point2d place = middle + d * (node / 2) - centre;
    legendre(place.x, degree, x);
    legendre(place.y, degree, y);
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
  // Shares of the length between which the edge is in the rows, and where it crosses lines of the grid.
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
  // Rows matter within the picture only; left of it whole stretches are taken at once.
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
  if (slot == nullptr) slot = std::make_shared<const cv::Mat>(unit_cell(tables_->transfer, whole));
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
  const auto width = static_cast<Eigen::Index>(cells.per_cell);
  for (std::size_t first = 0; first < cells.places.size(); first += chunk) {
    const std::size_t count = std::min(chunk, cells.places.size() - first);
    const Eigen::Map<const FloatRows> own(cells.coefficients.data() + first * cells.per_cell,
                                          static_cast<Eigen::Index>(count), width);
    const FloatRows added = own * tables_->responses;
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
  Cells cells(padded(size), tables_->pairs.size(), tables_->degree);
  const cv::Point2d shift(tables_->margin + 0.5, tables_->margin + 0.5);
  for (const auto& edge : edges) cells.add({edge.a + shift, edge.b + shift, edge.step});
  return imaged(cells, size);
}

cv::Mat1d SceneImager::image(const cv::Mat1d& picture, double pixel_samples, cv::Point2d first, cv::Size size) const {
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
      // What is further from the frame than its responses reach does not count.
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
