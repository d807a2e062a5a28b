// SPDX-License-Identifier: GPL-3.0-or-later
// Reproduction of the experiment of the EO-VISTA paper (Bijl, Hogervorst and Vos), sections 4.1 and 4.2, with the
// sensor and observers of this program.
#pragma once

#include <cstdint>
#include <stop_token>

#include "acquisition/base/accuracy.h"
#include "bench/report/reproduction_page.h"

namespace todbench {

/// Options of the reproduction.
struct EoVistaOptions {
  Accuracy accuracy;
  int presentations = 24;  ///< pictures of the emulated camera at each contrast; 40 answers each
  int dsr_frames = 16;     ///< averaged by DSR2
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Computes the reproduction on as many threads as there are processors, at most eight; the result does not depend on
/// their number. Errors: `interrupted`, and those of its parts.
[[nodiscard]] Result<Reproduction> reproduce_eo_vista(const EoVistaOptions& options);

}  // namespace todbench
