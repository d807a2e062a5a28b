#include "hvs/observer/identification_bank.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/core/multiversion.h"
#include "hvs/observer/block_product.h"
#include "hvs/shape/step_image.h"

namespace todbench {
namespace {

constexpr std::size_t identification_block = TemplateBank::block;

/// Display and eye, as the templates of triangles.
TransferFunction eye_filter(double sigma_samples) {
  return [sigma_samples](double u, double w) -> std::complex<double> {
    const auto sinc = [](double x) { return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); };
    const double pi_sigma = std::numbers::pi * sigma_samples;
    return sinc(u) * sinc(w) * std::exp(-2 * pi_sigma * pi_sigma * (u * u + w * w));
  };
}

/// Indices of the places at which projections are computed: all, or nine near the nodes of Chebyshev and Lobatto.
std::vector<int> node_places(int places) {
  std::vector<int> nodes;
  constexpr int most = 9;
  if (places <= most) {
    for (int p = 0; p < places; ++p) nodes.push_back(p);
    return nodes;
  }
  for (int k = 0; k < most; ++k) {
    const double x = (1 - std::cos(std::numbers::pi * k / (most - 1))) / 2;
    const int place = static_cast<int>(std::lround(x * (places - 1)));
    if (nodes.empty() || place > nodes.back()) nodes.push_back(place);
  }
  return nodes;
}

cv::Mat1f lagrange_weights(int places, const std::vector<int>& nodes) {
  cv::Mat1f weights(places, static_cast<int>(nodes.size()));
  for (int p = 0; p < places; ++p) {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      double weight = 1;
      for (std::size_t l = 0; l < nodes.size(); ++l) {
        if (l != k) weight *= static_cast<double>(p - nodes[l]) / (nodes[k] - nodes[l]);
      }
      weights(p, static_cast<int>(k)) = static_cast<float>(weight);
    }
  }
  return weights;
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

/// Where a window of samples lies on the fine picture of a target, at every node of the search.
struct PlacedWindow {
  int side = 0, search = 0;  ///< in samples; in steps each way
  int per_sample = 1;        ///< points of the fine picture to the sample
  int stride = 1;            ///< and to the step of the search
  int period = 1;            ///< of the fine picture, in points
  std::span<const int> nodes;

