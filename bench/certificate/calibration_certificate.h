// SPDX-License-Identifier: GPL-3.0-or-later
// Digital calibration certificate (DCC) of a session: XML after the schema of PTB, with D-SI units. A subset; see
// docs/reference/certificate.md.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/base/result.h"
#include "bench/plan/order.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// Version of the DCC schema whose names and order of elements the certificate follows.
inline constexpr std::string_view certificate_schema_version = "3.2.1";

/// Returns the certificate: administrative data, and for each contrast the threshold S75 and the acuity with expanded
/// uncertainty and coverage factor; method, conditions, instruments, decision with its rule. Errors: `invalid_input`
/// with what the certificate needs and the session or order does not state: a complete measured session, a budget, a
/// threshold at every contrast, and of the order customer, report number, laboratory, country, issue date and
/// authorising person.
[[nodiscard]] Result<std::string> calibration_certificate(const Session& session, const OrderPlan& order);

}  // namespace todbench
