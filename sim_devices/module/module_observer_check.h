// The contract test for authors of observers that are programs.
#pragma once

#include <vector>

#include "sim_devices/module/module_observer.h"

namespace todbench {

/// Targets of one size that it was asked about.
struct JudgedSize {
  double size_samples = 0;  ///< square root of area
  int samples_per_pitch = 1;
  int window_samples = 0;  ///< side of the patch
  int asked = 0, right = 0;
};

/// What a program that keeps the contract of an observer was found to do. Nothing of it is a fault.
struct ObserverModuleReport {
  std::vector<JudgedSize> sizes;
  bool network_cut = false;    ///< it could reach nobody
  double latency_ms = 0;       ///< median of twenty patches of a target of 5 samples
  bool order_matters = false;  ///< another process, asked in the opposite order, gave other scores
};

/// Starts the program several times and asks it about patches of targets without sensor noise, every alternative at
/// nine places within a sample, seen with the internal noise of `spec`. Errors: those of the module, and `integrity`
/// when two processes score the same patches in the same order differently.
[[nodiscard]] Result<ObserverModuleReport> check_observer(const TemplateObserverSpec& spec,
                                                          const Alternatives& alternatives, const ModulePlan& module);

}  // namespace todbench
