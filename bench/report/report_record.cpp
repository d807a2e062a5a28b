// How it was found: who, with what, in which geometry, with which frames and versions.
#include <algorithm>
#include <cmath>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

constexpr std::string_view not_reported = "not reported by the camera";
constexpr std::string_view not_in_plan = "not stated in the plan";

Markup number_or_missing(double value, int digits, const std::string& unit, std::string_view reason) {
  return std::isfinite(value) && value > 0 ? escaped(significant(value, digits) + " " + unit) : missing(reason);
}

std::vector<NamedValue> camera_values(const SourceInfo& camera, const std::string& temperature_scale) {
  const std::string size = std::to_string(camera.width) + " × " + std::to_string(camera.height) + " pixels";
  return {{"Manufacturer", text_or_missing(camera.vendor, not_reported)},
          {"Model", text_or_missing(camera.model, not_reported)},
          {"Serial number", text_or_missing(camera.serial, not_reported)},
          {"Firmware", text_or_missing(camera.firmware, not_reported)},
          {"Identity", text_or_missing(camera.id, not_reported)},
          {"Transport", text_or_missing(camera.transport, not_reported)},
          {"Frame", escaped(size + ", " + std::to_string(camera.significant_bits) + " bit") +
                        (camera.pixel_format.empty() ? Markup{} : escaped(", " + camera.pixel_format))},
          {"Frame rate", number_or_missing(camera.frame_rate_hz, 3, "Hz", not_reported)},
          {"Temperature scale",
           text_or_missing(temperature_scale.empty() ? camera.scale.describe() : temperature_scale, "uncalibrated")}};
}

Markup set_up_table(const ReportData& data) {
  MarkupTable rows;
  rows.caption = "Registration of the plate in the picture, once per set-up";
  rows.header = {"Plate",        "Mounting",          "Scale (px/mm)", "Scale against plan (%)",
                 "Rotation (°)", "Residual (px rms)", "Triangles used"};
  for (const SetUpRecord& record : data.set_ups) {
    const Registration& registration = record.registration;
    rows.rows.push_back(
        {escaped(record.plate), escaped(in_words(record.mounting)), escaped(shown(registration.scale_px_per_mm, 4)),
         escaped(shown(100 * registration.scale_deviation, 2)), escaped(shown(registration.rotation_deg, 2)),
         escaped(shown(registration.residual_px, 3)), escaped(std::to_string(registration.triangles_used))});
  }
  return rows.rows.empty() ? paragraph(literal("Registration: ") + missing("no plate was registered")) : table(rows);
}

Markup plate_table(const ReportData& data) {
  MarkupTable rows;
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
    rows.rows.push_back({escaped(plate.name), escaped(stated(plate.width_mm) + " × " + stated(plate.height_mm)),
                         escaped(std::to_string(plate.triangles.size())), escaped(span(least, most)),
                         distance_known ? escaped(span(least / data.distance_m, most / data.distance_m))
                                        : missing("distance not stated")});
  }
  return rows.rows.empty() ? Markup{} : table(rows);
}

std::vector<NamedValue> text_values(const std::vector<std::pair<std::string, std::string>>& pairs) {
  std::vector<NamedValue> values;
  values.reserve(pairs.size());
  for (const auto& [name, value] : pairs) values.push_back({name, text_or_missing(value, "not recorded")});
  return values;
}

Markup sensor_paragraph(const SensorSpec& spec) {
  std::string text = spec.name + ": " + std::to_string(spec.width) + " × " + std::to_string(spec.height) +
                     " detectors, pitch " + stated(spec.pitch_um) + " µm, sensitive side " + stated(spec.detector_um) +
                     " µm, focal length " + stated(spec.focal_length_mm) + " mm, f/" + stated(spec.f_number) + ", " +
                     stated(spec.wavelength_min_um) + " to " + stated(spec.wavelength_max_um) + " µm, NETD " +
                     stated(spec.netd_k) + " K, IFOV " + significant(spec.ifov_mrad(), 4) + " mrad.";
  return paragraph(escaped(text));
}

Markup signature(std::string_view role, std::string_view name) {
  const Markup who =
      element("div", escaped(role), "class=\"role\"") +
      element("div", name.empty() ? literal("Name:") : literal("Name: ") + escaped(name), "class=\"line\"") +
      element("div", literal("Date:"), "class=\"line\"") + element("div", literal("Signature:"), "class=\"line tall\"");
  return element("div", who);
}

}  // namespace

Markup identification_section(const ReportData& data) {
  Markup unit;
  if (data.camera) {
    unit = table_of_values("Unit under test, as read from the camera",
                           camera_values(*data.camera, data.temperature_scale));
  } else {
    unit = table_of_values("Unit under test", {{"Camera", missing("simulation only, no camera was measured")}});
  }
  std::vector<NamedValue> test{{"Session", text_or_missing(data.session, "not named")},
                               {"Description", text_or_missing(data.description, not_in_plan)},
                               {"Operator", text_or_missing(data.operator_name, not_in_plan)},
                               {"Place", text_or_missing(data.place, not_in_plan)},
                               {"Started", text_or_missing(data.started, "not recorded")},
                               {"Finished", text_or_missing(data.finished, "not recorded")}};
  for (NamedValue& value : text_values(data.conditions)) test.push_back(std::move(value));
  return section("Unit and test", element("div", unit + table_of_values("Test", test), "class=\"pairs\""));
}

