// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/certificate/calibration_certificate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/base/try.h"
#include "bench/judgement/demand_kinds.h"
#include "bench/plan/quantity.h"
#include "bench/report/markup.h"
#include "bench/session/answered_instruments.h"
#include "bench/session/build_info.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

Markup dcc(std::string_view name, const Markup& content, std::string_view attributes = "") {
  return element("dcc:" + std::string(name), content, attributes) + literal("\n");
}

/// Element with a plain text; empty if the text is.
Markup dcc_text(std::string_view name, std::string_view text) {
  return text.empty() ? Markup{} : dcc(name, escaped(text));
}

/// Element with a text in a language: <dcc:NAME><dcc:content lang="en">TEXT</dcc:content></dcc:NAME>.
Markup dcc_rich(std::string_view name, std::string_view text) {
  return text.empty() ? Markup{} : dcc(name, element("dcc:content", escaped(text), "lang=\"en\""));
}

Markup si(std::string_view name, std::string_view text) {
  return element("si:" + std::string(name), escaped(text));
}

/// A value with expanded uncertainty; without one for conditions.
struct CertifiedUncertainty {
  double uncertainty = 0, coverage_factor = 0;
};

/// Errors: `internal` (not finite), so that no NaN reaches a file.
Result<Markup> quantity(std::string_view name, std::string_view unit, double value,
                        const std::optional<CertifiedUncertainty>& expanded) {
  if (!std::isfinite(value) ||
      (expanded && !(std::isfinite(expanded->uncertainty) && std::isfinite(expanded->coverage_factor))))
    return fail(ErrorCode::internal, std::string(name) + ": not a finite number");
  Markup real = si("value", number_text(value)) + si("unit", unit);
  if (expanded) {
    real += element("si:expandedUnc", si("uncertainty", number_text(expanded->uncertainty)) +
                                          si("coverageFactor", number_text(expanded->coverage_factor)) +
                                          si("coverageProbability", "0.95"));
  }
  return dcc("quantity", dcc_rich("name", name) + element("si:real", real));
}

std::string day_of(std::string_view utc) {
  return std::string(utc.substr(0, 10));
}

Result<void> check_order(const OrderPlan& order, const Provenance& provenance) {
  std::string missing;
  const auto need = [&](const char* key, const std::string& value) {
    if (value.empty()) missing += (missing.empty() ? "" : ", ") + std::string(key);
  };
  need("customer", order.customer);
  need("report_number", order.report_number);
  need("laboratory", order.laboratory);
  need("country", order.country);
  need("issued", order.issued);
  need("authorised_by", order.authorised_by);
  if (!missing.empty()) {
    return fail(ErrorCode::invalid_input,
                "section [order] lacks " + missing +
                    ", which a certificate needs: complete that of the plan, or name a file with --order");
  }
  if (order.issued < day_of(provenance.ended_utc)) {
    return fail(ErrorCode::invalid_input,
                "issued " + order.issued + " is before the end of the measurement, " + day_of(provenance.ended_utc));
  }
  if (!order.received.empty() && order.received > day_of(provenance.started_utc)) {
    return fail(ErrorCode::invalid_input, "received " + order.received + " is after the start of the measurement, " +
                                              day_of(provenance.started_utc));
  }
  return {};
}

Result<void> check_session_state(const Session& session) {
  const auto wrong = [](const std::string& why) { return fail(ErrorCode::invalid_input, why); };
  if (session.cut_off || !session.complete())
    return wrong("the run ended early: a certificate needs a complete session");
  const auto contradictions = contradicted_instruments(session.plan.instruments, session.provenance.target);
  if (!contradictions.empty()) return wrong(contradictions.front());
  if (session.provenance.side != Side::measured || !session.provenance.camera)
    return wrong("no camera was measured: a simulation gets no certificate");
  if (!session.curve || session.curve->points.empty()) return wrong("the session has no curve to certify");
  if (!session.uncertainty)
    return wrong("the plan has no uncertainty budget: a certificate states expanded uncertainties");
  for (const TodPoint& point : session.curve->points) {
    const PointUncertainty* expanded = point_at(*session.uncertainty, point.set_delta_t_k);
    if (expanded == nullptr || !expanded->combined || !point.fit.threshold || !expanded->expanded_mrad.low ||
        !expanded->expanded_mrad.high) {
      return wrong("the threshold at " + number_text(point.set_delta_t_k) +
                   " K has no value with expanded uncertainty: a certificate needs one at every contrast");
    }
  }
  return {};
}

