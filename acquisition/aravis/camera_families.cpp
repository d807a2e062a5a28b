// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/camera_families.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>

#include "acquisition/base/safe_text.h"

namespace todbench {
namespace {

bool contains_any(const std::string& text, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&](auto word) { return text.find(word) != std::string::npos; });
}

/// Whether the model is this word or continues it with a character that is no digit: "A35", "A35 9Hz", not "A350".
bool is_model(const std::string& model, std::string_view word) {
  if (!model.starts_with(word)) return false;
  return model.size() == word.size() || std::isdigit(static_cast<unsigned char>(model[word.size()])) == 0;
}

bool is_model(const std::string& model, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&](auto word) { return is_model(model, word); });
}

/// Features that are harmless to request from any camera; features that it lacks are skipped.
CameraFamily unlisted() {
  CameraFamily family;
  family.name = "unlisted";
  family.choices = {{"CMOSBitDepth", {"bit14bit"}},
                    {"DigitalOutput", {"bit14bit"}},
                    {"IRFormat", {"TemperatureLinear10mK", "TemperatureLinear100mK"}},
                    {"TemperatureLinearMode", {"On"}},
                    {"TemperatureLinearResolution", {"High"}},
                    {"NoiseReduction", {"Off"}},
                    {"SensorDDEMode", {"Off", "Manual"}},
                    {"ImageCompressionMode", {"Off"}},
                    {"GevSCPSBigEndian", {"false"}}};
  family.linear = {{"IRFormat", "TemperatureLinear10mK", "IRFormat", "TemperatureLinear10mK", 0.01},
                   {"IRFormat", "TemperatureLinear100mK", "IRFormat", "TemperatureLinear100mK", 0.1},
                   {"TemperatureLinearMode", "On", "TemperatureLinearResolution", "High", 0.04},
                   {"TemperatureLinearMode", "On", "TemperatureLinearResolution", "Low", 0.4}};
  family.nuc_mode = "NUCMode";
  family.nuc_commanded = {"Manual", "Off"};
  family.nuc_commands = {"NUCAction", "FFCAction", "FFC", "NUC", "DoFFC", "DoNUC"};
  family.frame_rate = {"AcquisitionFrameRate", "AcquisitionFrameRateAbs", "ResultingFrameRate", "SensorVideoStandard",
                       "IRFrameRate"};
  return family;
}

CameraFamily flir_ax5() {
  CameraFamily family = unlisted();
  family.name = "FLIR Ax5";
  family.choices = {{"IRTestPattern", {"Off"}},
                    {"CMOSBitDepth", {"bit14bit"}},
                    {"DigitalOutput", {"bit14bit"}},
                    {"TemperatureLinearMode", {"On"}},
                    {"TemperatureLinearResolution", {"High"}},
                    {"SensorGainMode", {"HighGainMode"}},
                    {"SensorDDEMode", {"Off", "Manual"}},
                    {"GevSCPSBigEndian", {"false"}}};
  family.linear = {{"TemperatureLinearMode", "On", "TemperatureLinearResolution", "High", 0.04},
                   {"TemperatureLinearMode", "On", "TemperatureLinearResolution", "Low", 0.4}};
  family.nuc_commanded = {"Manual"};
  family.nuc_commands = {"NUCAction"};
  family.frame_rate = {"SensorVideoStandard"};
  family.test_pattern = "IRTestPattern";
  family.test_ramp = "Ascending_Ramp";
  return family;
}

CameraFamily flir_ir_format(const char* name) {
  CameraFamily family = unlisted();
  family.name = name;
  family.choices = {{"IRFormat", {"TemperatureLinear10mK", "TemperatureLinear100mK"}},
                    {"NoiseReduction", {"Off"}},
                    {"ImageCompressionMode", {"Off"}},
                    {"GevSCPSBigEndian", {"false"}}};
  family.linear = {{"IRFormat", "TemperatureLinear10mK", "IRFormat", "TemperatureLinear10mK", 0.01},
                   {"IRFormat", "TemperatureLinear100mK", "IRFormat", "TemperatureLinear100mK", 0.1}};
  family.nuc_commanded = {"Manual", "Off"};
  family.nuc_commands = {"NUCAction"};
  family.frame_rate = {"AcquisitionFrameRate", "IRFrameRate"};
  return family;
}

bool never_a_correction(const std::string& name) {
  return contains_any(name, {"load", "save", "store", "factory", "reset", "open", "close", "abort", "stop", "delete",
                             "cancel", "lens"});
}

/// 0: no correction; otherwise smaller is better.
int correction_rank(const std::string& command) {
  const std::string name = lower_case(command);
  if (never_a_correction(name)) return 0;
  if (contains_any(name, {"nuc", "ffc"})) return 1;
  const bool shutter = contains_any(name, {"shutter", "flag"});
  const bool corrects = contains_any(name, {"calib", "corr"});
  if (shutter && corrects) return 2;
  if (contains_any(name, {"offset"}) && corrects) return 3;
  return 0;
}

}  // namespace

CameraFamily camera_family(std::string_view vendor, std::string_view model,
                           const std::function<bool(const std::string& feature)>& has_feature) {
  const bool flir = lower_case(vendor).find("flir") != std::string::npos;
  std::string name = lower_case(model);
  if (const auto prefix = name.find("flir "); prefix == 0) name.erase(0, 5);
  if (flir && is_model(name, {"ax5", "a5", "a15", "a35", "a65"})) return flir_ax5();
  if (flir && (name.starts_with("a305sc") || name.starts_with("a320g"))) {
    CameraFamily family = flir_ir_format("FLIR science, high byte first");
    family.high_byte_first = true;
    return family;
  }
  if (flir && (name.starts_with("a3") || name.starts_with("a6") || name.starts_with("sc"))) {
    return flir_ir_format("FLIR A3xx/A6xx");
  }
  if (flir && is_model(name, {"a50", "a70", "a400", "a500", "a700"})) return flir_ir_format("FLIR A50 ... A700");
  if (has_feature("TemperatureLinearMode") && has_feature("CMOSBitDepth")) return flir_ax5();
  if (has_feature("IRFormat")) return flir_ir_format("with IRFormat");
  return unlisted();
}

std::vector<std::string> correction_commands(const std::vector<std::string>& commands) {
  std::vector<std::string> found;
  std::copy_if(commands.begin(), commands.end(), std::back_inserter(found),
               [](const std::string& name) { return correction_rank(name) > 0; });
  std::stable_sort(found.begin(), found.end(), [](const std::string& a, const std::string& b) {
    const int rank_a = correction_rank(a), rank_b = correction_rank(b);
    return rank_a != rank_b ? rank_a < rank_b : a.size() < b.size();
  });
  return found;
}

std::vector<std::string> correction_modes(const std::vector<std::string>& enumerations) {
  std::vector<std::string> found;
  for (const auto& name : enumerations) {
    const std::string text = lower_case(name);
    if (contains_any(text, {"nuc", "ffc", "flag", "shutter"}) && contains_any(text, {"mode", "auto"})) {
      found.push_back(name);
    }
  }
  return found;
}

std::string commanded_entry(const std::vector<std::string>& entries) {
  for (const char* best : {"manual", "off"}) {
    for (const auto& entry : entries) {
      if (lower_case(entry) == best) return entry;
    }
  }
  for (const auto& entry : entries) {
    if (!contains_any(lower_case(entry), {"auto", "extern", "period", "on", "time", "temp"})) return entry;
  }
  return {};
}

}  // namespace todbench
