// SPDX-License-Identifier: GPL-3.0-or-later
// todbench-demo: the demonstration alone, for a fresh clone. It compiles half of the code of todbench.
#include "bench/cli/program.h"

int main(int argc, char** argv) {
  return todbench::run_demonstration(argc, argv);
}