Markup software() {
  return dcc("dccSoftware", dcc("software", dcc_rich("name", "todbench") +
                                                dcc_text("release", std::string(build_info().version) + " (" +
                                                                        std::string(build_info().commit) + ")")));
}

Markup core_data(const Session& session, const OrderPlan& order) {
  return dcc("coreData", dcc_text("countryCodeISO3166_1", order.country) + dcc_text("usedLangCodeISO639_1", "en") +
                             dcc_text("mandatoryLangCodeISO639_1", "en") +
                             dcc_text("uniqueIdentifier", order.report_number) +
                             dcc_text("receiptDate", order.received) +
                             dcc_text("beginPerformanceDate", day_of(session.provenance.started_utc)) +
                             dcc_text("endPerformanceDate", day_of(session.provenance.ended_utc)) +
                             dcc_text("performanceLocation", "laboratory") + dcc_text("issueDate", order.issued));
}

Markup identification(std::string_view issuer, std::string_view value, std::string_view name) {
  if (value.empty()) return {};
  return dcc("identification", dcc_text("issuer", issuer) + dcc_text("value", value) + dcc_rich("name", name));
}

Markup items(const CameraRecord& camera, const OrderPlan& order) {
  const std::string name = order.item.empty() ? camera.vendor + " " + camera.model : order.item;
  const Markup identified = identification("manufacturer", camera.serial, "serial number") +
                            identification("manufacturer", camera.firmware, "firmware") +
                            identification("calibrationLaboratory", camera.id, "camera id");
  Markup item = dcc_rich("name", name);
  if (!camera.vendor.empty()) item += dcc("manufacturer", dcc_rich("name", camera.vendor));
  item += dcc_text("model", camera.model);
  item += dcc("identifications", identified);
  return dcc("items", dcc("item", item));
}

Markup location(std::string_view address) {
  return dcc("location", dcc_rich("further", address.empty() ? "not stated" : address));
}

std::string observer_words(const Session& session) {
  return "Judged by the observer " + session.curve->observer + ", a model with stated parameters, not a person.";
}

Result<Markup> statements(const Session& session, const OrderPlan& order) {
  const auto statement = [](std::string_view text) { return dcc("statement", dcc_rich("declaration", text)); };
  Markup all = statement(not_in_part) + statement("The results relate only to the item under test.");
  all += statement(observer_words(session));
  if (!order.item_condition.empty()) all += statement("Condition of the item: " + order.item_condition);
  all += statement("Deviations from the method: " + (order.deviations.empty() ? "none" : order.deviations));
  all += statement("The session behind this certificate has the manifest SHA-256 " + session.manifest_sha256 + ".");
  return dcc("statements", all);
}

Markup persons(const OrderPlan& order) {
  return dcc("respPersons",
             dcc("respPerson", dcc("person", dcc_rich("name", order.authorised_by)) +
                                   dcc_text("role", order.authorised_role) + dcc_text("mainSigner", "true")));
}

Result<Markup> administrative_data(const Session& session, const OrderPlan& order) {
  TODBENCH_TRY(const Markup stated, statements(session, order));
  return dcc("administrativeData",
             software() + core_data(session, order) + items(*session.provenance.camera, order) +
                 dcc("calibrationLaboratory",
                     dcc("contact", dcc_rich("name", order.laboratory) + location(order.laboratory_address))) +
                 persons(order) + dcc("customer", dcc_rich("name", order.customer) + location(order.customer_address)) +
                 stated);
}

