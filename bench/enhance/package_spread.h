// SPDX-License-Identifier: GPL-3.0-or-later
// Thresholds and ratios of packages over the open parameters of an observer with an eye, from the same patches.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/template_observer.h"
#include "tod/measurement/measurement.h"
#include "tod/presentation/trial.h"

namespace todbench {

struct Enhancement;
struct PackageResult;
struct FitOptions;

/// Trials of the same patches, first by the best and then by the worst observer within the open parameters.
struct EndTrials {
  std::array<std::vector<Trial>, 2> trials;  ///< empty: not computed
  std::optional<Error> failure;              ///< error of an observer; the trials are then incomplete
};

/// Observers at both limits of the open parameters. These observers judge the patches of a run after the observer of
/// the run. Frames, modules and packages are therefore computed only once. All packages use one object and therefore
/// share the templates.
class OpenEnds {
 public:
  /// Creates no observers if `observer` has no eye.
  explicit OpenEnds(const TemplateObserverSpec& observer);
  /// Lets both observers judge the patch of a trial and appends their answers to `into`. Both observers use the same
  /// random numbers as the observer of the run. `options`: options of the run.
  void judge(const Trial& trial, const Patch& patch, const MeasurementOptions& options, EndTrials& into);

 private:
  std::vector<std::unique_ptr<TemplateObserver>> ends_;
};

/// Adds the spreads to the thresholds of one result and to its ratios. `none`: result without a package; null if
/// `result` is this result. Returns one sentence for each threshold that has no spread although the observer has an
/// eye.
[[nodiscard]] std::vector<std::string> add_spreads(const FitOptions& options, const PackageResult* none,
                                                   PackageResult& result);

/// Returns whether a threshold or a ratio has a spread.
[[nodiscard]] bool any_spread(const Enhancement& enhancement);

}  // namespace todbench
