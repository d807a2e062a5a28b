// todbench-demo: the demonstration alone, for those who have just cloned the project. It needs half of what todbench
// has to be compiled for.
#include "bench/cli/program.h"

int main(int argc, char** argv) {
  return todbench::run_demonstration(argc, argv);
}