Markup methods(const OrderPlan& order) {
  const std::string name = order.method.empty() ? "Triangle orientation discrimination (TOD)" : order.method;
  Markup method = dcc_rich("name", name);
  method +=
      dcc_rich("description",
               "Size of an equilateral triangle whose orientation is judged correctly in 75 % of the trials, from "
               "a psychometric function fitted to the answers (Bijl and Valeton 1998).");
  method += dcc_text("norm", order.method_reference);
  return dcc("usedMethods", dcc("usedMethod", method));
}

Markup instruments(const std::vector<InstrumentPlan>& rows) {
  Markup all;
  for (const InstrumentPlan& row : rows) {
    Markup one = dcc_rich("name", row.name);
    const Markup identified = identification("manufacturer", row.serial, "serial number") +
                              identification("calibrationLaboratory", row.certificate, "calibration certificate");
    if (!identified.empty()) one += dcc("identifications", identified);
    all += dcc("measuringEquipment", one);
  }
  return all.empty() ? all : dcc("measuringEquipments", all);
}

Result<Markup> conditions(const Session& session, const OrderPlan& order) {
  Markup all;
  const auto add = [&](const char* name, const char* unit, const std::optional<double>& value) -> Result<void> {
    if (!value) return {};
    TODBENCH_TRY(const Markup data, quantity(name, unit, *value, {}));
    all += dcc("influenceCondition", dcc_rich("name", name) + dcc("data", data));
    return {};
  };
  const double distance_m = session.plan.target.distance_m;
  for (const auto& added : {add("room temperature", "\\degreecelsius", order.room_temperature_c),
                            add("relative humidity", "\\percent", order.humidity_percent),
                            add("camera temperature", "\\degreecelsius", order.camera_temperature_c),
                            add("distance from entrance pupil to plate", "\\metre",
                                distance_m > 0 ? std::optional(distance_m) : std::nullopt)}) {
    if (!added) return tl::unexpected(added.error());
  }
  return all.empty() ? all : dcc("influenceConditions", all);
}

/// The larger side of an interval about a value: a certificate states one number.
double half_width(double value, const Interval& interval) {
  return std::max(value - *interval.low, *interval.high - value);
}

Result<Markup> point_result(const TodPoint& point, const PointUncertainty& expanded) {
  const double s75 = *point.fit.threshold, k = expanded.combined->k;
  const Interval acuity = acuity_interval(expanded.expanded_mrad);
  TODBENCH_TRY(const Markup contrast, quantity("contrast of the target, set", "\\kelvin", point.set_delta_t_k, {}));
  TODBENCH_TRY(const Markup size, quantity("S75, triangle size at 75 % correct", "\\milli\\radian", s75,
                                           CertifiedUncertainty{half_width(s75, expanded.expanded_mrad), k}));
  TODBENCH_TRY(const Markup inverse, quantity("75 % acuity", "\\milli\\radian\\tothe{-1}", 1 / s75,
                                              CertifiedUncertainty{half_width(1 / s75, acuity), k}));
  return dcc("result", dcc_rich("name", "TOD at a contrast of " + number_text(point.set_delta_t_k) + " K") +
                           dcc_rich("description",
                                    "The expanded uncertainty is the larger side of the 95 % interval, which is not "
                                    "symmetric: S75 from " +
                                        number_text(*expanded.expanded_mrad.low) + " to " +
                                        number_text(*expanded.expanded_mrad.high) + " mrad.") +
                           dcc("data", dcc("list", contrast + size + inverse)));
}

/// D-SI units of the units of physical measures.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> si_units{
    {{"1", "\\one"},
     {"%", "\\percent"},
     {"Hz", "\\hertz"},
     {"K", "\\kelvin"},
     {"K/K", "\\one"},
     {"K/min", "\\kelvin\\minute\\tothe{-1}"},
     {"deg", "\\degree"},
     {"mrad", "\\milli\\radian"},
     {"ms", "\\milli\\second"}}};

