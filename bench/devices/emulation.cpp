// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/emulation.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/loaded_plan.h"
#include "bench/text/text.h"
#include "sim_devices/module/npy_message.h"
#ifdef TODBENCH_WITH_ARAVIS
#include "sim_devices/lab/gvsp_laboratory.h"
#endif
#ifdef TODBENCH_WITH_EMULATED_USB
#include "sim_devices/lab/usb_laboratory.h"
#endif
#ifdef TODBENCH_WITH_EMULATED_VIDEO
#include "sim_devices/lab/v4l2_laboratory.h"
#endif

namespace todbench {
namespace {

constexpr std::string_view gige = "gige";

#ifdef TODBENCH_WITH_ARAVIS
/// "gige-ax5", "gige-a-series", ...: a family of cameras with its own registers.
std::optional<CameraModel> gvsp_model(std::string_view camera) {
  constexpr std::string_view prefix = "gige-";
  return camera.starts_with(prefix) ? camera_model(camera.substr(prefix.size())) : std::nullopt;
}
#endif

#ifdef TODBENCH_WITH_ARAVIS
/// Levels in a file that another program replaces repeatedly, complete each time.
class LevelsInFile {
 public:
  explicit LevelsInFile(std::string file) : file_(std::move(file)) {}

  std::shared_ptr<const cv::Mat1f> operator()() {
    struct stat now {};
    if (::stat(file_.c_str(), &now) != 0) return levels_ = nullptr;
    // The inode distinguishes replaced files with the same time.
    const std::array<std::int64_t, 4> version{static_cast<std::int64_t>(now.st_ino), now.st_mtim.tv_sec,
                                              now.st_mtim.tv_nsec, now.st_size};
    if (version == version_) return levels_;
    constexpr std::size_t most_values = std::size_t{1} << 26;
    const auto content = read_text_file(file_);
    const auto place = content ? find_message(*content, most_values) : tl::unexpected(content.error());
    // An unreadable file leaves the levels as they are; the next change is read again.
    if (!place || !*place || (*place)->shape.size() != 2 || (*place)->count == 0) return levels_;
    version_ = version;
    return levels_ = std::make_shared<const cv::Mat1f>(picture_at(*content, **place));
  }

