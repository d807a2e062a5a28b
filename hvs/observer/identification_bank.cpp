// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/identification_bank.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/multiversion.h"
#include "hvs/observer/block_product.h"
#include "hvs/shape/step_image.h"

namespace todbench {
namespace {

constexpr std::size_t identification_block = TemplateBank::block;
constexpr std::size_t samples_at_once = 128;  ///< 32 KiB of templates

/// Filter of display and eye, as for the templates of triangles.
TransferFunction eye_filter(double sigma_samples) {
  return [sigma_samples](double u, double w) -> std::complex<double> {
    const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
    const double pi_sigma = std::numbers::pi * sigma_samples;
    return sinc(u) * sinc(w) * std::exp(-2 * pi_sigma * pi_sigma * (u * u + w * w));
  };
}

double reach_of(std::span<const AlternativeAspects> alternatives) {
  double reach = 0;
  for (const auto& alternative : alternatives) {
    for (const auto& edges : alternative) {
      for (const auto& edge : edges)
        reach = std::max({reach, std::abs(edge.a.x), std::abs(edge.a.y), std::abs(edge.b.x), std::abs(edge.b.y)});
    }
  }
  return reach;
}

/// Position of a window of samples on the fine picture of a target, at every place of the search.
struct PlacedWindow {
  int side = 0, search = 0;  ///< in samples; in steps each way
  int per_sample = 1;        ///< points of the fine picture per sample
  int stride = 1;            ///< points per step of the search
  int period = 1;            ///< of the fine picture, in points

  /// One row per place, each without its mean.
  [[nodiscard]] cv::Mat1d centred(const cv::Mat1d& fine) const {
    const int on_axis = 2 * search + 1;
    cv::Mat1d out(on_axis * on_axis, side * side);
    for (int place = 0; place < out.rows; ++place) {
      const int dx = place % on_axis - search, dy = place / on_axis - search;
      double* values = out[place];
      double mean = 0;
      for (int j = 0; j < side; ++j) {
        const int y = ((2 * j - side + 1) * per_sample / 2 - dy * stride + 2 * period) % period;
        for (int i = 0; i < side; ++i) {
          const int x = ((2 * i - side + 1) * per_sample / 2 - dx * stride + 2 * period) % period;
          mean += * values++ = fine(y, x);
        }
      }
      out.row(place) -= mean / (static_cast<double>(side) * side);
    }
    return out;
  }
};

constexpr double template_tolerance = 1e-4;

/// Rows of norm 1 as sums of few orthonormal ones.
struct FewTemplates {
  Eigen::MatrixXf basis;         ///< one column each
  Eigen::MatrixXf coefficients;  ///< [row of the basis][place]
};

/// Gram-Schmidt process with pivoting: each step takes the row with the largest residual, until every residual is
/// shorter than the tolerance. Equivalent to the pivoted Cholesky decomposition of the inner products, whose errors of
/// 1e-15 are small against the square of the tolerance. Divides the rows by their norms. Empty if a row is 0.
std::optional<FewTemplates> few_templates(cv::Mat1d& rows) {
  // The columns of `templates` are the rows.
  Eigen::Map<Eigen::MatrixXd> templates(rows.ptr<double>(), rows.cols, rows.rows);
  const Eigen::RowVectorXd norms = templates.colwise().norm();
  if (!(norms.minCoeff() > 0)) return std::nullopt;
  templates.array().rowwise() /= norms.array();
  const Eigen::Index most = std::min(templates.rows(), templates.cols());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(templates.cols(), templates.cols());
  products.selfadjointView<Eigen::Lower>().rankUpdate(templates.transpose());
  const Eigen::MatrixXd whole = products.selfadjointView<Eigen::Lower>();
  // Column k: the coefficients of the k-th row of the basis.
  Eigen::MatrixXd coefficients(templates.cols(), most), chosen(templates.rows(), most);
  std::vector<Eigen::Index> pivots;
  Eigen::VectorXd left = Eigen::VectorXd::Ones(templates.cols());  // squared residuals
  Eigen::Index found = 0, at = 0;
  for (; found < most && left.maxCoeff(&at) >= template_tolerance * template_tolerance; ++found) {
    const double length = std::sqrt(left(at));
    coefficients.col(found) =
        (whole.col(at) - coefficients.leftCols(found) * coefficients.row(at).head(found).transpose()) / length;
    left -= coefficients.col(found).cwiseAbs2();
    left(at) = 0;
    chosen.col(found) = templates.col(at);
    pivots.push_back(at);
  }
  Eigen::MatrixXd triangle(found, found);
  for (Eigen::Index k = 0; k < found; ++k)
    triangle.row(k) = coefficients.row(pivots[static_cast<std::size_t>(k)]).head(found);
  // The chosen rows are the basis times the transposed triangle.
  Eigen::MatrixXd basis = chosen.leftCols(found);
  triangle.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(basis);
  return FewTemplates{basis.cast<float>(), coefficients.leftCols(found).transpose().cast<float>()};
}

TODBENCH_MULTIVERSION
float largest_sum(const float* signal, const float* first, float first_scale, const float* second, float second_scale,
                  std::size_t count) {
  constexpr std::size_t lanes = 32;
  float top[lanes];
  for (std::size_t l = 0; l < lanes; ++l) top[l] = -1e30F;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) {
      const float value = signal[i + l] + (first_scale * first[i + l] + second_scale * second[i + l]);
      top[l] = value > top[l] ? value : top[l];
    }
  }
  for (; i < count; ++i) {
    const float value = signal[i] + (first_scale * first[i] + second_scale * second[i]);
    top[0] = value > top[0] ? value : top[0];
  }
  return *std::max_element(top, top + lanes);
}

