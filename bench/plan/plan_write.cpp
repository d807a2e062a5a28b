#include <string>

#include "bench/plan/plan.h"
#include "bench/text/text.h"

namespace todbench {

namespace {

/// A basic string of TOML.
std::string toml_string(std::string_view text) {
  static constexpr char hex[] = "0123456789ABCDEF";
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      result += "\\u00";
      result += hex[byte / 16];
      result += hex[byte % 16];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string toml(const std::string& text) {
  return toml_string(text);
}
std::string toml(std::string_view text) {
  return toml_string(text);
}
std::string toml(double value) {
  return number_text(value);
}
std::string toml(bool value) {
  return value ? "true" : "false";
}
std::string toml(int value) {
  return std::to_string(value);
}
std::string toml(std::uint64_t value) {
  return std::to_string(value);
}
std::string toml(Mounting mounting) {
  return toml_string(to_string(mounting));
}
std::string toml(Effect effect) {
  return toml_string(to_string(effect));
}

template <typename T>
std::string toml(const std::vector<T>& values) {
  std::string list = "[";
  for (const T& value : values) {
    if (list.size() > 1) list += ", ";
    list += toml(value);
  }
  return list + "]";
}

/// Lines "key = value" in order.
class Lines {
 public:
  void table(const std::string& header) { text_ += "\n" + header + "\n"; }
  template <typename T>
  void key(std::string_view name, const T& value) {
    text_ += std::string(name) + " = " + toml(value) + "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void write_camera(Lines& out, const CameraPlan& camera) {
  out.table("[camera]");
  out.key("id", camera.id);
  out.key("ifov_mrad", camera.ifov_mrad);
  out.key("nuc_interval_s", camera.nuc_interval_s);
  out.key("reconnect_s", camera.reconnect_s);
  out.key("nuc_wait_s", camera.nuc_wait_s);
  if (camera.settings.empty()) return;
  out.table("[camera.settings]");
  for (const auto& [feature, value] : camera.settings) out.key(toml_string(feature), value);
}

void write_target(Lines& out, const TargetPlan& target) {
  out.table("[target]");
  out.key("kind", to_string(target.kind));
  out.key("black_body", target.black_body);
  out.key("stage", target.stage);
  out.key("distance_m", target.distance_m);
  out.key("plates", target.plates);
  out.key("mountings", target.mountings);
  out.key("delta_t_k", target.delta_t_k);
  out.key("phases", target.phases);
  out.key("settle_timeout_s", target.settle_timeout_s);
  out.key("plate_change_s", target.plate_change_s);
  out.key("mounting_change_s", target.mounting_change_s);
  out.key("contrast_change_s", target.contrast_change_s);
  out.key("shift_change_s", target.shift_change_s);
}

void write_simulation(Lines& out, const SimulationPlan& simulation) {
  out.table("[simulation]");
  out.key("sensor", simulation.sensor);
  out.key("accuracy", simulation.accuracy);
  out.key("tolerance_percent", simulation.tolerance_percent);
  out.key("microscan", simulation.microscan);
  out.key("phases", simulation.phases);
  out.key("motion_mrad_s", std::vector<double>{simulation.motion.x_mrad_s, simulation.motion.y_mrad_s});
  out.key("skip", simulation.skip);
  out.key("force", simulation.force);
}

void write_measurement(Lines& out, const MeasurementPlan& plan) {
  out.table("[measurement]");
  out.key("registration_frames", plan.registration_frames);
  out.key("contrast_frames", plan.contrast_frames);
  out.key("min_reference_px", plan.min_reference_px);
  out.key("frames_after_change", plan.frames_after_change);
  out.key("max_rejected_share", plan.max_rejected_share);
  out.key("max_saturated_share", plan.max_saturated_share);
  out.key("frame_timeout_ms", plan.frame_timeout_ms);
  out.key("max_scale_deviation", plan.max_scale_deviation);
  out.key("max_rotation_deg", plan.max_rotation_deg);
  out.key("max_residual_px", plan.max_residual_px);
  out.key("max_readback_deviation_k", plan.max_readback_deviation_k);
  out.key("record_frames", plan.record_frames);
}

void write_limits(Lines& out, const LimitsPlan& limits) {
  out.table("[limits]");
  if (limits.equivalence_margin_percent) out.key("equivalence_margin_percent", *limits.equivalence_margin_percent);
  for (const AcuityLimit& limit : limits.acuity) {
    out.table("[[limits.acuity]]");
    out.key("delta_t_k", limit.delta_t_k);
    out.key("least_acuity_per_mrad", limit.least_acuity_per_mrad);
  }
}

void write_instrument(Lines& out, const InstrumentPlan& instrument) {
  out.table("[[instrument]]");
  out.key("name", instrument.name);
  out.key("serial", instrument.serial);
  out.key("certificate", instrument.certificate);
  out.key("calibration_due", instrument.calibration_due);
}

}  // namespace

std::string_view to_string(ScheduleKind kind) {
  return kind == ScheduleKind::constant ? "constant" : "adaptive";
}

std::string_view to_string(TargetKind kind) {
  switch (kind) {
    case TargetKind::scpi:
      return "scpi";
    case TargetKind::prompt:
      return "prompt";
    case TargetKind::scene:
      return "scene";
  }
  return "";
}

std::string to_toml(const Plan& plan) {
  Lines out;
  out.key("name", plan.name);
  out.key("description", plan.description);
  out.key("operator", plan.operator_name);
  out.key("place", plan.place);
  out.key("unit", plan.unit);
  out.key("notes", plan.notes);
  out.key("seed", plan.seed);
  write_camera(out, plan.camera);
  write_target(out, plan.target);
  out.table("[observer]");
  out.key("name", plan.observer);
  write_simulation(out, plan.simulation);
  out.table("[schedule]");
  out.key("kind", to_string(plan.schedule.kind));
  out.key("half_width_percent", plan.schedule.half_width_percent);
  out.key("max_presentations", plan.schedule.max_presentations);
  out.table("[fit]");
  out.key("form", to_string(plan.fit.form));
  if (plan.fit.lapse) {
    out.key("lapse", *plan.fit.lapse);
  } else {
    out.key("lapse", std::string_view("free"));
  }
  write_measurement(out, plan.measurement);
  write_limits(out, plan.limits);
  for (const InstrumentPlan& instrument : plan.instruments) write_instrument(out, instrument);
  return out.text();
}

}  // namespace todbench
