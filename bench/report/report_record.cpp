// SPDX-License-Identifier: GPL-3.0-or-later
// Sections on conditions and provenance: people, equipment, geometry, frames and versions.
#include <algorithm>
#include <cmath>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

constexpr std::string_view not_reported = "not reported by the camera";
constexpr std::string_view not_in_plan = "not stated in the plan";

RichText number_or_missing(double value, int digits, const std::string& unit, std::string_view reason) {
  return std::isfinite(value) && value > 0 ? plain(significant(value, digits) + " " + unit) : missing(reason);
}

std::vector<NamedValue> camera_values(const SourceInfo& camera, const std::string& temperature_scale) {
  const std::string size = std::to_string(camera.width) + " × " + std::to_string(camera.height) + " pixels";
  return {{"Manufacturer", text_or_missing(camera.vendor, not_reported)},
          {"Model", text_or_missing(camera.model, not_reported)},
          {"Serial number", text_or_missing(camera.serial, not_reported)},
          {"Firmware", text_or_missing(camera.firmware, not_reported)},
          {"Identity", text_or_missing(camera.id, not_reported)},
          {"Transport", text_or_missing(camera.transport, not_reported)},
          {"Frame", plain(size + ", " + std::to_string(camera.significant_bits) + " bit") +
                        (camera.pixel_format.empty() ? RichText{} : plain(", " + camera.pixel_format))},
          {"Frame rate", number_or_missing(camera.frame_rate_hz, 3, "Hz", not_reported)},
          {"Temperature scale",
           text_or_missing(temperature_scale.empty() ? camera.scale.describe() : temperature_scale, "uncalibrated")}};
}

Block set_up_table(const ReportData& data) {
  Table rows;
  rows.caption = "Registration of the plate in the picture, once per set-up";
  rows.header = {"Plate",        "Mounting",          "Scale (px/mm)", "Scale deviation from plan (%)",
                 "Rotation (°)", "Residual (px rms)", "Triangles used"};
  for (const SetUpRecord& record : data.set_ups) {
    const Registration& registration = record.registration;
    rows.rows.push_back(
        {plain(record.plate), plain(in_words(record.mounting)), plain(shown(registration.scale_px_per_mm, 4)),
         plain(shown(100 * registration.scale_deviation, 2)), plain(shown(registration.rotation_deg, 2)),
         plain(shown(registration.residual_px, 3)), plain(std::to_string(registration.triangles_used))});
  }
  if (rows.rows.empty()) return Paragraph{plain("Registration: ") + missing("no plate was registered")};
  return rows;
}

Table plate_table(const ReportData& data) {
  Table rows;
  rows.caption = "Target plates; size is the square root of the area of a triangle";
  rows.header = {"Plate", "Width × height (mm)", "Triangles", "Sizes (mm)", "Sizes (mrad)"};
  for (const TargetPlate& plate : data.plates) {
    double least = 0;
    double most = 0;
    for (const PlateTriangle& triangle : plate.triangles) {
      least = least > 0 ? std::min(least, triangle.size_mm) : triangle.size_mm;
      most = std::max(most, triangle.size_mm);
    }
    const auto span = [](double from, double to) { return significant(from, 3) + " to " + significant(to, 3); };
    const bool distance_known = data.distance_m > 0;
    rows.rows.push_back({plain(plate.name), plain(stated(plate.width_mm) + " × " + stated(plate.height_mm)),
                         plain(std::to_string(plate.triangles.size())), plain(span(least, most)),
                         distance_known ? plain(span(least / data.distance_m, most / data.distance_m))
                                        : missing("distance not stated")});
  }
  return rows;
}

std::vector<NamedValue> text_values(const std::vector<std::pair<std::string, std::string>>& pairs) {
  std::vector<NamedValue> values;
  values.reserve(pairs.size());
  for (const auto& [name, value] : pairs) values.push_back({name, text_or_missing(value, "not recorded")});
  return values;
}

