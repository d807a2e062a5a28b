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

template <std::size_t sets>
TODBENCH_MULTIVERSION void add_products(const float* values, const float* const* factors, std::size_t count,
                                        float* const* sums) {
  constexpr std::size_t lanes = 32;  // as many sums as registers hold
  for (std::size_t half = 0; half < TemplateBank::block; half += lanes) {
    float own[sets][lanes];
    for (std::size_t k = 0; k < sets; ++k)
      for (std::size_t t = 0; t < lanes; ++t) own[k][t] = sums[k][half + t];
    for (std::size_t s = 0; s < count; ++s) {
      const float* column = values + s * TemplateBank::block + half;
      for (std::size_t k = 0; k < sets; ++k) {
        const float factor = factors[k][s];
        for (std::size_t t = 0; t < lanes; ++t) own[k][t] += column[t] * factor;
      }
    }
    for (std::size_t k = 0; k < sets; ++k)
      for (std::size_t t = 0; t < lanes; ++t) sums[k][half + t] = own[k][t];
  }
}

}  // namespace

template <std::size_t sets>
void add_block_products(const float* values, const std::array<const float*, sets>& factors, std::size_t count,
                        const std::array<float*, sets>& sums) {
  add_products<sets>(values, factors.data(), count, sums.data());
}
template void add_block_products<2>(const float*, const std::array<const float*, 2>&, std::size_t,
                                    const std::array<float*, 2>&);
template void add_block_products<products_at_once>(const float*, const std::array<const float*, products_at_once>&,
                                                   std::size_t, const std::array<float*, products_at_once>&);

void block_product(const float* values, const float* factors, std::size_t count, float* sums) {
  product(values, factors, count, sums);
}

}  // namespace todbench
