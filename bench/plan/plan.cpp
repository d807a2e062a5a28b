#include "bench/plan/plan.h"

namespace todbench {

std::string_view to_string(ScheduleKind kind) {
  return kind == ScheduleKind::constant ? "constant" : "adaptive";
}

std::string_view to_string(TargetKind kind) {
  switch (kind) {
    case TargetKind::scpi:
      return "scpi";
    case TargetKind::prompt:
      return "prompt";
    case TargetKind::scene:
      return "scene";
  }
  return "";
}

}  // namespace todbench
