// SPDX-License-Identifier: GPL-3.0-or-later
// Protocol of an interlaboratory comparison for one laboratory, as a page.
#pragma once

#include <string>
#include <vector>

#include "bench/reference_set/reference_case.h"
#include "bench/report/document.h"

namespace todbench {

/// Facts for the protocol.
struct ProtocolFacts {
  std::string laboratory;
  std::vector<ReferenceCase> cases;
  int frames = 0;
  std::string sealed_sha256;  ///< SHA-256 of the file with the true values, which the coordinator keeps
};
/// Returns the protocol: items, files, measurand and the file of results. The protocol contains no sealed value.
[[nodiscard]] Document blind_protocol(const ProtocolFacts& facts);

}  // namespace todbench
