// SPDX-License-Identifier: GPL-3.0-or-later
// Reader of digital calibration certificates of instruments (DCC, XML with D-SI units): serial number, certificate
// number, and quantities with expanded uncertainty. Supports a subset of the format; see docs/reference/certificate.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/budget_row.h"
#include "bench/plan/plan.h"

namespace todbench {

/// A quantity of the results.
struct CertifiedValue {
  std::string name;
  std::string unit;  ///< D-SI, "\kelvin"
  double value = 0;
  double uncertainty = 0;  ///< expanded, in `unit`
  double coverage_factor = 0;
};

/// Content of the certificate of an instrument, as far as the budget uses it.
struct InstrumentCertificate {
  std::string number;  ///< unique identifier of the certificate
  std::string serial;  ///< serial number of the item
  std::string item;    ///< name of the item
  std::vector<CertifiedValue> values;
};

/// Parses a certificate. Errors: `invalid_input` (parse_xml(); a different kind of document; no number; a quantity with
/// an uncertainty that is negative or not a number).
[[nodiscard]] Result<InstrumentCertificate> parse_certificate(std::string_view xml);

/// Returns the budget row of a black body. Its value is the largest standard uncertainty of the temperatures with the
/// name `quantity` (empty: of all temperatures), stated as expanded uncertainty with its coverage factor. Errors:
/// `invalid_input` (no such temperature has an expanded uncertainty; the certificate contains angles and therefore
/// belongs to a camera).
[[nodiscard]] Result<BudgetRow> black_body_row(const InstrumentCertificate& certificate, const std::string& quantity,
                                               const std::string& file);

/// Fills in the serial number and the certificate of an instrument from its file `dcc`, relative to `folder`. Adds the
/// row of a black body to the budget. Clears `dcc`, because the plan then contains all values. Errors: `invalid_input`
/// (file too large, parse_certificate(), a serial number or certificate that differs from the stated one, an instrument
/// without a role, a quantity for an instrument that is not a black body, a second row for the calibration of the black
/// body).
[[nodiscard]] Result<void> apply_certificate(Plan& plan, std::size_t row, const std::filesystem::path& folder);

}  // namespace todbench
