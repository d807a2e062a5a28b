// SPDX-License-Identifier: GPL-3.0-or-later
// plan_keys_page FILE: writes the page of the plan's keys.
#include <cstdio>

#include "bench/plan/plan_keys.h"
#include "bench/text/files.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto written = todbench::write_file_atomically(argv[1], todbench::plan_keys_page());
  if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return written ? 0 : 1;
}