/// Inner product in eight partial sums, the same on every instruction set.
TODBENCH_MULTIVERSION
float inner_product(const float* a, const float* b, int count) {
  constexpr int lanes = 8;
  float sums[lanes] = {};
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (int l = 0; l < lanes; ++l) sums[l] += a[i + l] * b[i + l];
  }
  for (; i < count; ++i) sums[0] += a[i] * b[i];
  float sum = 0;
  for (const float part : sums) sum += part;
  return sum;
}

/// results[l][row] = inner_product(values[row], factors[l]) for four factors, with the same bits: their sums are
/// interleaved.
TODBENCH_MULTIVERSION
void inner_products(const float* values, int count, int length, const float* const* factors, float* const* results) {
  constexpr int lanes = 8, many = products_at_once;
  for (int row = 0; row < count; ++row, values += length) {
    float sums[many][lanes] = {};
    int i = 0;
    for (; i + lanes <= length; i += lanes) {
      for (int k = 0; k < many; ++k) {
        for (int l = 0; l < lanes; ++l) sums[k][l] += values[i + l] * factors[k][i + l];
      }
    }
    for (; i < length; ++i) {
      for (int k = 0; k < many; ++k) sums[k][0] += values[i] * factors[k][i];
    }
    for (int k = 0; k < many; ++k) {
      float sum = 0;
      for (const float part : sums[k]) sum += part;
      results[k][row] = sum;
    }
  }
}

}  // namespace

int identification_window_samples(const TemplateObserverSpec& spec, std::span<const AlternativeAspects> alternatives,
                                  int samples_per_pitch) {
  const double reach = reach_of(alternatives);
  const double half_pitch = std::ceil(1.1 * reach / samples_per_pitch + spec.window_margin_pitch - 1e-9);
  return 2 * static_cast<int>(half_pitch) * samples_per_pitch;
}

Result<IdentificationBank> IdentificationBank::build(const TemplateObserverSpec& spec,
                                                     std::span<const AlternativeAspects> alternatives,
                                                     int samples_per_pitch, const std::optional<KnownCamera>& camera) {
  if (alternatives.size() < 2) return fail(ErrorCode::invalid_input, "identification needs at least two alternatives");
  const int steps = static_cast<int>(std::lround(1 / spec.search_step_samples));
  const int search = static_cast<int>(std::lround(spec.search_range_samples * steps));
  const double reach = reach_of(alternatives);
  IdentificationBank bank;
  bank.places_ = 2 * search + 1;
  bank.window_ = identification_window_samples(spec, alternatives, samples_per_pitch);
  const int half = bank.window_ / 2;
  const auto samples = static_cast<std::size_t>(bank.window_) * static_cast<std::size_t>(bank.window_);
  const auto places = static_cast<std::size_t>(bank.places_ * bank.places_);
  const auto too_large = [&](std::size_t bytes) { return bytes > TemplateBank::max_bytes; };
  const auto refusal = [&] {
    return fail(ErrorCode::invalid_input,
                "targets of " + std::to_string(std::lround(2 * reach)) +
                    " samples are too large for this observer, because their templates would need more than 1 GiB");
  };
  if (too_large(samples * places * sizeof(double))) return refusal();

  const double band =
      camera ? camera->band_per_sample : std::sqrt(27.631 / 2) / (std::numbers::pi * spec.blur_sigma_samples);
  const int period = cv::getOptimalDFTSize(
      static_cast<int>(std::ceil(half + spec.search_range_samples + reach + 7 * spec.blur_sigma_samples + 1)));
  const FrequencyLattice lattice{.period = period, .band = static_cast<int>(std::ceil(band * period))};
  int per_sample = steps % 2 == 0 ? steps : 2 * steps;
  while (period * per_sample <= 2 * lattice.band) per_sample *= 2;
  const FilterTable filter(lattice, camera ? camera->transfer : eye_filter(spec.blur_sigma_samples));
  const PlacedWindow window{.side = bank.window_,
                            .search = search,
                            .per_sample = per_sample,
                            .stride = per_sample / steps,
                            .period = period * per_sample};
  bank.first_aspect_.push_back(0);
  std::size_t index = 0;
  for (const auto& alternative : alternatives) {
    if (alternative.empty()) return fail(ErrorCode::invalid_input, "an alternative has no views");
    for (const auto& edges : alternative) {
      cv::Mat1d shown = edges.empty() ? cv::Mat1d() : window.centred(fine_step_image(edges, filter, per_sample));
      auto few = edges.empty() ? std::nullopt : few_templates(shown);
      if (!few) return fail(ErrorCode::invalid_input, "an alternative cannot be distinguished from its background");
      const std::size_t end = index + static_cast<std::size_t>(few->basis.cols());
      const std::size_t blocks = (end + identification_block - 1) / identification_block;
      if (too_large(blocks * identification_block * samples * sizeof(float))) return refusal();
      bank.basis_.resize(blocks * identification_block * samples, 0.0F);
      for (Eigen::Index column = 0; column < few->basis.cols(); ++column, ++index) {
        float* target = bank.basis_.data() + index / identification_block * identification_block * samples +
                        index % identification_block;
        const float* values = few->basis.col(column).data();
        for (std::size_t s = 0; s < samples; ++s) target[s * identification_block] = values[s];
      }
      bank.aspects_.push_back(
          cv::Mat1f(static_cast<int>(places), static_cast<int>(few->coefficients.rows()), few->coefficients.data())
              .clone());
    }
    bank.first_aspect_.push_back(bank.aspects_.size());
  }
  return bank;
}

