// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as the file of one picture: .npy or TIFF.
#include "acquisition/recording/picture_file.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  (void)parse_npy({reinterpret_cast<const char*>(data), size});
  const fuzz::MemoryFile file(data, size);
  (void)read_picture(file.path());
  return 0;
}
