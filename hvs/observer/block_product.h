// The inner loop of template banks: many sums of products at once.
#pragma once

#include <cstddef>

namespace todbench {

/// sums[t] = sum over s of factors[s] values[s][t], t = 0..TemplateBank::block-1, s in increasing order: the same bits
/// on every instruction set.
void block_product(const float* values, const float* factors, std::size_t count, float* sums);

}  // namespace todbench
