// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/certificate_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "acquisition/base/safe_text.h"
#include "acquisition/base/try.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "bench/text/xml_tree.h"

namespace todbench {
namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// Name of a quantity or item: its first text in any language.
std::string name_of(const XmlElement& element) {
  const XmlElement* name = element.child("name");
  return name == nullptr ? std::string() : name->text_of("content");
}

Result<double> number_of(const std::string& text, const std::string& of) {
  const auto number = parse_number(text);
  if (!number || !std::isfinite(*number))
    return fail(ErrorCode::invalid_input, one_line(of) + ": expected a number, found \"" + one_line(text) + "\"");
  return *number;
}

/// Places of the expanded uncertainty in D-SI 1 and 2.1 (expandedUnc) and 2.2 (expandedMU), with their elements.
struct UncertaintyPlace {
  std::string_view around, inside, uncertainty, factor;
};
constexpr std::array scalar_places{
    UncertaintyPlace{"", "expandedUnc", "uncertainty", "coverageFactor"},
    UncertaintyPlace{"measurementUncertaintyUnivariate", "expandedMU", "valueExpandedMU", "coverageFactor"}};
constexpr std::array list_places{
    UncertaintyPlace{"", "expandedUncXMLList", "uncertaintyXMLList", "coverageFactorXMLList"},
    UncertaintyPlace{"measurementUncertaintyUnivariateXMLList", "expandedMUXMLList", "valueExpandedMUXMLList",
                     "coverageFactorXMLList"}};

struct UncertaintyTexts {
  std::string uncertainty, factor;
};

template <std::size_t N>
std::optional<UncertaintyTexts> uncertainty_in(const XmlElement& real, const std::array<UncertaintyPlace, N>& places) {
  for (const UncertaintyPlace& place : places) {
    const XmlElement* around = place.around.empty() ? &real : real.child(place.around);
    const XmlElement* inside = around == nullptr ? nullptr : around->child(place.inside);
    if (inside != nullptr) return UncertaintyTexts{inside->text_of(place.uncertainty), inside->text_of(place.factor)};
  }
  return std::nullopt;
}

Result<void> add_value(const std::string& name, const std::string& unit, const std::string& value,
                       const std::string& uncertainty, const std::string& factor, InstrumentCertificate& out) {
  CertifiedValue one{.name = name, .unit = unit};
  TODBENCH_TRY(one.value, number_of(value, name));
  TODBENCH_TRY(one.uncertainty, number_of(uncertainty, name));
  TODBENCH_TRY(one.coverage_factor, number_of(factor, name));
  if (one.uncertainty < 0 || !(one.coverage_factor > 0))
    return fail(ErrorCode::invalid_input, one_line(name) +
                                              ": the expanded uncertainty is negative, or its coverage "
                                              "factor is not above 0");
  out.values.push_back(std::move(one));
  return {};
}

/// A list of values has one word per value; uncertainty, factor and unit have as many, or one for all.
Result<void> add_list(const std::string& name, const XmlElement& list, InstrumentCertificate& out) {
  const auto stated = uncertainty_in(list, list_places);
  if (!stated) return {};
  const auto values = words_of(list.text_of("valueXMLList")), units = words_of(list.text_of("unitXMLList")),
             uncertainties = words_of(stated->uncertainty), factors = words_of(stated->factor);
  const auto fits = [&](const std::vector<std::string>& words) {
    return words.size() == 1 || words.size() == values.size();
  };
  if (!fits(units) || !fits(uncertainties) || !fits(factors))
    return fail(ErrorCode::invalid_input, one_line(name) + ": its lists have different lengths");
  const auto at = [](const std::vector<std::string>& words, std::size_t i) { return words[words.size() == 1 ? 0 : i]; };
  for (std::size_t i = 0; i < values.size(); ++i) {
    TODBENCH_TRY_VOID(add_value(name, at(units, i), values[i], at(uncertainties, i), at(factors, i), out));
  }
  return {};
}

/// Collects the quantities with an expanded uncertainty below an element, without conditions of the measurement.
/// parse_xml() limits the depth.
Result<void> collect(const XmlElement& element, InstrumentCertificate& out) {
  for (const XmlElement& child : element.children) {
    if (child.name == "influenceConditions") continue;
    if (child.name != "quantity") {
      TODBENCH_TRY_VOID(collect(child, out));
      continue;
    }
    const std::string name = name_of(child);
    if (const XmlElement* real = child.child("real")) {
      if (const auto stated = uncertainty_in(*real, scalar_places)) {
        TODBENCH_TRY_VOID(
            add_value(name, real->text_of("unit"), real->text_of("value"), stated->uncertainty, stated->factor, out));
      }
    }
    if (const XmlElement* list = child.child("realListXMLList")) {
      TODBENCH_TRY_VOID(add_list(name, *list, out));
    }
  }
  return {};
}

std::string serial_of(const XmlElement& item) {
  const XmlElement* identifications = item.child("identifications");
  if (identifications == nullptr) return {};
  for (const XmlElement& one : identifications->children) {
    const std::string name = lower_case(name_of(one));
    if (name.find("serial") != std::string::npos || name.find("serien") != std::string::npos)
      return one.text_of("value");
  }
  return {};
}

/// Kelvin in a D-SI unit of temperature; empty: another unit.
std::optional<double> kelvin_in(std::string_view unit) {
  double factor = 1;
  for (const auto& [prefix, times] : {std::pair<std::string_view, double>{"\\milli", 1e-3}, {"\\micro", 1e-6}}) {
    if (!unit.starts_with(prefix)) continue;
    factor = times;
    unit.remove_prefix(prefix.size());
  }
  return unit == "\\kelvin" || unit == "\\degreecelsius" ? std::optional(factor) : std::nullopt;
}

/// Takes a text of the certificate, or compares it with the stated one.
Result<void> join(std::string& stated, const std::string& certified, const char* what) {
  if (stated.empty()) stated = one_line(certified);
  if (certified.empty() || stated == one_line(certified)) return {};
  return fail(ErrorCode::invalid_input, std::string("the certificate is of ") + what + " " + one_line(certified) +
                                            ", but the plan states " + one_line(stated));
}

}  // namespace