  /// One row per node, each without its mean.
  [[nodiscard]] cv::Mat1d centred(const cv::Mat1d& fine) const {
    const auto on_axis = static_cast<int>(nodes.size());
    cv::Mat1d out(on_axis * on_axis, side * side);
    for (int node = 0; node < out.rows; ++node) {
      const int dx = nodes[static_cast<std::size_t>(node % on_axis)] - search;
      const int dy = nodes[static_cast<std::size_t>(node / on_axis)] - search;
      double* values = out[node];
      double mean = 0;
      for (int j = 0; j < side; ++j) {
        const int y = ((2 * j - side + 1) * per_sample / 2 - dy * stride + 2 * period) % period;
        for (int i = 0; i < side; ++i) {
          const int x = ((2 * i - side + 1) * per_sample / 2 - dx * stride + 2 * period) % period;
          mean += * values++ = fine(y, x);
        }
      }
      out.row(node) -= mean / (static_cast<double>(side) * side);
    }
    return out;
  }
};

/// The product at a place of the search from those at the nodes.
double interpolated_product(const cv::Mat1f& weights, const cv::Mat1d& gram, int x, int y) {
  const int on_axis = weights.cols;
  cv::Mat1d own(gram.rows, 1);
  for (int node = 0; node < own.rows; ++node) {
    own(node) = static_cast<double>(weights(x, node % on_axis)) * static_cast<double>(weights(y, node / on_axis));
  }
  return own.dot(cv::Mat1d(gram * own));
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
  const std::vector<int> nodes = node_places(bank.places_);
  bank.weights_ = lagrange_weights(bank.places_, nodes);
  bank.first_aspect_.push_back(0);
  std::size_t count = 0;
  for (const auto& alternative : alternatives) {
    if (alternative.empty()) return fail(ErrorCode::invalid_input, "an alternative is seen from no side");
    count += alternative.size();
    bank.first_aspect_.push_back(count);
  }
  const auto samples = static_cast<std::size_t>(bank.window_) * static_cast<std::size_t>(bank.window_);
  const std::size_t per_aspect = nodes.size() * nodes.size();
  bank.blocks_ = (count * per_aspect + identification_block - 1) / identification_block;
  if (samples * bank.blocks_ * identification_block * sizeof(float) > TemplateBank::max_bytes) {
    return fail(ErrorCode::invalid_input,
                "targets of " + std::to_string(2 * reach) +
                    " samples are too large for this observer: their templates would need over 1 GiB");
  }
  bank.nodes_.assign(bank.blocks_ * identification_block * samples, 0.0F);

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
                            .period = period * per_sample,
                            .nodes = nodes};
  std::size_t index = 0;
  for (const auto& alternative : alternatives) {
    for (const auto& edges : alternative) {
      if (edges.empty()) return fail(ErrorCode::invalid_input, "an alternative cannot be told from its background");
      const cv::Mat1d shown = window.centred(fine_step_image(edges, filter, per_sample));
      // Norms at every place from the products of the nodes.
      cv::Mat1d gram;
      cv::mulTransposed(shown, gram, false);
      Aspect aspect;
      for (int place = 0; place < bank.places_ * bank.places_; ++place) {
        const double square = interpolated_product(bank.weights_, gram, place % bank.places_, place / bank.places_);
        if (!(square > 0)) return fail(ErrorCode::invalid_input, "an alternative cannot be told from its background");
        aspect.inverse_norms.push_back(static_cast<float>(1 / std::sqrt(square)));
      }
      bank.aspects_.push_back(std::move(aspect));
      for (std::size_t node = 0; node < per_aspect; ++node, ++index) {
        float* target = bank.nodes_.data() + index / identification_block * identification_block * samples +
                        index % identification_block;
        const double* values = shown[static_cast<int>(node)];
        for (std::size_t s = 0; s < samples; ++s) target[s * identification_block] = static_cast<float>(values[s]);
      }
    }
  }
  return bank;
}

std::vector<float> IdentificationBank::project(const cv::Mat1f& patch) const {
  const auto samples = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  CV_Assert(patch.rows == window_ && patch.cols == window_ && patch.isContinuous());
  std::vector<float> products(blocks_ * identification_block);
  for (std::size_t b = 0; b < blocks_; ++b) {
    block_product(nodes_.data() + b * identification_block * samples, patch.ptr<float>(), samples,
                  &products[b * identification_block]);
  }
  const int on_axis = weights_.cols;
  const auto places = static_cast<std::size_t>(places_);
  std::vector<float> out(scores());
  std::vector<float> along(places * static_cast<std::size_t>(on_axis));  // [node in y][place in x]
  for (std::size_t a = 0; a < aspects_.size(); ++a) {
    const float* own = &products[a * static_cast<std::size_t>(on_axis * on_axis)];
    for (int k = 0; k < on_axis; ++k) {
      for (int p = 0; p < places_; ++p) {
        float sum = 0;
        for (int l = 0; l < on_axis; ++l) sum += weights_(p, l) * own[k * on_axis + l];
        along[static_cast<std::size_t>(k) * places + static_cast<std::size_t>(p)] = sum;
      }
    }
    float* scores_of_aspect = &out[a * places * places];
    for (int q = 0; q < places_; ++q) {
      for (std::size_t p = 0; p < places; ++p) {
        float sum = 0;
        for (int k = 0; k < on_axis; ++k) sum += weights_(q, k) * along[static_cast<std::size_t>(k) * places + p];
        const std::size_t place = static_cast<std::size_t>(q) * places + p;
        scores_of_aspect[place] = sum * aspects_[a].inverse_norms[place];
      }
    }
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
