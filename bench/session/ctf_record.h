// SPDX-License-Identifier: GPL-3.0-or-later
// CTF in measures.json.
#pragma once

#include <optional>

#include "bench/session/measures_record.h"
#include "bench/text/json.h"
#include "bench/text/json_reader.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Adds "ctf_x" (best phase), "ctf_mean_x" and "ctf_worst_x" of the bar group nearest to the frequency of the plan, and
/// the same for y.
void add_ctf_lines(MeasureLines& out, const CtfMeasure& ctf);

[[nodiscard]] Json ctf_json(const CtfMeasure& ctf);
[[nodiscard]] CtfGroups ctf_from(const JsonReader& ctf);
/// Returns whether a figure can be drawn: there are frequencies above 0.
[[nodiscard]] bool ctf_drawable(const std::optional<MeasureLines>& side);

}  // namespace todbench
