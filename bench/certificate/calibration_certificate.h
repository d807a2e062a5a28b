// SPDX-License-Identifier: GPL-3.0-or-later
// Digital calibration certificate (DCC) of a session: XML by the schema of PTB, with D-SI units. The certificate uses a
// subset of the schema, see docs/reference/certificate.md.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/order.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// Version of the DCC schema whose element names and order the certificate follows.
inline constexpr std::string_view certificate_schema_version = "3.2.1";

/// Returns the certificate as XML. The certificate contains administrative data, method, conditions, instruments, and
/// the decision with its rule. For each contrast it contains the threshold S75 and the acuity with expanded uncertainty
/// and coverage factor. The session must be measured and complete, with a budget and a threshold at every contrast. The
/// order must state customer, report number, laboratory, country, issue date and authorising person. Errors:
/// `invalid_input` that lists the missing entries.
[[nodiscard]] Result<std::string> calibration_certificate(const Session& session, const OrderPlan& order);

}  // namespace todbench