std::vector<float> IdentificationBank::project(const cv::Mat1f& patch) const {
  return std::move(project_all({&patch, 1}).front());
}

std::vector<std::vector<float>> IdentificationBank::project_all(std::span<const cv::Mat1f> patches) const {
  const auto samples = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  const std::size_t block_values = identification_block * samples, rows = basis_.size() / samples;
  for (const auto& patch : patches) CV_Assert(patch.rows == window_ && patch.cols == window_ && patch.isContinuous());
  std::vector<float> products(patches.size() * rows);
  // Complete groups are multiplied together; the remaining patches singly.
  const std::size_t together = patches.size() / products_at_once * products_at_once;
  for (std::size_t from = 0; from < basis_.size(); from += block_values) {
    for (std::size_t part = 0; part < samples; part += samples_at_once) {
      const std::size_t count = std::min(samples_at_once, samples - part);
      for (std::size_t k = 0; k < together; k += products_at_once) {
        std::array<const float*, products_at_once> factors{};
        std::array<float*, products_at_once> sums{};
        for (std::size_t l = 0; l < products_at_once; ++l) {
          factors[l] = patches[k + l].ptr<float>() + part;
          sums[l] = &products[(k + l) * rows + from / samples];
        }
        add_block_products(&basis_[from + part * identification_block], factors, count, sums);
      }
    }
    for (std::size_t k = together; k < patches.size(); ++k)
      block_product(&basis_[from], patches[k].ptr<float>(), samples, &products[k * rows + from / samples]);
  }
  std::vector<std::vector<float>> out(patches.size());
  for (auto& scores_of_one : out) scores_of_one.resize(scores());
  std::size_t own = 0, first_score = 0;
  for (const auto& aspect : aspects_) {
    for (std::size_t k = 0; k < together; k += products_at_once) {
      std::array<const float*, products_at_once> factors{};
      std::array<float*, products_at_once> results{};
      for (std::size_t l = 0; l < products_at_once; ++l) {
        factors[l] = &products[(k + l) * rows + own];
        results[l] = &out[k + l][first_score];
      }
      inner_products(aspect.ptr<float>(), aspect.rows, aspect.cols, factors.data(), results.data());
    }
    for (std::size_t k = together; k < patches.size(); ++k) {
      for (int place = 0; place < aspect.rows; ++place)
        out[k][first_score + static_cast<std::size_t>(place)] =
            inner_product(aspect[place], &products[k * rows + own], aspect.cols);
    }
    own += static_cast<std::size_t>(aspect.cols);
    first_score += static_cast<std::size_t>(aspect.rows);
  }
  return out;
}

std::size_t IdentificationBank::best(std::span<const float> signal, std::span<const float> first, float first_scale,
                                     std::span<const float> second, float second_scale) const {
  std::vector<float> largest(alternatives());
  largest_of_each(signal, first, first_scale, second, second_scale, largest);
  std::size_t winner = 0;
  for (std::size_t o = 1; o < largest.size(); ++o) {
    if (largest[o] > largest[winner]) winner = o;
  }
  return winner;
}

void IdentificationBank::largest_of_each(std::span<const float> signal, std::span<const float> first, float first_scale,
                                         std::span<const float> second, float second_scale,
                                         std::span<float> largest) const {
  CV_Assert(signal.size() == scores() && first.size() == scores() && second.size() == scores());
  const auto per_aspect = static_cast<std::size_t>(places_ * places_);
  for (std::size_t o = 0; o < alternatives(); ++o) {
    const std::size_t from = first_aspect_[o] * per_aspect;
    const std::size_t count = (first_aspect_[o + 1] - first_aspect_[o]) * per_aspect;
    largest[o] = largest_sum(&signal[from], &first[from], first_scale, &second[from], second_scale, count);
  }
}

}  // namespace todbench
