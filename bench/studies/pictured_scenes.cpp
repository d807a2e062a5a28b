// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/pictured_scenes.h"

#include <chrono>
#include <opencv2/core.hpp>
#include <string>

#include "acquisition/base/try.h"
#include "acquisition/core/input_gate.h"
#include "acquisition/recording/picture_file.h"
#include "acquisition/recording/recording_backend.h"

namespace todbench {
namespace {

Result<StoredPicture> stored_picture(const std::string& path) {
  TODBENCH_TRY(auto file, read_picture(path));
  return StoredPicture{file.picture, file.counts ? StoredPicture::Kind::counts : StoredPicture::Kind::numbers};
}

Result<cv::Mat1d> mean_kelvin(const std::string& file, int frames) {
  const std::size_t mark = file.find('?');
  TODBENCH_TRY(auto recording,
               open_recording(file.substr(0, mark), mark == std::string::npos ? "" : file.substr(mark + 1)));
  if (!recording.info.scale.calibrated())
    return fail(ErrorCode::calibration,
                "the file has counts without temperatures; state their scale behind the name, for example "
                "?kelvin_per_count=0.01&offset_k=0");
  const auto source = recorded_source(std::move(recording));
  if (auto started = source->start(); !started) return tl::unexpected(started.error());
  InputGate gate;
  cv::Mat1d sum;
  int taken = 0;
  for (int k = 0; k < frames; ++k) {
    TODBENCH_TRY(const auto frame, source->next(std::chrono::seconds(1)));
    if (!gate.takes(frame)) continue;
    TODBENCH_TRY(const auto kelvin, to_kelvin(frame));
    sum = sum.empty() ? kelvin : cv::Mat1d(sum + kelvin);
    ++taken;
  }
  if (auto sound = gate.verdict(); !sound) return tl::unexpected(sound.error());
  return cv::Mat1d(sum / taken);
}

}  // namespace

Result<FieldScene> scene_with_pictures(std::string_view reference) {
  return load_scene(reference, stored_picture);
}

Result<TargetSet> target_set_with_pictures(std::string_view reference) {
  return load_target_set(reference, {mean_kelvin, stored_picture});
}

}  // namespace todbench
