// SPDX-License-Identifier: GPL-3.0-or-later
// Families of thermal cameras: the features that make counts proportional to temperature, restrict corrections to
// commands, and leave the pixels unprocessed. Data and pure functions; no camera library.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// An enumeration and the entries that suit a measurement, best first. The first entry that the camera offers is set.
struct FeatureChoice {
  std::string feature;
  std::vector<std::string> entries;
};

/// Settings under which a camera's counts are proportional to temperature.
struct LinearMode {
  std::string mode, mode_entry;  ///< enumeration and the entry that makes counts linear
  std::string step, step_entry;  ///< enumeration and entry that select kelvin_per_count; `step` may equal `mode`
  double kelvin_per_count = 0;
};

/// Feature names and settings of a family of cameras.
struct CameraFamily {
  std::string name;                    ///< "FLIR Ax5"; "unlisted" for a camera that is not in the table
  std::vector<FeatureChoice> choices;  ///< set in this order when a camera is opened
  std::vector<LinearMode> linear;
  std::string nuc_mode;                    ///< enumeration that controls the time of corrections; empty: unknown
  std::vector<std::string> nuc_commanded;  ///< entries of nuc_mode that restrict corrections to commands, best first
  std::vector<std::string> nuc_commands;   ///< commands of a correction, best first
  std::vector<std::string> frame_rate;     ///< features that contain the frame rate, best first
  std::string test_pattern, test_ramp;     ///< enumeration and its entry; the ramp has the count x at column x
  bool high_byte_first = false;            ///< Mono16 arrives with the high byte first, but no feature reports this
};

/// Returns the family of a camera by vendor and model, or by its features if the name is unknown; "unlisted" if neither
/// identifies the camera. Sources: docs/reference/cameras.md.
[[nodiscard]] CameraFamily camera_family(std::string_view vendor, std::string_view model,
                                         const std::function<bool(const std::string& feature)>& has_feature);

/// Returns the commands that correct the non-uniformity according to their names, best first: names with NUC or FFC,
/// then commands that calibrate or correct a shutter or flag, then commands for an offset. Shorter names precede longer
/// names ("NUCActionLong" is the slow variant of "NUCAction"). Commands that load, store, reset, open, close or stop
/// something are excluded.
[[nodiscard]] std::vector<std::string> correction_commands(const std::vector<std::string>& commands);

/// Returns the features that select when the camera corrects itself. They are recognised by their names.
[[nodiscard]] std::vector<std::string> correction_modes(const std::vector<std::string>& enumerations);

/// Returns the entry of an enumeration of correction_modes() that restricts corrections to commands: "Manual" before
/// "Off" before any entry that does not name automatic, external or periodic corrections; empty if there is none.
[[nodiscard]] std::string commanded_entry(const std::vector<std::string>& entries);

}  // namespace todbench
