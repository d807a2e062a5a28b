// What is known about families of thermal cameras: which of their features make counts proportional to temperature,
// keep corrections under command and leave the pixels alone. Data and pure functions; no camera library.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// An enumeration and the entries that suit a measurement, best first; the first one that a camera offers is set.
struct FeatureChoice {
  std::string feature;
  std::vector<std::string> entries;
};

/// One way in which a camera says that its counts are proportional to temperature.
struct LinearMode {
  std::string mode, mode_entry;  ///< enumeration and the entry that makes counts linear
  std::string step, step_entry;  ///< enumeration and entry that choose the step; may be the same feature
  double kelvin_per_count = 0;
};

struct CameraFamily {
  std::string name;                    ///< "FLIR Ax5"; "unlisted" for a camera that no line of the table knows
  std::vector<FeatureChoice> choices;  ///< set in this order when a camera is opened
  std::vector<LinearMode> linear;
  std::string nuc_mode;                    ///< enumeration; empty: none known
  std::vector<std::string> nuc_commanded;  ///< its entries under which only a command corrects, best first
  std::vector<std::string> nuc_commands;   ///< best first
  std::vector<std::string> frame_rate;     ///< features that tell the rate, best first
  std::string test_pattern, test_ramp;     ///< enumeration and its entry: pixel x of every row has the count x
  bool high_byte_first = false;            ///< sends Mono16 with the high byte first and has no feature that says so
};

/// The family of a camera by vendor and model, or by the features it has where a name is not known; "unlisted" when
/// neither tells. Sources: docs/cameras.md.
[[nodiscard]] CameraFamily camera_family(std::string_view vendor, std::string_view model,
                                         const std::function<bool(const std::string& feature)>& has_feature);

/// Commands that by their names correct the non-uniformity, best first: those of the plain words NUC and FFC before
/// those about a shutter or flag that calibrate or correct; shorter before longer ("NUCActionLong" is the slow variant
/// of "NUCAction"). Commands that load, store, reset, open, close or stop something are never among them.
[[nodiscard]] std::vector<std::string> correction_commands(const std::vector<std::string>& commands);

/// Features that by their names choose when corrections happen.
[[nodiscard]] std::vector<std::string> correction_modes(const std::vector<std::string>& enumerations);

/// The entry of such a feature under which nothing corrects unless commanded: "Manual" before "Off" before anything
/// that does not speak of automatic, external or periodic corrections; empty when there is none.
[[nodiscard]] std::string commanded_entry(const std::vector<std::string>& entries);

}  // namespace todbench
