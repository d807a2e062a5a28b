// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/report_data.h"

#include <system_error>

#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"
#include "bench/session/session_clock.h"

namespace todbench {
namespace {

SourceInfo source_info(const CameraRecord& record) {
  SourceInfo info;
  info.id = record.id;
  info.vendor = record.vendor;
  info.model = record.model;
  info.serial = record.serial;
  info.firmware = record.firmware;
  info.transport = record.transport;
  info.pixel_format = record.pixel_format;
  info.width = record.width;
  info.height = record.height;
  info.significant_bits = record.significant_bits;
  info.frame_rate_hz = record.frame_rate_hz;
  info.settings = record.settings;
  info.warnings = record.warnings;
  return info;
}

void add_provenance(ReportData& data, const Provenance& provenance) {
  data.provenance = {{"Program", "todbench " + provenance.program_version},
                     {"Source commit", provenance.git_commit},
                     {"Compiler", provenance.compiler},
                     {"Host", provenance.host}};
  data.provenance.emplace_back("Self-test", provenance.selftest ? in_words(*provenance.selftest)
                                                                : "not recorded for this program on this computer");
  for (const auto& [name, seed] : provenance.seeds)
    data.provenance.emplace_back("Seed of the " + name, std::to_string(seed));
  if (provenance.origin) {
    const OriginRecord& origin = *provenance.origin;
    const auto words = [](const JudgedBy& judged) {
      return judged.observer + (judged.package.empty() ? ", no package" : ", package " + judged.package);
    };
    const std::string from = session_name(origin.session);
    data.conditions.emplace_back(origin.resumed ? "Resumed" : "Recorded frames",
                                 origin.resumed ? "the first part is session " + from
                                                : "of session " + from + ", judged again by " + words(origin.now));
    data.provenance.emplace_back("Origin of the frames",
                                 from + ", manifest SHA-256 " +
                                     (origin.manifest_sha256.empty() ? "none" : origin.manifest_sha256) +
                                     (origin.signed_by.empty() ? "" : ", signed by key SHA-256 " + origin.signed_by));
    if (!origin.resumed) {
      data.provenance.emplace_back("Judged then", words(origin.then));
      data.provenance.emplace_back("Judged now", words(origin.now));
    }
    if (!origin.now.package_sha256.empty()) data.provenance.emplace_back("Package SHA-256", origin.now.package_sha256);
  }
  for (const auto& module : provenance.modules) {
    std::string text = module.command;
    if (!module.version.empty()) text += "; " + module.version;
    for (const auto& [file, hash] : module.files) text += "; " + file + " SHA-256 " + hash;
    data.provenance.emplace_back("Module (" + module.place + ")", std::move(text));
  }
  for (const auto& instrument : provenance.instruments) {
    std::string stated;
    for (const auto& [words, value] : {std::pair{"serial ", &instrument.serial},
                                       {"certificate ", &instrument.certificate},
                                       {"due ", &instrument.calibration_due}}) {
      if (!value->empty()) stated += (stated.empty() ? "" : ", ") + std::string(words) + *value;
    }
    data.conditions.emplace_back(instrument.name, stated.empty() ? "no serial number or certificate stated" : stated);
  }
}

}  // namespace

std::string session_name(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::path path = std::filesystem::weakly_canonical(folder, problem);
  if (problem) path = folder.lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

Result<ReportData> report_data(const Session& session, const std::string& name) {
  const Plan& plan = session.plan;
  const Provenance& provenance = session.provenance;
  ReportData data;
  data.session = name;
  data.description = plan.name + (plan.description.empty() ? "" : ": " + plan.description);
  data.started = provenance.started_utc;
  data.finished = provenance.ended_utc;
  data.operator_name = plan.operator_name;
  data.place = plan.place;
  if (!plan.unit.empty()) data.conditions.emplace_back("Unit under test", plan.unit);
  if (!plan.notes.empty()) data.notes.push_back(plan.notes);
  if (provenance.camera) {
    data.camera = source_info(*provenance.camera);
    data.temperature_scale = provenance.camera->calibration;
  }
  data.distance_m = plan.target.distance_m;
  data.collimated = plan.target.collimator.stated();
  data.ifov_mrad = plan.camera.ifov_mrad;
  data.air_temperature_c = plan.target.air_temperature_c;
  if (has_display(plan)) data.display = plan.display;
  data.target = provenance.target;
  data.plates = session.parts.plates;
  data.presentations = session.presentations;
  data.observer = plan.observer;
  data.fit = fit_options(plan);
  if (provenance.side == Side::measured) {
    data.measured = session.curve;
    data.simulated = session.twin;
  } else {
    data.simulated = session.curve;
  }
  data.comparison = session.comparison;
  data.simulated_sensor = session.parts.sensor;
  data.simulated_sensor->microscan = plan.simulation.microscan;
  if (data.ifov_mrad == 0) data.ifov_mrad = session.parts.sensor.ifov_mrad();
  data.plan = provenance.effects;
  data.cost = session.cost;
  data.letterhead = session.parts.letterhead;
  if (has_order(plan)) data.order = plan.order;
  data.measures = session.measures;
  if (!session.curve && session.measures) data.title = "Measurement report";
  data.uncertainty = session.uncertainty;
  data.verdict = verdict_of(session);
  if (provenance.run) {
    data.set_ups = provenance.run->set_ups;
    data.wall_s = provenance.run->wall_s;
    data.measures_s = provenance.run->measures_s;
    data.frames_used = provenance.run->frames_used;
    data.frames_rejected = provenance.run->frames_rejected;
    data.frames_lost = provenance.run->frames_lost;
    data.temporal_noise_k = provenance.run->temporal_noise_k;
    data.notes.insert(data.notes.end(), provenance.run->notes.begin(), provenance.run->notes.end());
    data.interruptions = provenance.run->interruptions;
  }
  data.forecast = provenance.forecast;
  data.manifest_sha256 = session.manifest_sha256;
  data.accepted_changes = session.accepted_changes;
  data.cut_off = session.cut_off;
  data.interrupted = data.verdict->ended_early ? data.verdict->ended_early : ended_early(session);
  if (provenance.twin_run) {
    data.twin_s = provenance.twin_run->wall_s;
    for (const auto& note : provenance.twin_run->notes) data.notes.push_back("Simulated twin: " + note);
  }
  if (provenance.clock_jump_s != 0) data.notes.push_back(jump_sentence(provenance.clock_jump_s));
  add_provenance(data, provenance);
  data.at_display = provenance.at_display;
  return data;
}

}  // namespace todbench
