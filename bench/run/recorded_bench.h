// A bench that is recorded while it measures, and one that comes out of such a recording.
#pragma once

#include <filesystem>

#include "bench/run/devices.h"

namespace todbench {

/// Where the recording of a session is.
[[nodiscard]] std::filesystem::path recorded_frames(const std::filesystem::path& session);

/// From now on everything that the measurement learns from the bench beside what the plan says is appended to the
/// recording of the session: every frame, every failure, every reading of the clock, what the target can do,
/// how often a frame was asked for while the target changed, and whether a lost camera came back. `io`.
[[nodiscard]] Result<void> record_bench(OpenedBench& bench, const std::filesystem::path& session);

/// The bench as the recording of a session knows it. A measurement that asks it in the same order gets the same
/// answers, bit for bit. Errors: `invalid_input` (no recording in the session, or not one of a measurement), `io`.
[[nodiscard]] Result<OpenedBench> open_recorded_bench(const std::filesystem::path& session);

}  // namespace todbench
