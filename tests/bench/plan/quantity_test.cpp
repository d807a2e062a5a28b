// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/quantity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace todbench {
namespace {

using ::testing::EndsWith;

TEST(Quantities, HaveNamesOfTheirOwnAndAreComplete) {
  std::set<std::string_view> names, titles;
  for (const Quantity& quantity : quantities()) {
    EXPECT_TRUE(names.insert(quantity.name).second) << quantity.name;
    EXPECT_TRUE(titles.insert(quantity.title).second) << quantity.title;
    EXPECT_FALSE(quantity.unit.empty()) << quantity.name;
    EXPECT_THAT(quantity.definition, EndsWith(".")) << quantity.name;
  }
}

TEST(Quantities, NameKeysOfThePlan) {
  const auto known = [](std::string_view name) {
    return name.empty() || std::any_of(measure_keys.begin(), measure_keys.end(),
                                       [&](const MeasureKey& key) { return key.name == name; });
  };

  for (const Quantity& quantity : quantities())
    EXPECT_TRUE(known(quantity.measure) && known(quantity.second_measure)) << quantity.name;
}

TEST(Quantities, AreFoundWithAPlaceButLimitedWithoutOne) {
  ASSERT_NE(find_quantity("mtf_x (corner)"), nullptr);
  EXPECT_EQ(find_quantity("mtf_x (corner)")->name, "mtf_x");
  EXPECT_EQ(find_quantity("mtf"), nullptr);
  EXPECT_NE(find_limited_quantity("mtf_x"), nullptr);
  EXPECT_EQ(find_limited_quantity("mtf_x (corner)"), nullptr);
  EXPECT_EQ(find_limited_quantity("mtf_x_model"), nullptr);
}

}  // namespace
}  // namespace todbench
