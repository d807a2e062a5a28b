// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/provenance.h"

#include <unistd.h>

#include <array>

#include "bench/session/build_info.h"
#include "bench/session/fit_record.h"
#include "bench/session/session_clock.h"
#include "bench/text/json_reader.h"

namespace todbench {

namespace {

constexpr std::array states{SessionState::running, SessionState::complete, SessionState::interrupted};
constexpr std::array sides{Side::measured, Side::simulated};

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : "unknown";
}

template <typename Value>
Json object_of(const std::map<std::string, Value>& values) {
  Json json = Json::object();
  for (const auto& [key, value] : values) json[key] = value;
  return json;
}

std::map<std::string, std::uint64_t> read_counts(const JsonReader& reader) {
  std::map<std::string, std::uint64_t> counts;
  for (const auto& [key, value] : reader.items()) counts[key] = value.count();
  return counts;
}

Json camera_json(const CameraRecord& camera) {
  Json json;
  json["id"] = camera.id;
  json["vendor"] = camera.vendor;
  json["model"] = camera.model;
  json["serial"] = camera.serial;
  json["firmware"] = camera.firmware;
  json["transport"] = camera.transport;
  json["pixel_format"] = camera.pixel_format;
  json["width"] = camera.width;
  json["height"] = camera.height;
  json["significant_bits"] = camera.significant_bits;
  json["frame_rate_hz"] = json_number(camera.frame_rate_hz);
  json["calibration"] = camera.calibration;
  json["settings"] = object_of(camera.settings);
  json["warnings"] = camera.warnings;
  return json;
}

CameraRecord read_camera(const JsonReader& reader) {
  CameraRecord camera;
  camera.id = reader.at("id").text();
  camera.vendor = reader.at("vendor").text();
  camera.model = reader.at("model").text();
  camera.serial = reader.at("serial").text();
  camera.firmware = reader.at("firmware").text();
  camera.transport = reader.at("transport").text();
  camera.pixel_format = reader.at("pixel_format").text();
  camera.width = static_cast<int>(reader.at("width").whole());
  camera.height = static_cast<int>(reader.at("height").whole());
  camera.significant_bits = static_cast<int>(reader.at("significant_bits").whole());
  camera.frame_rate_hz = reader.at("frame_rate_hz").optional_number().value_or(0);
  camera.calibration = reader.at("calibration").text();
  for (const auto& [key, value] : reader.at("settings").items()) camera.settings[key] = value.text();
  camera.warnings = reader.at("warnings").texts();
  return camera;
}

Json set_up_json(const SetUpRecord& set_up) {
  const Registration& registration = set_up.registration;
  Json json;
  json["plate"] = set_up.plate;
  json["mounting"] = to_string(set_up.mounting);
  json["plate_to_pixel"] = Json::array();
  for (const double value : registration.plate_to_pixel.val) json["plate_to_pixel"].push_back(json_number(value));
  json["residual_px"] = json_number(registration.residual_px);
  json["triangles_used"] = registration.triangles_used;
  json["scale_px_per_mm"] = json_number(registration.scale_px_per_mm);
  json["rotation_deg"] = json_number(registration.rotation_deg);
  json["scale_deviation"] = json_number(registration.scale_deviation);
  json["contrast_sign"] = json_number(registration.contrast_sign);
  return json;
}

SetUpRecord read_set_up(const JsonReader& reader) {
  SetUpRecord set_up;
  Registration& registration = set_up.registration;
  set_up.plate = reader.at("plate").text();
  set_up.mounting = reader.at("mounting").named(all_mountings);
  const std::vector<JsonReader> matrix = reader.at("plate_to_pixel").elements();
  for (std::size_t i = 0; i < 9; ++i) registration.plate_to_pixel.val[i] = i < matrix.size() ? matrix[i].number() : 0;
  registration.residual_px = reader.at("residual_px").number();
  registration.triangles_used = static_cast<int>(reader.at("triangles_used").whole());
  registration.scale_px_per_mm = reader.at("scale_px_per_mm").number();
  registration.rotation_deg = reader.at("rotation_deg").number();
  registration.scale_deviation = reader.at("scale_deviation").number();
  registration.contrast_sign = reader.at("contrast_sign").number();
  return set_up;
}

Json run_json(const RunRecord& run) {
  Json json;
  json["wall_s"] = json_number(run.wall_s);
  json["frames_used"] = run.frames_used;
  json["frames_rejected"] = object_of(run.frames_rejected);
  json["frames_lost"] = run.frames_lost;
  json["temporal_noise_k"] = json_number(run.temporal_noise_k);
  json["set_ups"] = Json::array();
  for (const SetUpRecord& set_up : run.set_ups) json["set_ups"].push_back(set_up_json(set_up));
  json["notes"] = run.notes;
  json["interrupted"] = !run.interruptions.empty();
  json["interruptions"] = Json::array();
  for (const Interruption& interruption : run.interruptions) {
    json["interruptions"].push_back({{"segment", json["interruptions"].size() + 2},
                                     {"first_presentation", interruption.presentation},
                                     {"away_s", json_number(interruption.away_s)},
                                     {"moved_px", json_number(interruption.moved_px)},
                                     {"reason", interruption.reason}});
  }
  json["ended_by"] = run.ended_by;
  return json;
}

RunRecord read_run(const JsonReader& reader) {
  RunRecord run;
  run.wall_s = reader.at("wall_s").number();
  run.frames_used = reader.at("frames_used").count();
  run.frames_rejected = read_counts(reader.at("frames_rejected"));
  run.frames_lost = reader.at("frames_lost").count();
  run.temporal_noise_k = reader.at("temporal_noise_k").optional_number().value_or(0);
  for (const JsonReader& set_up : reader.at("set_ups").elements()) run.set_ups.push_back(read_set_up(set_up));
  run.notes = reader.at("notes").texts();
  for (const auto& [key, value] : reader.items()) {
    if (key != "interruptions") continue;  // absent in folders of earlier versions
    for (const JsonReader& interruption : value.elements()) {
      run.interruptions.push_back({.presentation = interruption.at("first_presentation").whole(),
                                   .away_s = interruption.at("away_s").number(),
                                   .moved_px = interruption.at("moved_px").number(),
                                   .reason = interruption.at("reason").text()});
    }
  }
  run.ended_by = reader.at("ended_by").text();
  return run;
}

Json instruments_json(const std::vector<InstrumentPlan>& instruments) {
  Json list = Json::array();
  for (const InstrumentPlan& instrument : instruments) {
    Json json;
    json["name"] = instrument.name;
    json["serial"] = instrument.serial;
    json["certificate"] = instrument.certificate;
    json["calibration_due"] = instrument.calibration_due;
    list.push_back(std::move(json));
  }
  return list;
}

std::map<std::string, std::string> file_hashes(const JsonReader& reader) {
  std::map<std::string, std::string> hashes;
  for (const auto& [file, hash] : reader.items()) hashes[file] = hash.text();
  return hashes;
}

Json modules_json(const std::vector<ModuleRecord>& modules) {
  Json list = Json::array();
  for (const ModuleRecord& module : modules) {
    list.push_back({{"place", module.place},
                    {"command", module.command},
                    {"version", module.version},
                    {"files", object_of(module.files)}});
  }
  return list;
}

/// Names and members of the record, in the order of the file.
template <typename Record>
auto optics_numbers(Record& r) {
  using Number = std::pair<const char*, decltype(&r.chi2)>;
  return std::array{Number{"aberration_sigma_pitch", &r.aberration_sigma_pitch},
                    Number{"aberration_se_pitch", &r.aberration_se_pitch},
                    Number{"f_number_ratio", &r.f_number_ratio},
                    Number{"f_number_ratio_se", &r.f_number_ratio_se},
                    Number{"chi2", &r.chi2},
                    Number{"chi2_limit", &r.chi2_limit},
                    Number{"degrees_of_freedom", &r.degrees_of_freedom},
                    Number{"netd_k", &r.netd_k},
                    Number{"row_noise_k", &r.row_noise_k},
                    Number{"column_noise_k", &r.column_noise_k},
                    Number{"fixed_pattern_k", &r.fixed_pattern_k},
                    Number{"noise_correlation", &r.noise_correlation}};
}

Json optics_json(const CameraOpticsRecord& optics) {
  Json json;
  for (const auto& [name, value] : optics_numbers(optics)) json[name] = json_number(*value);
  json["samples_per_pitch"] = optics.samples_per_pitch;
  json["refused"] = optics.refused;
  json["surrogate_taken"] = optics.surrogate_taken;
  json["contrast_response"] = object_of(optics.contrast_response);
  return json;
}

CameraOpticsRecord read_optics(const JsonReader& reader) {
  CameraOpticsRecord optics;
  for (const auto& [name, value] : optics_numbers(optics)) *value = reader.at(name).optional_number().value_or(0);
  optics.samples_per_pitch = static_cast<int>(reader.at("samples_per_pitch").whole());
  optics.refused = reader.at("refused").flag();
  optics.surrogate_taken = reader.at("surrogate_taken").flag();
  for (const auto& [plate, response] : reader.at("contrast_response").items())
    optics.contrast_response[plate] = response.number();
  return optics;
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
          result.ended_by ? result.ended_by->message : std::string()};
}

