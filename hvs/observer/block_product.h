// SPDX-License-Identifier: GPL-3.0-or-later
// Inner loop of template banks: many sums of products at once.
#pragma once

#include <array>
#include <cstddef>

namespace todbench {

/// sums[t] = sum over s of factors[s] values[s][t], t = 0..TemplateBank::block-1, s in increasing order: the same bits
/// on every instruction set.
void block_product(const float* values, const float* factors, std::size_t count, float* sums);

/// Number of sets of factors of add_block_products().
inline constexpr std::size_t products_at_once = 4;
/// Continues the sums of block_product() for several factors with the same values, which are read once. Started at 0
/// and called for successive parts of values and factors, it gives the same bits. A caller with many factors should
/// pass short parts to all of them, so that the values come from the nearest cache instead of from memory.
void add_block_products(const float* values, const std::array<const float*, products_at_once>& factors,
                        std::size_t count, const std::array<float*, products_at_once>& sums);

}  // namespace todbench
