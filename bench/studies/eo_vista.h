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
  int presentations = 24;  ///< pictures of the emulated camera at each contrast, with 40 answers per picture
  int dsr_frames = 16;     ///< number of frames that the dynamic super-resolution DSR2 averages
  std::uint64_t seed = 1;
  std::stop_token stop{};
};

/// Computes the reproduction with one thread per processor, at most eight. The result does not depend on the number of
/// threads. Errors: `interrupted`, and those of its parts.
[[nodiscard]] Result<Reproduction> reproduce_eo_vista(const EoVistaOptions& options);

}  // namespace todbench