RunFigures figures_of(const RunRecord& run) {
  return {run.wall_s, run.frames_used, run.frames_rejected};
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

Json provenance_json(const Provenance& provenance) {
  Json json;
  json["schema"] = "todbench-provenance-1";
  json["state"] = to_string(provenance.state);
  json["interrupted"] = was_interrupted(provenance);
  json["segments"] = segments(provenance);
  json["side"] = to_string(provenance.side);
  json["program_version"] = provenance.program_version;
  json["git_commit"] = provenance.git_commit;
  json["compiler"] = provenance.compiler;
  json["host"] = provenance.host;
  json["started_utc"] = provenance.started_utc;
  json["ended_utc"] = provenance.ended_utc;
  json["clock_jump_s"] = json_number(provenance.clock_jump_s);
  json["seeds"] = object_of(provenance.seeds);
  json["camera"] = provenance.camera ? camera_json(*provenance.camera) : Json(nullptr);
  json["target"] = provenance.target;
  json["instruments"] = instruments_json(provenance.instruments);
  json["modules"] = modules_json(provenance.modules);
  json["effects"] = effects_json(provenance.effects);
  json["run"] = provenance.run ? run_json(*provenance.run) : Json(nullptr);
  json["twin_run"] = provenance.twin_run ? run_json(*provenance.twin_run) : Json(nullptr);
  if (provenance.camera_optics) json["camera_optics"] = optics_json(*provenance.camera_optics);
  return json;
}

Result<Provenance> provenance_from(const Json& json) {
  const JsonReader reader(json);
  Provenance provenance;
  provenance.state = reader.at("state").named(states);
  provenance.side = reader.at("side").named(sides);
  provenance.program_version = reader.at("program_version").text();
  provenance.git_commit = reader.at("git_commit").text();
  provenance.compiler = reader.at("compiler").text();
  provenance.host = reader.at("host").text();
  provenance.started_utc = reader.at("started_utc").text();
  provenance.ended_utc = reader.at("ended_utc").text();
  provenance.seeds = read_counts(reader.at("seeds"));
  if (const JsonReader camera = reader.at("camera"); !camera.is_null()) provenance.camera = read_camera(camera);
  provenance.target = reader.at("target").text();
  for (const JsonReader& item : reader.at("instruments").elements()) {
    provenance.instruments.push_back({item.at("name").text(), item.at("serial").text(), item.at("certificate").text(),
                                      item.at("calibration_due").text()});
  }
  if (const JsonReader run = reader.at("run"); !run.is_null()) provenance.run = read_run(run);
  if (const JsonReader run = reader.at("twin_run"); !run.is_null()) provenance.twin_run = read_run(run);
  // Absent in folders of earlier versions.
  if (json.is_object() && json.contains("modules")) {
    for (const JsonReader& item : reader.at("modules").elements()) {
      provenance.modules.push_back({item.at("place").text(), item.at("command").text(), item.at("version").text(),
                                    file_hashes(item.at("files"))});
    }
  }
  if (json.is_object() && json.contains("clock_jump_s"))
    provenance.clock_jump_s = reader.at("clock_jump_s").optional_number().value_or(0);
  if (const JsonReader optics = reader.at_if_there("camera_optics"); !optics.is_null())
    provenance.camera_optics = read_optics(optics);
  if (const Result<void> read = reader.finish(); !read) return tl::unexpected(read.error());
  if (!json.contains("effects")) return fail(ErrorCode::invalid_input, "missing key 'effects'");
  const Result<SensorPlan> effects = effects_from(json["effects"]);
  if (!effects) return fail("effects", effects.error());
  provenance.effects = *effects;
  return provenance;
}

}  // namespace todbench
