#include "bench/session/build_info.h"

#include "todbench_build_info.h"

namespace todbench {

BuildInfo build_info() {
  return {TODBENCH_VERSION, TODBENCH_COMMIT, TODBENCH_COMPILER};
}

}  // namespace todbench
