// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/template_bank.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>

#include "hvs/observer/block_product.h"
#include "hvs/observer/eye_noise.h"
#include "hvs/observer/template_observer.h"
#include "hvs/observer/viewing_filter.h"
#include "hvs/shape/polygon_image.h"

namespace todbench {
namespace {

/// Removes the mean of a template's samples and scales them to the Euclidean norm 1.
void normalise(std::vector<double>& values) {
  double mean = 0;
  for (const double v : values) mean += v;
  mean /= static_cast<double>(values.size());
  double energy = 0;
  for (double& v : values) {
    v -= mean;
    energy += v * v;
  }
  for (double& v : values) v /= std::sqrt(energy);
}

}  // namespace

Result<TemplateBank> TemplateBank::build(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                         double size_samples, int samples_per_pitch) {
  if (!(size_samples > 0) || samples_per_pitch < 1) {
    return fail(ErrorCode::invalid_input, "an observer needs a positive target size and at least one sample per pitch");
  }
  if (spec.eye && spec.sample_aspect != 1)
    return fail(ErrorCode::invalid_input, "an observer with an eye judges only pictures of square pixels");
  const int steps = static_cast<int>(std::lround(1 / spec.search_step_samples));
  const int reach = static_cast<int>(std::lround(spec.search_range_samples * steps));
  // Samples of the axis that has more of them, for each sample along x.
  const double most_samples = std::max(1.0, 1 / spec.sample_aspect);
  double margin_pitch = spec.window_margin_pitch;
  if (spec.eye) {
    if (!spec.display) return fail(ErrorCode::invalid_input, "an observer with an eye needs a display");
    margin_pitch =
        std::max(margin_pitch, spec.window_margin_arcmin / (arcmin_per_sample(*spec.display) * samples_per_pitch));
  }
  const double half_pitch =
      std::ceil(most_samples * (spec.window_size_factor * size_samples / samples_per_pitch + margin_pitch) - 1e-9);
  const double samples = std::pow(2 * half_pitch * samples_per_pitch, 2);
  TemplateBank bank;
  bank.alternatives_ = static_cast<int>(alternatives.size());
  bank.places_ = (2 * reach + 1) * (2 * reach + 1);
  bank.blocks_ = (static_cast<std::size_t>(bank.templates()) + block - 1) / block;
  if (samples * static_cast<double>(bank.padded_templates() * sizeof(float)) > static_cast<double>(max_bytes)) {
    return fail(ErrorCode::invalid_input,
                "a target of " + std::to_string(size_samples) +
                    " samples is too large for this observer, because its templates would need more than 1 GiB");
  }
  const int half = static_cast<int>(half_pitch) * samples_per_pitch;
  bank.window_ = 2 * half;

  // Sample centres lie on half samples, search places on 1 / steps: one fine grid contains both.
  const ViewingFilter viewing = viewing_filter(spec);
  // The next copy of the shape must stay outside the window: shape, seven sigma of blur, the display sample, and the
  // search range.
  const int period = static_cast<int>(std::ceil((spec.eye ? 2 : 1) * (half + spec.search_range_samples) +
                                                most_samples * (0.9 * size_samples + viewing.reach_samples) + 1));
  const FrequencyLattice lattice{.period = period,
                                 .band = static_cast<int>(std::ceil(viewing.band_per_sample * period))};
  int per_sample = steps % 2 == 0 ? steps : 2 * steps;
  while (period * per_sample <= 2 * lattice.band) per_sample *= 2;
  const FilterTable filter(lattice, viewing.transfer);
  const int stride = per_sample / steps;
  const int n = period * per_sample;
  const auto count = static_cast<std::size_t>(bank.window_) * static_cast<std::size_t>(bank.window_);
  bank.values_.assign(bank.blocks_ * block * count, 0.0F);
  std::vector<double> values(count);
  for (int o = 0; o < bank.alternatives_; ++o) {
    Polygon shape = placed(alternatives[static_cast<std::size_t>(o)], size_samples, {0, 0});
    for (auto& corner : shape) corner.y /= spec.sample_aspect;
    const cv::Mat1d fine = PolygonImage(shape, filter).fine_image(per_sample);
    for (int place = 0; place < bank.places_; ++place) {
      const int dx = place % (2 * reach + 1) - reach;
      const int dy = place / (2 * reach + 1) - reach;
      for (int j = 0; j < bank.window_; ++j) {
        const int y = ((2 * (j - half) + 1) * per_sample / 2 - dy * stride + 2 * n) % n;
        for (int i = 0; i < bank.window_; ++i) {
          const int x = ((2 * (i - half) + 1) * per_sample / 2 - dx * stride + 2 * n) % n;
          values[static_cast<std::size_t>(j * bank.window_ + i)] = fine(y, x);
        }
      }
      if (!spec.eye) normalise(values);
      const auto t = static_cast<std::size_t>(o * bank.places_ + place);
      float* target = bank.values_.data() + t / block * block * count + t % block;
      for (std::size_t s = 0; s < count; ++s) target[s * block] = static_cast<float>(values[s]);
    }
  }
  if (spec.eye) bank.add_eye(spec, alternatives, size_samples, filter);
  return bank;
}

void TemplateBank::add_eye(const TemplateObserverSpec& spec, const Alternatives& alternatives, double size_samples,
                           const FilterTable& filter) {
  // One scale for all: that of the noise must be the same for every template.
  const double norm = std::sqrt(square(static_cast<std::size_t>(central_place())));
  for (float& value : values_) value = static_cast<float>(static_cast<double>(value) / norm);
  const double sample_deg = arcmin_per_sample(*spec.display) / 60;
  const int steps = static_cast<int>(std::lround(1 / spec.search_step_samples));
  EyeTemplates templates{.steps = steps,
                         .reach = static_cast<int>(std::lround(spec.search_range_samples * steps)),
                         .sample_deg = sample_deg,
                         .contrast_noise = spec.eye->contrast_noise,
                         .template_scale = norm * sample_deg * sample_deg,
                         .display = *spec.display};
  for (const Polygon& shape : alternatives) templates.shapes.push_back(placed(shape, size_samples, {0, 0}));
  eye_ = std::make_shared<const EyeNoise>(std::move(templates), filter);
}

double TemplateBank::square(std::size_t index) const {
  const auto count = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  const float* source = values_.data() + index / block * block * count + index % block;
  double sum = 0;
  for (std::size_t s = 0; s < count; ++s) sum += std::pow(static_cast<double>(source[s * block]), 2);
  return sum;
}

void TemplateBank::project(std::span<const float> patch, std::span<float> scores) const {
  const auto count = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  CV_Assert(patch.size() == count && scores.size() == padded_templates());
  for (std::size_t b = 0; b < blocks_; ++b)
    block_product(values_.data() + b * block * count, patch.data(), count, scores.data() + b * block);
}

void TemplateBank::project_all(std::span<const std::span<const float>> patches,
                               std::span<const std::span<float>> scores) const {
  const auto count = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  CV_Assert(patches.size() == scores.size());
  for (std::size_t k = 0; k < patches.size(); ++k)
    CV_Assert(patches[k].size() == count && scores[k].size() == padded_templates());
  for (std::size_t b = 0; b < blocks_; ++b) {
    const float* values = values_.data() + b * block * count;
    std::size_t k = 0;
    const auto take = [&]<std::size_t sets>(std::integral_constant<std::size_t, sets>) {
      for (; k + sets <= patches.size(); k += sets) {
        std::array<const float*, sets> factors{};
        std::array<float*, sets> sums{};
        for (std::size_t i = 0; i < sets; ++i) {
          factors[i] = patches[k + i].data();
          sums[i] = scores[k + i].data() + b * block;
          std::fill_n(sums[i], block, 0.0F);
        }
        add_block_products(values, factors, count, sums);
      }
    };
    take(std::integral_constant<std::size_t, products_at_once>());
    take(std::integral_constant<std::size_t, 2>());
    if (k < patches.size()) block_product(values, patches[k].data(), count, scores[k].data() + b * block);
  }
}

void TemplateBank::copy_template(std::size_t index, std::span<float> values) const {
  const auto count = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  CV_Assert(values.size() == count && index < static_cast<std::size_t>(templates()));
  const float* source = values_.data() + index / block * block * count + index % block;
  for (std::size_t s = 0; s < count; ++s) values[s] = source[s * block];
}

void TemplateBank::add_sample(std::size_t sample, float amount, std::span<float> scores) const {
  const auto count = static_cast<std::size_t>(window_) * static_cast<std::size_t>(window_);
  CV_Assert(sample < count && scores.size() == padded_templates());
  for (std::size_t b = 0; b < blocks_; ++b) {
    const float* column = values_.data() + (b * count + sample) * block;
    for (std::size_t t = 0; t < block; ++t) scores[b * block + t] += amount * column[t];
  }
}

cv::Mat1f TemplateBank::image(int alternative, int place) const {
  cv::Mat1f out(window_, window_);
  copy_template(static_cast<std::size_t>(alternative * places_ + place), std::span(out.ptr<float>(), out.total()));
  return out;
}

}  // namespace todbench