/// Normal quantile of a two-sided 95 % interval.
constexpr double normal_k95 = 1.96;

/// A physical measure: its interval with the budget, else its statistical interval. Empty if it has no two-sided
/// interval, an interval of no width (values of the plan and of the sensor model, numbers of pixels: no measurement
/// with an uncertainty) or no D-SI unit.
Result<Markup> measure_result(const MeasureLine& line) {
  const Interval& interval = line.expanded.value_or(line.ci95);
  const auto unit = std::find_if(si_units.begin(), si_units.end(), [&](const auto& u) { return u.first == line.unit; });
  if (!line.value || !interval.low || !interval.high || *interval.low == *interval.high || unit == si_units.end())
    return Markup{};
  const Quantity* known = find_quantity(line.measure);
  TODBENCH_TRY(const Markup value, quantity(line.measure, unit->second, *line.value,
                                            CertifiedUncertainty{half_width(*line.value, interval), normal_k95}));
  const std::string words =
      (known == nullptr ? "" : std::string(known->definition) + " ") +
      "Interval of 95 %: " + number_text(*interval.low) + " to " + number_text(*interval.high) + " " + line.unit +
      (line.expanded ? ", with the uncertainty budget" : ", random variation only: the budget has no row for it") +
      (line.conditions.empty() ? "" : ". Conditions: " + line.conditions);
  return dcc("result", dcc_rich("name", known == nullptr ? std::string_view(line.measure) : known->title) +
                           dcc_rich("description", words) + dcc("data", value));
}

Result<Markup> results(const Session& session) {
  Markup all;
  for (const TodPoint& point : session.curve->points) {
    TODBENCH_TRY(const Markup one, point_result(point, *point_at(*session.uncertainty, point.set_delta_t_k)));
    all += one;
  }
  if (session.measures && session.measures->main) {
    for (const MeasureLine& line : session.measures->main->lines) {
      TODBENCH_TRY(const Markup one, measure_result(line));
      all += one;
    }
  }
  return dcc("results", all);
}

/// The decision of every demand. A demand that is not decided has no element for conformity.
Markup conformity(const Verdict& verdict) {
  Markup all;
  for (const Demand& demand : verdict.demands) {
    const std::string words = in_words(demand) + ": " + std::string(to_string(demand.decision)) +
                              (demand.reason.empty() ? "" : "; " + demand.reason);
    Markup one = dcc_rich("declaration", words + ". Decision rule: " + verdict.rule_in_words);
    if (demand.decision != VerdictKind::inconclusive) one += dcc_text("conformity", to_string(demand.decision));
    all += dcc("metaData", one);
  }
  return all.empty() ? all : dcc("measurementMetaData", all);
}

}  // namespace

Result<std::string> calibration_certificate(const Session& session, const OrderPlan& order) {
  TODBENCH_TRY_VOID(check_session_state(session));
  TODBENCH_TRY_VOID(check_order(order, session.provenance));
  TODBENCH_TRY(const Markup administration, administrative_data(session, order));
  TODBENCH_TRY(const Markup influences, conditions(session, order));
  TODBENCH_TRY(const Markup found, results(session));
  const Verdict verdict = verdict_of(session);
  const Markup measured = dcc(
      "measurementResults", dcc("measurementResult", dcc_rich("name", "Triangle orientation discrimination") +
                                                         methods(order) + instruments(session.provenance.instruments) +
                                                         influences + found + conformity(verdict)));
  const std::string attributes = "xmlns:dcc=\"https://ptb.de/dcc\" xmlns:si=\"https://ptb.de/si\" schemaVersion=\"" +
                                 std::string(certificate_schema_version) + "\"";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
         dcc("digitalCalibrationCertificate", administration + measured, attributes).text;
}

}  // namespace todbench
