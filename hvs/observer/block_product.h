// SPDX-License-Identifier: GPL-3.0-or-later
// Inner loop of template banks: computes many sums of products at once.
#pragma once

#include <array>
#include <cstddef>

namespace todbench {

/// Computes sums[t] = sum over s of factors[s] values[s][t], t = 0..TemplateBank::block-1, in increasing order of s.
/// Bit-identical on every instruction set.
void block_product(const float* values, const float* factors, std::size_t count, float* sums);

/// Number of sets of factors in one call of add_block_products().
inline constexpr std::size_t products_at_once = 4;
/// Adds the products of block_product() to the sums of several sets of factors. The values are read only once. If the
/// sums start at 0 and the calls cover successive parts of values and factors, the result is bit-identical to
/// block_product(). With many sets of factors, use short parts and process all sets for one part before the next part,
/// so that the values stay in the cache.
/// Defined for two and for products_at_once sets.
template <std::size_t sets>
void add_block_products(const float* values, const std::array<const float*, sets>& factors, std::size_t count,
                        const std::array<float*, sets>& sums);

}  // namespace todbench