Result<InstrumentCertificate> parse_certificate(std::string_view xml) {
  TODBENCH_TRY(const XmlElement root, parse_xml(xml));
  const XmlElement* administration = root.child("administrativeData");
  const XmlElement* results = root.child("measurementResults");
  if (root.name != "digitalCalibrationCertificate" || administration == nullptr || results == nullptr)
    return fail(ErrorCode::invalid_input,
                "not a digital calibration certificate: expected the elements digitalCalibrationCertificate, "
                "administrativeData and measurementResults");
  InstrumentCertificate out;
  if (const XmlElement* core = administration->child("coreData")) out.number = core->text_of("uniqueIdentifier");
  if (out.number.empty()) return fail(ErrorCode::invalid_input, "the certificate has no unique identifier");
  const XmlElement* items = administration->child("items");
  if (const XmlElement* item = items == nullptr ? nullptr : items->child("item")) {
    out.item = name_of(*item);
    out.serial = serial_of(*item);
  }
  TODBENCH_TRY_VOID(collect(*results, out));
  return out;
}

Result<BudgetRow> black_body_row(const InstrumentCertificate& certificate, const std::string& quantity,
                                 const std::string& file) {
  const CertifiedValue* widest = nullptr;
  double widest_k = -1;
  std::string names;
  for (const CertifiedValue& one : certificate.values) {
    if (one.unit.find("\\radian") != std::string::npos)
      return fail(ErrorCode::invalid_input, "the certificate of " + one_line(certificate.item) + " states angles (" +
                                                one_line(one.name) + "): it is not that of a black body");
    const auto kelvin = kelvin_in(one.unit);
    if (!kelvin) continue;
    names += (names.empty() ? "" : "; ") + one_line(one.name);
    if (!quantity.empty() && one.name != quantity) continue;
    const double standard_k = one.uncertainty * *kelvin / one.coverage_factor;
    if (standard_k <= widest_k) continue;
    widest = &one;
    widest_k = standard_k;
  }
  if (widest == nullptr)
    return fail(ErrorCode::invalid_input,
                names.empty() ? "no temperature of the certificate has an expanded uncertainty"
                              : "the certificate has no temperature named '" + quantity + "', but: " + names);
  return BudgetRow{.name = "black body calibration",
                   .value = widest->uncertainty * *kelvin_in(widest->unit),
                   .coverage_factor = widest->coverage_factor,
                   .unit = "K",
                   .source = "DCC " + one_line(file) + ", " +
                             (certificate.item.empty() ? "" : one_line(certificate.item) + ", ") +
                             one_line(widest->name),
                   .certificate = one_line(certificate.number),
                   .enters = BudgetInput::black_body_calibration};
}

Result<void> apply_certificate(Plan& plan, std::size_t row, const std::filesystem::path& folder) {
  InstrumentPlan& instrument = plan.instruments[row];
  const std::filesystem::path file = folder / instrument.dcc;
  std::error_code none;
  if (std::filesystem::is_regular_file(file, none) && std::filesystem::file_size(file, none) > XmlLimits{}.bytes)
    return fail(ErrorCode::invalid_input,
                file.string() + ": larger than " + std::to_string(XmlLimits{}.bytes >> 20) + " MiB");
  TODBENCH_TRY(const std::string text, read_text_file(file));
  const auto read = parse_certificate(text);
  if (!read) return fail(file.string(), read.error());
  TODBENCH_TRY_VOID(join(instrument.serial, read->serial, "serial number"));
  TODBENCH_TRY_VOID(join(instrument.certificate, read->number, "number"));
  if (role_of(instrument) == InstrumentRole::black_body) {
    const auto& rows = plan.uncertainty.rows;
    const bool stated = std::any_of(rows.begin(), rows.end(), [](const BudgetRow& one) {
      return input_of(one) == BudgetInput::black_body_calibration;
    });
    if (stated)
      return fail(
          ErrorCode::invalid_input,
          "the budget has a row for the calibration of the black body already: leave out that row, or the file");
    TODBENCH_TRY(BudgetRow added, black_body_row(*read, instrument.dcc_quantity,
                                                 file.filename().string() + ", SHA-256 " + sha256_of(text)));
    plan.uncertainty.rows.push_back(std::move(added));
  } else if (instrument.role == InstrumentRole::by_name) {
    return fail(ErrorCode::invalid_input, "'" + one_line(instrument.name) +
                                              "' has no role: state role = \"black body\", whose uncertainty enters "
                                              "the budget, \"plate stage\" or \"other\"");
  } else if (!instrument.dcc_quantity.empty()) {
    return fail(ErrorCode::invalid_input,
                "dcc_quantity is for the role \"black body\" only: the uncertainty of no "
                "other instrument is taken from its certificate");
  }
  instrument.dcc.clear();
  instrument.dcc_quantity.clear();
  return {};
}

}  // namespace todbench