Paragraph sensor_paragraph(const SensorSpec& spec) {
  std::string text = spec.name + ": " + std::to_string(spec.width) + " × " + std::to_string(spec.height) +
                     " detectors, pitch " + stated(spec.pitch_um) +
                     (spec.pitch_aspect() == 1 ? "" : " × " + stated(spec.pitch_along(PitchAxis::y))) +
                     " µm, sensitive side " + stated(spec.detector_um) +
                     (spec.square_detector() ? "" : " × " + stated(spec.detector_along(PitchAxis::y))) +
                     " µm, focal length " + stated(spec.focal_length_mm) + " mm, f/" + stated(spec.f_number) + ", " +
                     stated(spec.wavelength_min_um) + " to " + stated(spec.wavelength_max_um) + " µm, NETD " +
                     stated(spec.netd_k) + " K, IFOV " + significant(spec.ifov_mrad(), 4) +
                     (spec.pitch_aspect() == 1 ? "" : " × " + significant(spec.ifov_mrad(PitchAxis::y), 4)) + " mrad.";
  return {plain(text)};
}

}  // namespace

Section identification_section(const ReportData& data) {
  ValueTable unit{"Unit under test", {{"Camera", missing("simulation only, no camera was measured")}}};
  if (data.camera)
    unit = {"Unit under test, as read from the camera", camera_values(*data.camera, data.temperature_scale)};
  ValueTable test{"Test",
                  {{"Session", text_or_missing(data.session, "not named")},
                   {"Description", text_or_missing(data.description, not_in_plan)},
                   {"Operator", text_or_missing(data.operator_name, not_in_plan)},
                   {"Place", text_or_missing(data.place, not_in_plan)},
                   {"Started", text_or_missing(data.started, "not recorded")},
                   {"Finished", text_or_missing(data.finished, "not recorded")}}};
  for (NamedValue& value : text_values(data.conditions)) test.values.push_back(std::move(value));
  return {"Unit and test", {TablePairs{{std::move(unit), std::move(test)}}}};
}

Section set_up_section(const ReportData& data) {
  const double field_mm = data.ifov_mrad * data.distance_m;
  Section section{"Set-up and geometry", {}};
  ValueTable values{"",
                    {{data.collimated ? "Focal length of the collimator" : "Distance, entrance pupil to plate",
                      number_or_missing(data.distance_m, 4, "m", not_in_plan)},
                     {"IFOV of a pixel", number_or_missing(data.ifov_mrad, 4, "mrad", not_in_plan)},
                     {"One pixel on the plate", number_or_missing(field_mm, 4, "mm", "needs distance and IFOV")}}};
  if (data.simulated_sensor && data.simulated_sensor->pitch_aspect() != 1)
    values.values.push_back(
        {"Height of a pixel", plain(significant(data.simulated_sensor->pitch_aspect(), 4) + " times its width")});
  values.values.push_back({"Target", text_or_missing(data.target, "not recorded")});
  values.values.push_back({"Observer", text_or_missing(data.observer, "not recorded")});
  section.blocks.emplace_back(std::move(values));
  if (!data.plates.empty()) section.blocks.emplace_back(plate_table(data));
  if (data.camera) section.blocks.push_back(set_up_table(data));
  if (auto contrasts = target_table(data)) section.blocks.emplace_back(*std::move(contrasts));
  return section;
}

Section effects_section(const ReportData& data) {
  Section section{"Effects simulated and skipped", {}};
  if (!data.simulated_sensor && data.plan.decisions.empty()) {
    section.blocks.emplace_back(Paragraph{missing("no sensor was simulated")});
    return section;
  }
  Table rows;
  rows.header = {"Effect, in the order of the signal chain", "Decision", "Reason", "Change of acuity if skipped (%)"};
  std::string neutral;
  for (const EffectDecision& decision : data.plan.decisions) {
    if (decision.changes_nothing()) {
      neutral += (neutral.empty() ? "" : ", ") + words(to_string(decision.effect));
      continue;
    }
    rows.rows.push_back({plain(in_words(decision.effect)),
                         plain(decision.decision == Decision::simulate ? "simulated" : "skipped"),
                         text_or_missing(decision.reason, "none given"),
                         decision.predicted_change_percent && std::isfinite(*decision.predicted_change_percent)
                             ? plain(significant(*decision.predicted_change_percent, 2))
                             : missing("no criterion predicts a value")});
  }
  if (data.simulated_sensor) section.blocks.emplace_back(sensor_paragraph(*data.simulated_sensor));
  section.blocks.emplace_back(std::move(rows));
  if (!neutral.empty())
    section.blocks.emplace_back(Paragraph{strong("Neutral in this sensor, so skipped without a change:") +
                                          plain(" " + neutral + ". provenance.json states each reason.")});
  return section;
}

