// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/block_product.h"

#include "acquisition/base/multiversion.h"
#include "hvs/observer/template_bank.h"

namespace todbench {
namespace {

TODBENCH_MULTIVERSION
void product(const float* values, const float* factors, std::size_t count, float* out) {
  float sums[TemplateBank::block] = {};
  for (std::size_t s = 0; s < count; ++s) {
    const float factor = factors[s];
    const float* column = values + s * TemplateBank::block;
    for (std::size_t t = 0; t < TemplateBank::block; ++t) sums[t] += column[t] * factor;
  }
  for (std::size_t t = 0; t < TemplateBank::block; ++t) out[t] = sums[t];
}

TODBENCH_MULTIVERSION
void two_products(const float* values, const float* first, const float* second, std::size_t count, float* out_first,
                  float* out_second) {
  constexpr std::size_t lanes = 32;  // as many sums as registers hold
  for (std::size_t half = 0; half < TemplateBank::block; half += lanes) {
    float a[lanes] = {}, b[lanes] = {};
    for (std::size_t s = 0; s < count; ++s) {
      const float* column = values + s * TemplateBank::block + half;
      for (std::size_t t = 0; t < lanes; ++t) {
        a[t] += column[t] * first[s];
        b[t] += column[t] * second[s];
      }
    }
    for (std::size_t t = 0; t < lanes; ++t) {
      out_first[half + t] = a[t];
      out_second[half + t] = b[t];
    }
  }
}

TODBENCH_MULTIVERSION
void add_products(const float* values, const float* const* factors, std::size_t count, float* const* sums) {
  constexpr std::size_t lanes = 32;  // as many sums as registers hold
  const float *first = factors[0], *second = factors[1], *third = factors[2], *fourth = factors[3];
  for (std::size_t half = 0; half < TemplateBank::block; half += lanes) {
    float a[lanes], b[lanes], c[lanes], d[lanes];
    for (std::size_t t = 0; t < lanes; ++t) {
      a[t] = sums[0][half + t];
      b[t] = sums[1][half + t];
      c[t] = sums[2][half + t];
      d[t] = sums[3][half + t];
    }
    for (std::size_t s = 0; s < count; ++s) {
      const float* column = values + s * TemplateBank::block + half;
      for (std::size_t t = 0; t < lanes; ++t) {
        a[t] += column[t] * first[s];
        b[t] += column[t] * second[s];
        c[t] += column[t] * third[s];
        d[t] += column[t] * fourth[s];
      }
    }
    for (std::size_t t = 0; t < lanes; ++t) {
      sums[0][half + t] = a[t];
      sums[1][half + t] = b[t];
      sums[2][half + t] = c[t];
      sums[3][half + t] = d[t];
    }
  }
}

}  // namespace

void block_products(const float* values, const std::array<const float*, 2>& factors, std::size_t count,
                    const std::array<float*, 2>& sums) {
  two_products(values, factors[0], factors[1], count, sums[0], sums[1]);
}

void add_block_products(const float* values, const std::array<const float*, products_at_once>& factors,
                        std::size_t count, const std::array<float*, products_at_once>& sums) {
  add_products(values, factors.data(), count, sums.data());
}

void block_product(const float* values, const float* factors, std::size_t count, float* sums) {
  product(values, factors, count, sums);
}

}  // namespace todbench
