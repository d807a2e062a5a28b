// The inner loop of template banks: many sums of products at once.
#pragma once

#include <array>
#include <cstddef>

namespace todbench {

/// sums[t] = sum over s of factors[s] values[s][t], t = 0..TemplateBank::block-1, s in increasing order: the same bits
/// on every instruction set.
void block_product(const float* values, const float* factors, std::size_t count, float* sums);

/// How many sets of factors add_block_products() takes.
inline constexpr std::size_t products_at_once = 4;
/// Goes on with the sums of block_product() for several factors with the same values, which are read once: begun at 0
/// and over successive parts of values and factors the same bits. A caller with many factors gives short parts to all
/// of them, so that the values come from the nearest cache and not, for every four, from memory.
void add_block_products(const float* values, const std::array<const float*, products_at_once>& factors,
                        std::size_t count, const std::array<float*, products_at_once>& sums);

}  // namespace todbench
