// SPDX-License-Identifier: GPL-3.0-or-later
// main() of the benchmarks. What they cannot show: first-use costs inside a run (caches are warm unless a name says
// otherwise), and more than one thread.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  cv::setNumThreads(1);  // figures are per core
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
