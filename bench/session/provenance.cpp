// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/provenance.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "bench/session/build_info.h"
#include "bench/session/fit_record.h"
#include "bench/session/session_clock.h"
#include "bench/text/json_fields.h"

namespace todbench {

namespace {

constexpr std::array states{SessionState::running, SessionState::complete, SessionState::interrupted};
constexpr std::array sides{Side::measured, Side::simulated};

void camera_fields(JsonFields& json, CameraRecord& camera) {
  json.value("id", camera.id);
  json.value("vendor", camera.vendor);
  json.value("model", camera.model);
  json.value("serial", camera.serial);
  json.value("firmware", camera.firmware);
  json.value("transport", camera.transport);
  json.value("pixel_format", camera.pixel_format);
  json.value("width", camera.width);
  json.value("height", camera.height);
  json.value("significant_bits", camera.significant_bits);
  json.number_or("frame_rate_hz", camera.frame_rate_hz, 0);
  json.value("calibration", camera.calibration);
  json.value("settings", camera.settings);
  json.value("warnings", camera.warnings);
}

void set_up_fields(JsonFields& json, SetUpRecord& set_up) {
  Registration& registration = set_up.registration;
  auto& matrix = registration.plate_to_pixel.val;
  std::vector<double> numbers(std::begin(matrix), std::end(matrix));
  json.value("plate", set_up.plate);
  json.value("mounting", set_up.mounting, all_mountings);
  json.value("plate_to_pixel", numbers);
  json.value("residual_px", registration.residual_px);
  json.value("triangles_used", registration.triangles_used);
  json.value("scale_px_per_mm", registration.scale_px_per_mm);
  json.value("rotation_deg", registration.rotation_deg);
  json.value("scale_deviation", registration.scale_deviation);
  json.value("contrast_sign", registration.contrast_sign);
  numbers.resize(std::size(matrix));
  std::copy(numbers.begin(), numbers.end(), std::begin(matrix));
}

void run_fields(JsonFields& json, RunRecord& run) {
  json.value("wall_s", run.wall_s);
  json.value("frames_used", run.frames_used);
  json.value("frames_rejected", run.frames_rejected);
  json.value("frames_lost", run.frames_lost);
  json.number_or("temporal_noise_k", run.temporal_noise_k, 0);
  json.value("set_ups", run.set_ups, set_up_fields);
  json.value("notes", run.notes);
  json.derived("interrupted", !run.interruptions.empty());
  int segment = 2;
  json.later("interruptions", run.interruptions, [&](JsonFields& item, Interruption& interruption) {
    item.derived("segment", segment++);
    item.value("first_presentation", interruption.presentation);
    item.value("away_s", interruption.away_s);
    item.value("moved_px", interruption.moved_px);
    item.value("reason", interruption.reason);
  });
  json.value("ended_by", run.ended_by);
  json.later("measures_s", run.measures_s);
}

void instrument_fields(JsonFields& json, InstrumentPlan& instrument) {
  json.value("name", instrument.name);
  json.value("serial", instrument.serial);
  json.value("certificate", instrument.certificate);
  json.value("calibration_due", instrument.calibration_due);
}

void module_fields(JsonFields& json, ModuleRecord& module) {
  json.value("place", module.place);
  json.value("command", module.command);
  json.value("version", module.version);
  json.value("files", module.files);
}

void optics_fields(JsonFields& json, CameraOpticsRecord& optics) {
  json.number_or("aberration_sigma_pitch", optics.aberration_sigma_pitch, 0);
  json.number_or("aberration_se_pitch", optics.aberration_se_pitch, 0);
  json.number_or("f_number_ratio", optics.f_number_ratio, 0);
  json.number_or("f_number_ratio_se", optics.f_number_ratio_se, 0);
  json.number_or("chi2", optics.chi2, 0);
  json.number_or("chi2_limit", optics.chi2_limit, 0);
  json.number_or("degrees_of_freedom", optics.degrees_of_freedom, 0);
  json.number_or("netd_k", optics.netd_k, 0);
  json.number_or("row_noise_k", optics.row_noise_k, 0);
  json.number_or("column_noise_k", optics.column_noise_k, 0);
  json.number_or("fixed_pattern_k", optics.fixed_pattern_k, 0);
  json.number_or("noise_correlation", optics.noise_correlation, 0);
  json.if_any("halo_share", optics.halo_share);
  json.if_any("halo_share_se", optics.halo_share_se);
  json.if_any("halo_sigma_px", optics.halo_sigma_px);
  json.value("samples_per_pitch", optics.samples_per_pitch);
  json.value("refused", optics.refused);
  json.value("surrogate_taken", optics.surrogate_taken);
  json.value("contrast_response", optics.contrast_response);
}

void judged_by_fields(JsonFields& json, JudgedBy& judged) {
  json.value("observer", judged.observer);
  json.value("observer_sha256", judged.observer_sha256);
  json.value("package", judged.package);
  json.value("package_sha256", judged.package_sha256);
}

void origin_fields(JsonFields& json, OriginRecord& origin) {
  json.value("session", origin.session);
  json.value("manifest_sha256", origin.manifest_sha256);
  json.value("signed_by", origin.signed_by);
  json.value("then", origin.then, judged_by_fields);
  json.value("now", origin.now, judged_by_fields);
  json.value("resumed", origin.resumed);
}

void forecast_fields(JsonFields& json, TimeForecast& forecast) {
  json.value("total_s", forecast.total_s);
  json.value("parts_s", forecast.parts_s);
}

void provenance_fields(JsonFields& json, Provenance& provenance) {
  json.derived("schema", "todbench-provenance-1");
  json.value("state", provenance.state, states);
  json.derived("interrupted", was_interrupted(provenance));
  json.derived("segments", segments(provenance));
  json.value("side", provenance.side, sides);
  json.value("program_version", provenance.program_version);
  json.value("git_commit", provenance.git_commit);
  json.value("compiler", provenance.compiler);
  json.value("host", provenance.host);
  json.value("started_utc", provenance.started_utc);
  json.value("ended_utc", provenance.ended_utc);
  json.later("clock_jump_s", provenance.clock_jump_s);
  json.value("seeds", provenance.seeds);
  json.value("camera", provenance.camera, camera_fields);
  json.value("target", provenance.target);
  json.value("instruments", provenance.instruments, instrument_fields);
  json.later("modules", provenance.modules, module_fields);
  effects_fields(json, provenance.effects);
  json.value("run", provenance.run, run_fields);
  json.if_any("forecast", provenance.forecast, forecast_fields);
  json.value("twin_run", provenance.twin_run, run_fields);
  json.if_any("camera_optics", provenance.camera_optics, optics_fields);
  json.if_any("selftest", provenance.selftest, selftest_fields);
  json.if_any("origin", provenance.origin, origin_fields);
  json.if_any("at_display", provenance.at_display, display_fields);
}

}  // namespace

std::string_view to_string(SessionState state) {
  switch (state) {
    case SessionState::running:
      return "running";
    case SessionState::complete:
      return "complete";
    case SessionState::interrupted:
      return "interrupted";
  }
  return "";
}

CameraRecord camera_record(const SourceInfo& info) {
  return {info.id,       info.vendor,           info.model,         info.serial,
          info.firmware, info.transport,        info.pixel_format,  info.width,
          info.height,   info.significant_bits, info.frame_rate_hz, info.scale.describe(),
          info.settings, info.warnings};
}

RunRecord run_record(const MeasurementResult& result, double wall_s) {
  return {wall_s,
          result.frames_used,
          result.frames_rejected,
          result.frames_lost,
          result.temporal_noise_k,
          result.set_ups,
          result.notes,
          result.interruptions,
          result.ended_by ? result.ended_by->message : std::string(),
          0};
}

RunFigures figures_of(const RunRecord& run) {
  return {run.wall_s, run.frames_used, run.frames_rejected, run.measures_s};
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : "unknown";
}

std::string utc_now() {
  return utc_text(host_clocks().wall());
}

Provenance begin_provenance(const Plan& plan, Side side) {
  Provenance provenance;
  const BuildInfo build = build_info();
  provenance.program_version = build.version;
  provenance.git_commit = build.commit;
  provenance.compiler = build.compiler;
  provenance.host = host_name();
  provenance.started_utc = utc_now();
  provenance.side = side;
  provenance.seeds["plan"] = plan.seed;
  provenance.instruments = plan.instruments;
  return provenance;
}

std::size_t segments(const Provenance& provenance) {
  return 1 + (provenance.run ? provenance.run->interruptions.size() : 0);
}

bool was_interrupted(const Provenance& provenance) {
  return provenance.state == SessionState::interrupted || segments(provenance) > 1;
}

Result<Json> provenance_json(const Provenance& provenance) {
  return json_of(provenance, provenance_fields);
}

Result<Provenance> provenance_from(const Json& json) {
  return from_json<Provenance>(json, provenance_fields);
}

}  // namespace todbench
