#include "hvs/observer/block_product.h"

#include <algorithm>

#include "acquisition/core/multiversion.h"
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
void products(const float* values, const float* first, const float* second, const float* third, const float* fourth,
              std::size_t count, float* out) {
  constexpr std::size_t lanes = 32;  // as many sums as registers hold
  for (std::size_t half = 0; half < TemplateBank::block; half += lanes) {
    float a[lanes] = {}, b[lanes] = {}, c[lanes] = {}, d[lanes] = {};
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
      out[half + t] = a[t];
      out[TemplateBank::block + half + t] = b[t];
      out[2 * TemplateBank::block + half + t] = c[t];
      out[3 * TemplateBank::block + half + t] = d[t];
    }
  }
}

}  // namespace

void block_products(const float* values, const std::array<const float*, products_at_once>& factors, std::size_t count,
                    const std::array<float*, products_at_once>& sums) {
  float out[products_at_once * TemplateBank::block];
  products(values, factors[0], factors[1], factors[2], factors[3], count, out);
  for (std::size_t k = 0; k < products_at_once; ++k)
    std::copy_n(out + k * TemplateBank::block, TemplateBank::block, sums[k]);
}

void block_product(const float* values, const float* factors, std::size_t count, float* sums) {
  product(values, factors, count, sums);
}

}  // namespace todbench
