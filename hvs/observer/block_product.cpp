#include "hvs/observer/block_product.h"

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

}  // namespace

void block_product(const float* values, const float* factors, std::size_t count, float* sums) {
  product(values, factors, count, sums);
}

}  // namespace todbench