 private:
  std::string file_;
  std::array<std::int64_t, 4> version_{};
  std::shared_ptr<const cv::Mat1f> levels_;
};
#endif

#ifdef TODBENCH_WITH_EMULATED_VIDEO
std::optional<VideoCameraKind> video_kind(const std::string& camera) {
  if (camera == "v4l2") return VideoCameraKind::lepton;
  if (camera == "v4l2-yuyv") return VideoCameraKind::temperature_rows;
  return std::nullopt;
}
#endif

}  // namespace

std::vector<std::string> emulated_cameras() {
  std::vector<std::string> cameras{std::string(gige)};
#ifdef TODBENCH_WITH_ARAVIS
  cameras.insert(cameras.end(), {"gige-ax5", "gige-a-series", "gige-legacy-science", "gige-unlisted"});
#endif
#ifdef TODBENCH_WITH_EMULATED_USB
  cameras.insert(cameras.end(), {"u3v", "seek"});
#endif
#ifdef TODBENCH_WITH_EMULATED_VIDEO
  cameras.insert(cameras.end(), {"v4l2", "v4l2-yuyv"});
#endif
  return cameras;
}

void enter_emulation(const std::string& camera) {
#ifdef TODBENCH_WITH_EMULATED_VIDEO
  // All cameras except the GigE ones are behind device nodes.
  if (!camera.starts_with(gige)) MockSystem::enter();
#else
  (void)camera;
#endif
}

Result<Plan> demonstration_plan(DemonstrationLength length) {
  auto acceptance = load_plan("acceptance");
  if (length == DemonstrationLength::full || !acceptance) return acceptance;
  auto plan = load_plan("demo");
  if (!plan) return plan;
  plan->uncertainty = std::move(acceptance->uncertainty);
  plan->measures.noise = plan->measures.geometry = plan->measures.triangles = true;
  return plan;
}

EmulationArguments emulation_for(const Plan& plan) {
  EmulationArguments arguments;
  arguments.sensor = plan.simulation.sensor;
  arguments.plates = plan.target.plates;
  for (const MeasurePlate& measure : measure_plates) {
    const std::string& plate = plan.measures.*measure.reference;
    if (plan.measures.*measure.requested && std::ranges::find(arguments.plates, plate) == arguments.plates.end())
      arguments.plates.push_back(plate);
  }
  arguments.distance_m = plan.target.distance_m;
  if (const CollimatorPlan& collimator = plan.target.collimator; collimator.stated()) {
    arguments.collimator_transmission = collimator.transmission;
    arguments.collimator_mirror_c = collimator.mirror_temperature_c.value_or(plan.target.air_temperature_c);
    arguments.collimator_blur_mrad = collimator.blur_mrad;
  }
  arguments.black_body_port = 0;
  arguments.stage_port = 0;
  arguments.seed = plan.seed + 1;  // a separate camera: its noise is not the twin's
  return arguments;
}

#ifdef TODBENCH_WITH_ARAVIS
Result<LaboratoryOptions> laboratory_options(const EmulationArguments& arguments) {
  LaboratoryOptions options;
  auto sensor = load_sensor(arguments.sensor);
  if (!sensor) return tl::unexpected(sensor.error());
  options.sensor = *sensor;
  if (const auto model = gvsp_model(arguments.camera)) {
    options.sensor = with_counts_of(*model, *sensor);
    GvspCameraConfig camera;
    camera.interface_address = arguments.interface_address;
    camera.model = *model;
    camera.serial = arguments.serial;
    options.connect = connect_gvsp(camera);
  }
#ifdef TODBENCH_WITH_EMULATED_VIDEO
  if (const auto kind = video_kind(arguments.camera)) {
    options.sensor = with_counts_of(*kind, *sensor);
    VideoCameraConfig camera;
    camera.kind = *kind;
    camera.model = "Emulated " + sensor->name;
    camera.serial = arguments.serial;
    options.connect = connect_v4l2(MockSystem::create(), camera);
  }
#endif
#ifdef TODBENCH_WITH_EMULATED_USB
  if (arguments.camera == "u3v") {
    U3vCameraConfig camera;
    camera.model = "Emulated " + sensor->name;
    camera.serial = arguments.serial;
    options.connect = connect_u3v(MockSystem::create(), camera);
  } else if (arguments.camera == "seek") {
    SeekCameraConfig camera;
    camera.serial = arguments.serial;
    options.connect = connect_seek(MockSystem::create(), camera);
  }
#endif
  if (!arguments.monitor_file.empty()) {
    options.monitor = Monitor{.pixel_mm = arguments.monitor_pixel_mm,
                              .span_k = arguments.monitor_span_k,
                              .gamma = arguments.monitor_gamma,
                              .levels = LevelsInFile(arguments.monitor_file)};
  }
  if (arguments.collimator_blur_mrad > 0)
    options.sensor.aberration_sigma_pitch =
        std::hypot(options.sensor.aberration_sigma_pitch, arguments.collimator_blur_mrad / options.sensor.ifov_mrad());
  options.mirror_transmission = arguments.collimator_transmission;
  options.mirror_temperature_k = arguments.collimator_mirror_c + 273.15;
  options.latency_s = 1e-3 * arguments.latency_ms;
  options.black_body.celsius = arguments.celsius;
  options.plan = full_plan(options.sensor, {}, {}, any_motion);  // the stage may run
  for (const auto& name : arguments.plates) {
    TODBENCH_TRY(auto plate, load_plate(name));
    options.plates.push_back(std::move(plate));
  }
  options.distance_m = arguments.distance_m;
  options.seed = arguments.seed;
  options.camera.interface_address = arguments.interface_address;
  options.camera.serial = arguments.serial;
  options.camera.model = "Emulated " + sensor->name;
  options.black_body.server.address = arguments.interface_address;
  options.black_body.server.port = arguments.black_body_port;
  options.black_body.time_constant_s = arguments.black_body_time_constant_s;
  options.drift = {.level_k_per_min = arguments.drift_k_per_min,
                   .pattern_k_per_min = arguments.drift_pattern_k_per_min,
                   .time_constant_s = arguments.drift_time_constant_s};
  options.black_body.stable_dwell_s = 0.01;
  options.stage.server.address = arguments.interface_address;
  options.stage.server.port = arguments.stage_port;
  options.stage.speed_mm_per_s = 1000;
  options.stage.settle_s = 0.005;
  options.stage.travel_mm = 50;
  options.stage.run_jitter_mm = arguments.stage_jitter_mm;
  options.stage.has_trigger = arguments.trigger;
  options.stage.seed = arguments.seed;
  options.stage.plate_change_s = 0.05;
  options.stage.mounting_change_s = 0.05;
  return options;
}

Result<std::unique_ptr<Laboratory>> start_laboratory(const EmulationArguments& arguments) {
  TODBENCH_TRY(auto options, laboratory_options(arguments));
  return Laboratory::start(std::move(options));
}

Plan with_laboratory(Plan plan, const Laboratory& laboratory) {
  // GigE cameras are identified by address, others by serial number.
  plan.camera.id = has_scheme(laboratory.camera_id(), camera_scheme::gige)
                       ? camera_id(camera_scheme::gige, laboratory.camera_address())
                       : laboratory.camera_id();
  for (const auto& [name, value] : laboratory.camera_settings()) plan.camera.settings.insert_or_assign(name, value);
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = laboratory.black_body_endpoint();
  plan.target.stage = laboratory.stage_endpoint();
  return plan;
}
#endif

}  // namespace todbench
