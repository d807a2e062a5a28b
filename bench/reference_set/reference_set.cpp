// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/reference_set/reference_set.h"

#include <memory>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/tiff_writer.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "bench/reference_set/reference_files.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/simulated_camera.h"
#include "tod/schedule/schedule.h"

namespace todbench {
namespace {

constexpr std::array<std::string_view, 2> plate_names{"tcat-a", "tcat-b"};

/// Writer of the frames of one case in both formats, and of their content.
class CaseWriter {
 public:
  static Result<CaseWriter> create(const std::filesystem::path& folder, const ReferenceCase& c,
                                   const SourceInfo& info) {
    StreamHeader header;
    header.info = info;
    // The time is not recorded: the same seed gives the same bytes.
    header.created_utc = "1970-01-01T00:00:00Z";
    header.annotations = {{"reference_set", std::string(reference_set_name)}, {"case", c.name}};
    TODBENCH_TRY(auto stream, FrameStreamWriter::create(folder / (c.name + ".todrec"), header));
    TODBENCH_TRY(auto tiff, TiffWriter::create(folder / (c.name + ".tif")));
    return CaseWriter(std::move(stream), std::move(tiff));
  }

  Result<void> append(Frame frame, const PlateScene& scene, const SensorSpec& sensor) {
    frame.host_time_ns = frame.device_time_ns;
    TODBENCH_TRY_VOID(stream_.append(frame));
    TODBENCH_TRY_VOID(tiff_.append(frame.counts));
    const std::string number = std::to_string(frame.sequence);
    frames_ += number + "," + scene.plate.name + "," + std::string(to_string(scene.plate.mounting)) + "," +
               number_text(scene.shift_mm.x) + "," + number_text(scene.shift_mm.y) + "\n";
    for (const PlateTriangle& t : scene.plate.triangles) {
      const cv::Point2d at =
          scene_pixel(scene, t.position_mm, sensor.ifov_mrad(), {frame.counts.cols, frame.counts.rows});
      triangles_ += number + "," + csv_field(t.name) + "," + number_text(t.size_mm) + "," +
                    number_text(t.size_mm / scene.distance_m) + "," + std::string(to_string(t.apex)) + "," +
                    number_text(at.x) + "," + number_text(at.y) + "\n";
    }
    return {};
  }

  Result<void> finish(const std::filesystem::path& folder, const std::string& name) {
    TODBENCH_TRY_VOID(stream_.verified_frames());
    TODBENCH_TRY_VOID(tiff_.verified_pages());
    TODBENCH_TRY_VOID(write_file_atomically(folder / (name + "-frames.csv"), frames_));
    return write_file_atomically(folder / (name + "-triangles.csv"), triangles_);
  }

 private:
  CaseWriter(FrameStreamWriter stream, TiffWriter tiff) : stream_(std::move(stream)), tiff_(std::move(tiff)) {}
  FrameStreamWriter stream_;
  TiffWriter tiff_;
  std::string frames_ = "frame,plate,mounting,shift_x_mm,shift_y_mm\n";
  std::string triangles_ = "frame,triangle,size_mm,size_mrad,apex,x_px,y_px\n";
};

/// Returns the presentations of a case: both plates, every mounting in turn, sub-pixel shifts spread evenly.
std::vector<TargetState> presentations(const ReferenceCase& c, int frames, const RandomStream& stream) {
  const auto shifts = spread_phases(frames, stream);
  const double pixel_mm = c.sensor.ifov_mrad() * reference_distance_m;
  std::vector<TargetState> out;
  for (int i = 0; i < frames; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out.push_back({.plate = std::string(plate_names[k * 2 / static_cast<std::size_t>(frames)]),
                   .mounting = all_mountings[k % all_mountings.size()],
                   .delta_t_k = c.delta_t_k,
                   .shift_mm = pixel_mm * shifts[k]});
  }
  return out;
}

Result<std::vector<TargetPlate>> both_plates() {
  std::vector<TargetPlate> plates;
  for (const auto name : plate_names) {
    TODBENCH_TRY(auto plate, load_plate(name));
    plates.push_back(std::move(plate));
  }
  return plates;
}

}  // namespace

Result<void> write_plates_and_observer(const std::filesystem::path& folder) {
  for (const char* name : {"plates", "observers"}) {
    TODBENCH_TRY_VOID(make_folder(folder / name));
  }
  std::vector<std::pair<ResourceKind, std::string_view>> copies{{ResourceKind::observer, reference_observer}};
  for (const auto name : plate_names) copies.emplace_back(ResourceKind::plate, name);
  for (const auto& [kind, name] : copies) {
    TODBENCH_TRY(const auto resource, find_resource(kind, name));
    const auto file = folder / (kind == ResourceKind::plate ? "plates" : "observers") / (std::string(name) + ".toml");
    TODBENCH_TRY_VOID(write_file_atomically(file, resource.text));
  }
  return {};
}

Result<void> write_reference_case(const std::filesystem::path& folder, const ReferenceCase& c, std::uint64_t number,
                                  const ReferenceSetOptions& options, const std::stop_token& stop) {
  TODBENCH_TRY(const auto plates, both_plates());
  const RandomStream stream = RandomStream(options.seed, "reference_set").sub(number);
  const auto model =
      std::make_shared<const SensorModel>(c.sensor, full_plan(c.sensor, {}, {}), Accuracy::normal(), stream.stream());
  PlateScene first;
  first.plate = plates.front();
  first.distance_m = reference_distance_m;
  first.background_k = reference_background_k;
  const auto scene = std::make_shared<SceneHolder>(first);
  const auto camera = simulated_source(model, scene, c.name);
  const auto target = scene_target(scene, plates);
  TODBENCH_TRY(auto writer, CaseWriter::create(folder, c, camera->info()));
  TODBENCH_TRY_VOID(camera->start());
  for (const TargetState& state : presentations(c, options.frames, stream.sub(1))) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    TODBENCH_TRY_VOID(target->present(state, stop));
    TODBENCH_TRY(auto frame, camera->next(std::chrono::milliseconds(0)));
    TODBENCH_TRY_VOID(writer.append(std::move(frame), *scene->scene(), c.sensor));
  }
  return writer.finish(folder, c.name);
}

Result<void> write_reference_set(const std::filesystem::path& folder, const ReferenceSetOptions& options,
                                 std::stop_token stop) {
  TODBENCH_TRY(const auto truths, reference_truths(options.cases, stop));
  TODBENCH_TRY_VOID(make_folder(folder));
  TODBENCH_TRY_VOID(write_plates_and_observer(folder));
  TODBENCH_TRY_VOID(make_folder(folder / "sensors"));
  for (const ReferenceCase& c : options.cases) {
    const auto file = folder / "sensors" / (c.sensor.name + ".toml");
    TODBENCH_TRY_VOID(write_file_atomically(file, sensor_description(c.sensor)));
  }
  for (std::size_t i = 0; i < options.cases.size(); ++i) {
    if (auto written = write_reference_case(folder, options.cases[i], i, options, stop); !written)
      return fail(options.cases[i].name, written.error());
    if (options.on_progress) options.on_progress(i + 1, options.cases.size());
  }
  TODBENCH_TRY_VOID(write_file_atomically(folder / "set.json", set_description(options, truths)));
  TODBENCH_TRY_VOID(write_file_atomically(folder / "README.md", set_readme(options)));
  TODBENCH_TRY(const auto sums, set_sums(folder));
  return write_file_atomically(folder / "SHA256SUMS", sums);
}

}  // namespace todbench
