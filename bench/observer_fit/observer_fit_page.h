// SPDX-License-Identifier: GPL-3.0-or-later
// Page of an observer fitted to people.
#pragma once

#include "bench/observer_fit/people_fit.h"
#include "bench/report/document.h"

namespace todbench {

/// Returns the page: parameters with intervals and adequacy, and for each person residuals, figures and the confusion
/// matrix.
[[nodiscard]] Document people_fit_document(const PeopleFit& fit);

}  // namespace todbench
