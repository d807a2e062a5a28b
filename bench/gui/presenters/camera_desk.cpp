// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/camera_desk.h"

#include <utility>

#include "acquisition/base/try.h"
#include "bench/run/recorded_bench.h"

namespace todbench {
namespace {

std::vector<std::string> features_of(CameraControl control) {
  switch (control) {
    case CameraControl::frame_rate:
      return {"AcquisitionFrameRate", "AcquisitionFrameRateAbs", "IRFrameRate", "SensorVideoStandard"};
    case CameraControl::gain:
      return {"SensorGainMode", "GainMode", "Gain", "GainRaw"};
    case CameraControl::range:
      return {"CurrentCase", "MeasurementRange", "TemperatureRange", "Temperature Range", "IRFormat", "Range"};
    case CameraControl::exposure:
      return {"ExposureTime", "ExposureTimeAbs", "IntegrationTime", "Exposure Time, Absolute"};
  }
  return {};
}

}  // namespace

std::string_view to_string(CameraControl control) {
  switch (control) {
    case CameraControl::frame_rate:
      return "Frame rate";
    case CameraControl::gain:
      return "Gain";
    case CameraControl::range:
      return "Range";
    case CameraControl::exposure:
      return "Exposure";
  }
  return {};
}

std::vector<ControlReading> read_controls(FrameSource& camera) {
  std::vector<ControlReading> readings;
  for (const CameraControl control : all_camera_controls) {
    ControlReading reading{.control = control, .feature = {}, .value = {}};
    for (const std::string& feature : features_of(control)) {
      auto value = camera.get(feature);
      if (!value) continue;
      reading.feature = feature;
      reading.value = *std::move(value);
      break;
    }
    readings.push_back(std::move(reading));
  }
  return readings;
}

Result<std::string> change_feature(FrameSource& camera, const std::string& feature, const std::string& value) {
  auto set = camera.set(feature, value);
  if (!set && set.error().code != ErrorCode::disconnected) {
    camera.stop();
    set = camera.set(feature, value);
    TODBENCH_TRY_VOID(camera.start());
  }
  if (!set) return fail("setting " + feature + " = " + value, set.error());
  return camera.get(feature);
}

void CameraDesk::open() {
  const std::lock_guard lock(mutex_);
  requests_.clear();
}

void CameraDesk::ask(Request request) {
  const std::lock_guard lock(mutex_);
  requests_.push_back(std::move(request));
}

void CameraDesk::serve(FrameSource& camera) {
  std::vector<Request> requests;
  {
    const std::lock_guard lock(mutex_);
    requests.swap(requests_);
  }
  for (const Request& request : requests) request(camera);
}

Result<void> CameraDesk::record(const std::filesystem::path& file, const SourceInfo& info) {
  TODBENCH_TRY(auto stream, FrameStreamWriter::create(file, header_now(info)));
  const std::lock_guard lock(mutex_);
  stream_ = std::move(stream);
  return {};
}

bool CameraDesk::recording() const {
  const std::lock_guard lock(mutex_);
  return stream_.has_value();
}

Result<void> CameraDesk::append(const Frame& frame) {
  const std::lock_guard lock(mutex_);
  if (!stream_) return {};
  auto written = stream_->append(frame);
  if (!written) stream_.reset();
  return written;
}

Result<std::optional<std::uint64_t>> CameraDesk::end_recording() {
  std::optional<FrameStreamWriter> ended;
  {
    const std::lock_guard lock(mutex_);
    ended = std::exchange(stream_, std::nullopt);
  }
  if (!ended) return std::nullopt;
  TODBENCH_TRY(auto frames, ended->verified_frames());
  return frames;
}

}  // namespace todbench
