// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/identification_bank.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "acquisition/base/multiversion.h"
#include "hvs/observer/block_product.h"
#include "hvs/observer/viewing_filter.h"
#include "hvs/shape/step_image.h"

namespace todbench {
namespace {

constexpr std::size_t identification_block = TemplateBank::block;
constexpr std::size_t samples_at_once = 128;  ///< 32 KiB of templates

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

  /// One row per place.
  [[nodiscard]] cv::Mat1d rows(const cv::Mat1d& fine) const {
    const int on_axis = 2 * search + 1;
    cv::Mat1d out(on_axis * on_axis, side * side);
    for (int place = 0; place < out.rows; ++place) {
      const int dx = place % on_axis - search, dy = place / on_axis - search;
      double* values = out[place];
      for (int j = 0; j < side; ++j) {
        const int y = ((2 * j - side + 1) * per_sample / 2 - dy * stride + 2 * period) % period;
        for (int i = 0; i < side; ++i) {
          const int x = ((2 * i - side + 1) * per_sample / 2 - dx * stride + 2 * period) % period;
          *values++ = fine(y, x);
        }
      }
    }
    return out;
  }
};

void remove_means(cv::Mat1d& rows) {
  for (int row = 0; row < rows.rows; ++row) {
    double mean = 0;
    for (int i = 0; i < rows.cols; ++i) mean += rows(row, i);
    rows.row(row) -= mean / static_cast<double>(rows.cols);
  }
}

constexpr double template_tolerance = 1e-4;
/// 1e-4 of the variance of the noise of the eye.
constexpr double eye_tolerance = 1e-2;

/// Rows of norm 1 as sums of few orthonormal ones.
struct FewTemplates {
  Eigen::MatrixXf basis;         ///< one column each
  Eigen::MatrixXf coefficients;  ///< [row of the basis][place]
};

/// Gram-Schmidt process with pivoting: each step takes the row with the largest residual, until every residual is
/// shorter than the tolerance, relative to the longest row. Equivalent to the pivoted Cholesky decomposition of the
/// inner products, whose errors of 1e-15 are small against the square of the tolerance. Divides the rows by their
/// norms, or all by one. Empty if a row is 0.
std::optional<FewTemplates> few_templates(cv::Mat1d& rows, double tolerance, std::optional<double> one_norm) {
  // The columns of `templates` are the rows.
  Eigen::Map<Eigen::MatrixXd> templates(rows.ptr<double>(), rows.cols, rows.rows);
  Eigen::RowVectorXd norms = templates.colwise().norm();
  if (one_norm) norms.setConstant(*one_norm);
  if (!(norms.minCoeff() > 0)) return std::nullopt;
  templates.array().rowwise() /= norms.array();
  const Eigen::Index most = std::min(templates.rows(), templates.cols());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(templates.cols(), templates.cols());
  products.selfadjointView<Eigen::Lower>().rankUpdate(templates.transpose());
  const Eigen::MatrixXd whole = products.selfadjointView<Eigen::Lower>();
  // Column k: the coefficients of the k-th row of the basis.
  Eigen::MatrixXd coefficients(templates.cols(), most), chosen(templates.rows(), most);
  std::vector<Eigen::Index> pivots;
  // Squared residuals.
  Eigen::VectorXd left = Eigen::VectorXd::Ones(templates.cols());
  if (one_norm) left = whole.diagonal();
  // Rounding is relative to the longest row: a sensitive eye makes rows of any length.
  const double least = tolerance * tolerance * (one_norm ? left.maxCoeff() : 1);
  Eigen::Index found = 0, at = 0;
  for (; found < most && left.maxCoeff(&at) >= least; ++found) {
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

/// Frequency in cycles per sample above which display and H leave less than 1e-4 of the variance of an edge.
double eye_band(const ViewingFilter& viewing) {
  double sum = 0, band = 0;
  constexpr int steps = 200;
  std::vector<double> powers;
  for (int i = 1; i <= steps; ++i) {
    const double u = viewing.band_per_sample * i / steps;
    powers.push_back(viewing.transfer(u, 0).real() / (u * u));
    sum += powers.back();
  }
  double above = 0;
  for (int i = steps; i >= 1; --i) {
    above += powers[static_cast<std::size_t>(i - 1)];
    if (above > 1e-4 * sum) {
      band = viewing.band_per_sample * i / steps;
      break;
    }
  }
  return band;
}

}  // namespace

cv::Mat1f without_background(const TemplateObserverSpec& spec, cv::Mat1f picture) {
  picture = picture.clone();
  if (!spec.eye) {
    picture -= cv::mean(picture)[0];
    return picture;
  }
  const int last = picture.rows - 1, right = picture.cols - 1;
  const double corners = static_cast<double>(picture(0, 0)) + static_cast<double>(picture(0, right)) +
                         static_cast<double>(picture(last, 0)) + static_cast<double>(picture(last, right));
  const double sum = cv::sum(picture.row(0))[0] + cv::sum(picture.row(last))[0] + cv::sum(picture.col(0))[0] +
                     cv::sum(picture.col(right))[0] - corners;
  picture -= sum / (2.0 * (last + right));
  return picture;
}

int identification_window_samples(const TemplateObserverSpec& spec, std::span<const AlternativeAspects> alternatives,
                                  int samples_per_pitch) {
  const double reach = reach_of(alternatives);
  double margin_pitch = spec.window_margin_pitch;
  if (spec.eye && spec.display) {
    const double arcmin_per_pitch = arcmin_per_sample(*spec.display) * samples_per_pitch;
    margin_pitch = std::max(margin_pitch, spec.window_margin_arcmin / arcmin_per_pitch);
  }
  const double half_pitch = std::ceil(1.1 * reach / samples_per_pitch + margin_pitch - 1e-9);
  return 2 * static_cast<int>(half_pitch) * samples_per_pitch;
}

/// The views of a bank behind one filter, in one window.
struct IdentificationBank::Views {
  std::span<const AlternativeAspects> alternatives;
  const FilterTable& filter;
  PlacedWindow window;
  int fine_per_sample;  ///< points of a fine picture per displayed sample
  /// Of each aspect; empty: each row has its own norm and no mean, as without an eye.
  std::vector<double> norms{};
  double tolerance = template_tolerance;
};

Result<void> IdentificationBank::add(const Views& views) {
  const PlacedWindow& window = views.window;
  window_ = window.side;
  places_ = 2 * window.search + 1;
  const auto samples = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  const auto places = static_cast<std::size_t>(places_ * places_);
  const auto refusal = [&] {
    return fail(ErrorCode::invalid_input,
                "targets of " + std::to_string(std::lround(2 * reach_of(views.alternatives))) +
                    " samples are too large for this observer, because their templates would need more than 1 GiB");
  };
  const auto too_large = [&](std::size_t bytes) { return bytes > TemplateBank::max_bytes; };
  if (too_large(samples * places * sizeof(double))) return refusal();
  first_aspect_.push_back(0);
  std::size_t index = 0;
  for (const auto& alternative : views.alternatives) {
    if (alternative.empty()) return fail(ErrorCode::invalid_input, "an alternative has no views");
    for (const auto& edges : alternative) {
      cv::Mat1d shown =
          edges.empty() ? cv::Mat1d() : window.rows(fine_step_image(edges, views.filter, views.fine_per_sample));
      std::optional<double> norm;
      if (views.norms.empty()) {
        remove_means(shown);
      } else {
        norm = views.norms[aspects_.size()];
      }
      auto few = edges.empty() ? std::nullopt : few_templates(shown, views.tolerance, norm);
      if (!few) return fail(ErrorCode::invalid_input, "an alternative cannot be distinguished from its background");
      const std::size_t end = index + static_cast<std::size_t>(few->basis.cols());
      const std::size_t blocks = (end + identification_block - 1) / identification_block;
      if (too_large(blocks * identification_block * samples * sizeof(float))) return refusal();
      basis_.resize(blocks * identification_block * samples, 0.0F);
      for (Eigen::Index column = 0; column < few->basis.cols(); ++column, ++index) {
        float* target = basis_.data() + index / identification_block * identification_block * samples +
                        index % identification_block;
        const float* values = few->basis.col(column).data();
        for (std::size_t s = 0; s < samples; ++s) target[s * identification_block] = values[s];
      }
      aspects_.push_back(
          cv::Mat1f(static_cast<int>(places), static_cast<int>(few->coefficients.rows()), few->coefficients.data())
              .clone());
    }
    first_aspect_.push_back(aspects_.size());
  }
  return {};
}

Result<IdentificationBank> IdentificationBank::build(const TemplateObserverSpec& spec,
                                                     std::span<const AlternativeAspects> alternatives,
                                                     int samples_per_pitch, const std::optional<KnownCamera>& camera) {
  if (alternatives.size() < 2) return fail(ErrorCode::invalid_input, "identification needs at least two alternatives");
  if (spec.eye && !spec.display) return fail(ErrorCode::invalid_input, "an observer with an eye needs a display");
  const int steps = static_cast<int>(std::lround(1 / spec.search_step_samples));
  const int search = static_cast<int>(std::lround(spec.search_range_samples * steps));
  const int side = identification_window_samples(spec, alternatives, samples_per_pitch);
  const ViewingFilter viewing = viewing_filter(spec);
  double band = camera ? camera->band_per_sample : viewing.band_per_sample;
  if (spec.eye) band = std::min(band, viewing.band_per_sample);
  const double way = 0.5 * side + spec.search_range_samples;
  const int period = cv::getOptimalDFTSize(
      static_cast<int>(std::ceil((spec.eye ? 2 : 1) * way + reach_of(alternatives) + viewing.reach_samples + 1)));
  const FrequencyLattice lattice{.period = period, .band = static_cast<int>(std::ceil(band * period))};
  int per_sample = steps % 2 == 0 ? steps : 2 * steps;
  while (period * per_sample <= 2 * lattice.band) per_sample *= 2;
  // Points of the noise of an eye per sample: the spectrum behind display and H must fit, and the points must lie on
  // the fine picture.
  int points = 1;
  while (spec.eye && points < 2 * eye_band(viewing)) points *= 2;
  while (per_sample % (2 * points) != 0) per_sample *= 2;
  const PlacedWindow window{.side = side,
                            .search = search,
                            .per_sample = per_sample,
                            .stride = per_sample / steps,
                            .period = period * per_sample};
  IdentificationBank bank;
  bank.spec_ = spec;
  if (!spec.eye) {
    const FilterTable filter(lattice, camera ? camera->transfer : viewing.transfer);
    if (auto added = bank.add({alternatives, filter, window, per_sample}); !added) return tl::unexpected(added.error());
    return bank;
  }
  const auto behind = [&](double u, double w, const std::complex<double>& passed) {
    return camera ? passed * camera->transfer(u, w) : passed;
  };
  const FilterTable seen(lattice, [&](double u, double w) { return behind(u, w, viewing.transfer(u, w)); });
  const FilterTable once(lattice, [&](double u, double w) { return behind(u, w, std::sqrt(viewing.transfer(u, w))); });
  // Wider by the search: the noise of a template at its end has no edge.
  PlacedWindow fine = window;
  fine.side = (side + 2 * static_cast<int>(std::ceil(spec.search_range_samples))) * points;
  fine.per_sample /= points;
  auto eye = std::make_shared<IdentificationBank>(IdentificationBank());
  std::vector<double> norms;
  for (const auto& alternative : alternatives) {
    for (const auto& edges : alternative) {
      if (edges.empty())
        return fail(ErrorCode::invalid_input, "an alternative cannot be distinguished from its background");
      PlacedWindow middle = fine;
      middle.search = 0;
      norms.push_back(cv::norm(middle.rows(fine_step_image(edges, once, per_sample))));
      bank.energy_.push_back(std::pow(norms.back() / points, 2));
    }
  }
  if (auto added = eye->add({alternatives, once, fine, per_sample, norms, eye_tolerance}); !added)
    return tl::unexpected(added.error());
  for (double& norm : norms) norm /= points;
  if (auto added = bank.add({alternatives, seen, window, per_sample, norms}); !added)
    return tl::unexpected(added.error());
  bank.eye_ = std::move(eye);
  return bank;
}

double IdentificationBank::eye_energy(std::size_t alternative, std::size_t aspect, double level) const {
  const double sample_deg = arcmin_per_sample(*spec_.display) / 60;
  return energy_[first_aspect_[alternative] + aspect] * std::pow(sample_deg / level, 2);
}

double IdentificationBank::eye_noise_k(const TemplateObserverSpec& seeing, std::size_t alternative, std::size_t aspect,
                                       double contrast_k, double level) const {
  const double luminance = adaptation_luminance_cd_m2(*spec_.display);
  // Sensitivity and channels multiply H by one number at all frequencies.
  const double gain2 = EyeFilter(*seeing.eye, luminance).identification_power(4) /
                       EyeFilter(*spec_.eye, luminance).identification_power(4);
  const double contrast = shown_contrast(*spec_.display, contrast_k);
  const double sample_deg = arcmin_per_sample(*spec_.display) / 60;
  const double in_proportion =
      std::pow(seeing.eye->contrast_noise * contrast, 2) * gain2 * eye_energy(alternative, aspect, level);
  return std::abs(contrast_k) / (contrast * sample_deg) * std::sqrt((1 + in_proportion) / gain2);
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
