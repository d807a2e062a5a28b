// SPDX-License-Identifier: GPL-3.0-or-later
// Settings read back from a camera: comparison with the written settings, and with the settings at the start of the
// run.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/frame_source.h"

namespace todbench {

/// Returns whether a feature, judged by its name, affects the meaning of a count: gain, range, case, temperature scale,
/// radiometric constants, object parameters, exposure.
[[nodiscard]] bool scales_counts(std::string_view feature);

/// Returns whether two values are the same: equal text ignoring case, the same switch (1, true, on), or numbers that
/// differ by at most 0.1 %, because devices round.
[[nodiscard]] bool same_setting(std::string_view written, std::string_view read);

/// Reads back the written features. Returns a sentence for each feature with a different value. Features that cannot be
/// read (commands) are left out. Errors: `calibration` (a feature that scales counts has a different value),
/// `disconnected`.
[[nodiscard]] Result<std::vector<std::string>> check_written_settings(
    FrameSource& camera, const std::map<std::string, std::string>& written);

/// A setting that changed during the run.
struct ChangedSetting {
  std::string feature, before, now;
};

/// Reads the settings of `at_start` again and returns the changed settings. Ignores temperatures of the camera,
/// connection parameters and correction modes. Returns an empty list if the camera no longer answers.
[[nodiscard]] std::vector<ChangedSetting> changed_settings(FrameSource& camera, const SourceInfo& at_start);
/// Returns "SensorGainMode was HighGain at the start and is LowGain at the end".
[[nodiscard]] std::string sentence(const ChangedSetting& changed);

}  // namespace todbench
