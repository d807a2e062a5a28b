// The inner loop of template banks: many sums of products at once.
#pragma once

#include <array>
#include <cstddef>

namespace todbench {

/// sums[t] = sum over s of factors[s] values[s][t], t = 0..TemplateBank::block-1, s in increasing order: the same bits
/// on every instruction set.
void block_product(const float* values, const float* factors, std::size_t count, float* sums);

/// How many sets of factors block_products() takes.
inline constexpr std::size_t products_at_once = 4;
/// block_product() of several factors with the same values, which are read once: the same bits.
void block_products(const float* values, const std::array<const float*, products_at_once>& factors, std::size_t count,
                    const std::array<float*, products_at_once>& sums);

}  // namespace todbench
