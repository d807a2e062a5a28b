// SPDX-License-Identifier: GPL-3.0-or-later
// Contract test for authors of observer programs.
#pragma once

#include <vector>

#include "sim_devices/module/module_observer.h"

namespace todbench {

/// Test targets of one size.
struct JudgedSize {
  double size_samples = 0;  ///< square root of the area, in displayed samples
  int samples_per_pitch = 1;
  int window_samples = 0;    ///< side of the patch in samples
  int asked = 0, right = 0;  ///< number of decisions, and of correct decisions
};

/// Properties of an observer program that fulfils the contract. The contract allows any values of these properties.
struct ObserverModuleReport {
  std::vector<JudgedSize> sizes;
  bool network_cut = false;  ///< the program could not reach any other computer
  double latency_ms = 0;     ///< median time of twenty patches of a target of 5 samples
  /// A second process that received the patches in the opposite order returned different scores.
  bool order_matters = false;
};

/// Starts the program several times and sends it patches of targets without sensor noise. The patches show every
/// alternative at nine positions within a sample, with the internal noise of `spec`. Errors: those of the module, and
/// `integrity` if two processes score the same patches in the same order differently.
[[nodiscard]] Result<ObserverModuleReport> check_observer(const TemplateObserverSpec& spec,
                                                          const Alternatives& alternatives, const ModulePlan& module);

}  // namespace todbench