std::optional<Section> frames_section(const ReportData& data) {
  if (!data.camera) return {};
  std::uint64_t rejected = 0;
  for (const auto& [reason, count] : data.frames_rejected) rejected += count;
  const std::uint64_t seen = data.frames_used + rejected;
  std::vector<NamedValue> frames{{"Used", plain(std::to_string(data.frames_used))}};
  const std::string share =
      seen > 0
          ? " (" + shown(100 * static_cast<double>(rejected) / static_cast<double>(seen), 2) + " % of those received)"
          : "";
  frames.push_back({"Rejected (not measured)", plain(std::to_string(rejected) + share)});
  for (const auto& [reason, count] : data.frames_rejected)
    frames.push_back({"… " + words(reason), plain(std::to_string(count))});
  frames.push_back({"Lost (gaps in the sequence)", plain(std::to_string(data.frames_lost))});
  frames.push_back({"Temporal noise per pixel", number_or_missing(data.temporal_noise_k, 3, "K", "not measured")});
  std::vector<NamedValue> settings;
  for (const auto& [feature, value] : data.camera->settings) settings.push_back({feature, plain(value)});
  if (settings.empty()) settings.push_back({"Settings", missing(not_reported)});
  Section section{"Frames and camera settings",
                  {TablePairs{{ValueTable{"Frames", std::move(frames)},
                               ValueTable{"Camera settings, read back", std::move(settings)}}}}};
  if (!data.camera->warnings.empty()) section.blocks.emplace_back(list_of(data.camera->warnings));
  return section;
}

Section provenance_section(const ReportData& data) {
  std::vector<NamedValue> values = text_values(data.provenance);
  if (values.empty()) values.push_back({"Versions and seeds", missing("not recorded")});
  values.push_back(
      {"SHA-256 of the session's manifest", text_or_missing(data.manifest_sha256, "no manifest confirms the files")});
  return {"Versions and seeds", {ValueTable{"", std::move(values)}}};
}

Section notes_section(const ReportData& data) {
  if (data.notes.empty()) return {"Notes of the run", {Paragraph{missing("none")}}};
  return {"Notes of the run", {list_of(data.notes)}};
}

Section statements_section(const ReportData& data) {
  List list;
  const auto item = [&](std::string_view text) { list.items.push_back(plain(text)); };
  item("The results relate only to the item tested, in the state and with the settings listed here.");
  const auto graded = [](const std::optional<TodCurve>& curve) {
    return curve && std::ranges::any_of(curve->points, [](const TodPoint& p) { return is_quasi(p.fit.interval); });
  };
  item(std::string("Intervals have a coverage of 95 %. ") +
       (graded(data.measured) || graded(data.simulated)
            ? "Intervals of graded answers are symmetric in the logarithm of the size. They are Student's t times a "
              "standard error from the scatter of the answers over presentations and set-ups."
            : "They are profile-likelihood intervals (likelihood drop 3.84) of the fitted function. They are widened "
              "with Student's t by the variance between groups of trials that share a frame or a place on the plate."));
  if (data.uncertainty)
    item(
        "The expanded intervals also contain the rows of the budget under Uncertainty. Limits are judged by the "
        "expanded intervals.");
  item(std::string(data.uncertainty ? "The statistical intervals contain" : "The intervals contain") +
       " the variation between trials: noise, sampling phase and the finite number of answers. They do not contain "
       "errors that are equal in all trials: triangle sizes, distance (an error of 1 % changes the acuity by 1 %), "
       "calibration of the contrast, and the difference between the model observer and people.");
  item(
      "Size S is the square root of the area of a triangle, in mrad. The task has four alternatives. Chance is 25 %, "
      "and the threshold is 75 % correct.");
  if (data.measured)
    item(
        "The effective contrast is the contrast that the camera observed at the large triangles, in its own "
        "temperature scale. The set contrast is the contrast that the black body was told.");
  return {"Statements", {std::move(list)}};
}

Section signature_section(const ReportData& data) {
  return {"Signatures", {Signatures{{{"Tested by", data.operator_name}, {"Witnessed by", ""}, {"Approved by", ""}}}}};
}

}  // namespace todbench
