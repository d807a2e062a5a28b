// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of .npy files.
#include "bench/picture_files/npy.h"

#include <gtest/gtest.h>

#include <cstring>

namespace todbench {
namespace {

TEST(Npy, HasAHeaderOfWholeBlocksAndTheNumbersBehindIt) {
  const std::string bytes = to_npy({{2, 3}, {1, 2, 3, 4, 5, 6.5}});

  ASSERT_EQ(bytes.substr(0, 6), "\x93NUMPY");
  const std::size_t header = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((10 + header) % 64, 0u);
  EXPECT_EQ(bytes.size(), 10 + header + 6 * 8);
  EXPECT_NE(bytes.find("'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), "), std::string::npos);
  double last = 0;
  std::memcpy(&last, bytes.data() + bytes.size() - 8, 8);
  EXPECT_EQ(last, 6.5);
}

TEST(Npy, WritesAListWithTheCommaThatPythonWants) {
  EXPECT_NE(to_npy({{3}, {1, 2, 3}}).find("'shape': (3, ), "), std::string::npos);
}

}  // namespace
}  // namespace todbench