Markup set_up_section(const ReportData& data) {
  const double field_mm = data.ifov_mrad * data.distance_m;
  const Markup geometry = table_of_values(
      "", {{"Distance, entrance pupil to plate", number_or_missing(data.distance_m, 4, "m", not_in_plan)},
           {"IFOV of a pixel", number_or_missing(data.ifov_mrad, 4, "mrad", not_in_plan)},
           {"One pixel on the plate", number_or_missing(field_mm, 4, "mm", "needs distance and IFOV")},
           {"Target", text_or_missing(data.target, "not recorded")},
           {"Observer", text_or_missing(data.observer, "not recorded")}});
  return section("Set-up and geometry",
                 geometry + plate_table(data) + (data.camera ? set_up_table(data) : Markup{}) + target_table(data));
}

Markup effects_section(const ReportData& data) {
  if (!data.simulated_sensor && data.plan.decisions.empty())
    return section("Effects simulated and skipped", paragraph(missing("nothing was simulated")));
  MarkupTable rows;
  rows.header = {"Effect, in the order of the chain", "Decision", "Reason", "Change of acuity if skipped (%)"};
  for (const EffectDecision& decision : data.plan.decisions) {
    rows.rows.push_back({escaped(in_words(decision.effect)),
                         literal(decision.decision == Decision::simulate ? "simulated" : "skipped"),
                         text_or_missing(decision.reason, "none given"),
                         decision.predicted_change_percent && std::isfinite(*decision.predicted_change_percent)
                             ? escaped(significant(*decision.predicted_change_percent, 2))
                             : missing("no criterion promises a value")});
  }
  const Markup sensor = data.simulated_sensor ? sensor_paragraph(*data.simulated_sensor) : Markup{};
  return section("Effects simulated and skipped", sensor + table(rows));
}

Markup frames_section(const ReportData& data) {
  if (!data.camera) return {};
  std::uint64_t rejected = 0;
  for (const auto& [reason, count] : data.frames_rejected) rejected += count;
  const std::uint64_t seen = data.frames_used + rejected;
  std::vector<NamedValue> frames{{"Used", escaped(std::to_string(data.frames_used))}};
  const std::string share =
      seen > 0
          ? " (" + shown(100 * static_cast<double>(rejected) / static_cast<double>(seen), 2) + " % of those received)"
          : "";
  frames.push_back({"Rejected and never measured", escaped(std::to_string(rejected) + share)});
  for (const auto& [reason, count] : data.frames_rejected)
    frames.push_back({"… " + words(reason), escaped(std::to_string(count))});
  frames.push_back({"Lost (gaps in the sequence)", escaped(std::to_string(data.frames_lost))});
  frames.push_back({"Temporal noise per pixel", number_or_missing(data.temporal_noise_k, 3, "K", "not measured")});
  std::vector<NamedValue> settings;
  for (const auto& [feature, value] : data.camera->settings) settings.push_back({feature, escaped(value)});
  if (settings.empty()) settings.push_back({"Settings", missing(not_reported)});
  Markup warnings;
  for (const std::string& warning : data.camera->warnings) warnings += element("li", escaped(warning)) + literal("\n");
  const Markup tables =
      element("div", table_of_values("Frames", frames) + table_of_values("Camera settings, read back", settings),
              "class=\"pairs\"");
  return section("Frames and camera settings", tables + (warnings.empty() ? Markup{} : element("ul", warnings)));
}

Markup provenance_section(const ReportData& data) {
  std::vector<NamedValue> values = text_values(data.provenance);
  if (values.empty()) values.push_back({"Versions and seeds", missing("not recorded")});
  Markup notes;
  for (const std::string& note : data.notes) notes += element("li", escaped(note)) + literal("\n");
  return section("Versions and seeds", table_of_values("", values)) +
         section("Notes of the run", notes.empty() ? paragraph(missing("none")) : element("ul", notes));
}

Markup statements_section(const ReportData& data) {
  Markup items;
  const auto item = [&](std::string_view text) { items += element("li", escaped(text)) + literal("\n"); };
  item("The results relate only to the item tested, in the state and with the settings listed here.");
  item(
      "Intervals have a coverage of 95 %. They are profile-likelihood intervals (likelihood drop 3.84) of the fitted "
      "function, widened by the variance between groups of trials that share a frame or a place on the plate, with "
      "Student's t.");
  item(
      "The intervals hold what varies between trials: noise, sampling phase and the finite number of answers. They do "
      "not hold what is "
      "the same in all trials: triangle sizes, distance (1 % of it is 1 % of acuity), the calibration of the contrast, "
      "and the difference "
      "between the model observer and people.");
  item(
      "Size S is the square root of the area of a triangle, in mrad. The task has four alternatives; chance is 25 %, "
      "the threshold is 75 % "
      "correct.");
  if (data.measured)
    item(
        "Effective contrast is what the camera itself saw on the large triangles, in its own temperature scale; set "
        "contrast is "
        "what the target was "
        "told.");
  return section("Statements", element("ul", items));
}

Markup signature_section(const ReportData& data) {
  const Markup lines =
      signature("Tested by", data.operator_name) + signature("Witnessed by", "") + signature("Approved by", "");
  return section("Signatures", element("div", lines, "class=\"signatures\""));
}

}  // namespace todbench
