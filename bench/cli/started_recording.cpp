// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/started_recording.h"

#include "acquisition/core/camera_id.h"
#include "acquisition/recording/recording_backend.h"

namespace todbench {

Result<std::unique_ptr<FrameSource>> started_recording(Console& console, const std::string& id) {
  auto source =
      recording_backend()->open(has_scheme(id, camera_scheme::file) ? id : camera_id(camera_scheme::file, id));
  // A recording is an input file here, not a device.
  if (!source) return fail(ErrorCode::invalid_input, source.error().message);
  if (auto started = (*source)->start(); !started) return tl::unexpected(started.error());
  for (const auto& warning : (*source)->info().warnings) console.note(warning);
  return source;
}

}  // namespace todbench
