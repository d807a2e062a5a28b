// SPDX-License-Identifier: GPL-3.0-or-later
// todbench record
#include <fmt/format.h>

#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string_view>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/core/input_gate.h"
#include "acquisition/core/integrity_gate.h"
#include "acquisition/recording/frame_stream.h"
#include "acquisition/recording/tiff_writer.h"
#include "bench/cli/commands.h"
#include "bench/devices/camera_settings.h"
#include "bench/devices/devices.h"
#include "bench/judgement/verdict.h"
#include "bench/run/recorded_bench.h"
#include "bench/session/provenance.h"

namespace todbench {
namespace {

struct RecordArguments {
  std::string camera;
  std::string out;
  std::string format = "recording";
  bool overwrite = false;
  std::int64_t frames = 0;  ///< 0: no limit
  double seconds = 0;       ///< 0: no limit
  double timeout_s = 2;
  std::vector<std::string> settings;  ///< "FEATURE=VALUE"
};

/// Destination of the frames: a recording or a TIFF stack.
class Sink {
 public:
  static Result<Sink> create(const std::filesystem::path& file, const std::string& format, const SourceInfo& info) {
    Sink sink;
    if (format == "tiff") {
      TODBENCH_TRY(sink.tiff_, TiffWriter::create(file));
      return sink;
    }
    TODBENCH_TRY(sink.stream_, FrameStreamWriter::create(file, header_now(info)));
    return sink;
  }
  /// A TIFF contains complete frames only: it cannot mark incomplete ones.
  Result<void> append(const Frame& frame) {
    if (stream_) return stream_->append(frame);
    return frame.status == FrameStatus::complete ? tiff_->append(frame.counts) : Result<void>();
  }
  /// Returns the number of frames that a reader finds in the file, after all data are on the disk.
  Result<std::uint64_t> finish() { return stream_ ? stream_->verified_frames() : tiff_->verified_pages(); }
  /// Whether a file without frames is valid in its format.
  [[nodiscard]] bool may_be_empty() const { return stream_.has_value(); }

 private:
  std::optional<FrameStreamWriter> stream_;
  std::optional<TiffWriter> tiff_;
};

/// Outcome of a recording.
struct Recorded {
  std::uint64_t arrived = 0;
  std::uint64_t frames = 0;  ///< in the file
  NumberingFaults numbering;
  std::map<std::string, std::uint64_t> rejected;
  std::uint64_t lost = 0;
  ByteOrderWatch byte_order;
  std::optional<Error> ended_by;
  std::optional<Error> damaged;  ///< too many frames that the file cannot mark as damaged
};

/// Damages that a file does not mark, unlike incomplete frames. A camera may repeat frames or their numbers.
constexpr std::array unmarked_damages{Rejection::byte_swapped, Rejection::repeated, Rejection::out_of_order};

std::optional<Error> unmarked_damage(const IntegrityGate& gate, const Recorded& recorded, const std::string& camera) {
  const std::span damages(unmarked_damages);
  const bool is_file = has_scheme(camera, camera_scheme::file);
  const auto sound = judge_damages(gate.rejected_by_reason(), recorded.arrived, is_file ? damages : damages.first(1));
  return sound ? std::nullopt : std::optional(sound.error());
}

/// Notes features that read back otherwise; fails if they scale counts.
Result<void> apply_settings(FrameSource& camera, const std::vector<std::string>& settings, Console& console) {
  std::map<std::string, std::string> written;
  for (const auto& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
      return fail(ErrorCode::invalid_input, "--set " + setting + ": expected FEATURE=VALUE");
    if (auto set = camera.set(setting.substr(0, equals), setting.substr(equals + 1)); !set)
      return fail("setting " + setting, set.error());
    written[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  TODBENCH_TRY(const auto warnings, check_written_settings(camera, written));
  for (const std::string& warning : warnings) console.note(warning);
  return {};
}

Recorded take_frames(FrameSource& camera, Sink& sink, const RecordArguments& a, Console& console, StopSignals& stop) {
  Recorded recorded;
  const SourceInfo& info = camera.info();
  IntegrityGate gate({.width = info.width, .height = info.height});
  const std::stop_callback wake(stop.token(), [&camera] { camera.stop(); });
  const auto timeout = std::chrono::milliseconds(static_cast<long>(a.timeout_s * 1000));
  // The time starts with the first frame: a camera may need seconds to start.
  std::int64_t end_ns = 0;
  const auto limit = static_cast<std::uint64_t>(a.frames);
  if (auto started = camera.start(); !started) {
    recorded.ended_by = started.error();
    return recorded;
  }
  while ((limit == 0 || recorded.arrived < limit) &&
         (a.seconds == 0 || recorded.arrived == 0 || monotonic_ns() < end_ns)) {
    Result<Frame> frame = stop.token().stop_requested()
                              ? Result<Frame>(fail(ErrorCode::interrupted, "stopped on request"))
                              : camera.next(timeout);
    if (frame) {
      if (const auto reason = gate.judge(*frame); reason != Rejection::incomplete)
        recorded.byte_order.see(frame->counts, frame->significant_bits);
      if (recorded.arrived == 0) end_ns = monotonic_ns() + static_cast<std::int64_t>(a.seconds * 1e9);
      ++recorded.arrived;
      auto written = sink.append(*frame);
      if (written) {
        if (limit > 0) console.progress(recorded.arrived, limit);
        continue;
      }
      recorded.ended_by = written.error();
    } else {
      recorded.ended_by = frame.error();
    }
    break;
  }
  camera.stop();
  for (const auto& [reason, count] : gate.rejected_by_reason())
    recorded.rejected[std::string(to_string(reason))] = count;
  recorded.damaged = unmarked_damage(gate, recorded, a.camera);
  recorded.lost = gate.lost();
  recorded.numbering = gate.numbering();
  return recorded;
}

std::string default_file(const RecordArguments& a) {
  std::string name = "recording-";
  for (const char c : utc_now()) {
    if (c != '-' && c != ':') name += c;
  }
  return name + (a.format == "tiff" ? ".tif" : ".todrec");
}

/// Checks the file on the disk. Removes a file without frames that is not valid in its format.
void finish(Sink& sink, const std::filesystem::path& file, Recorded& recorded) {
  const auto kept = sink.finish();
  recorded.frames = kept.value_or(0);
  // A disk error takes precedence over other errors.
  if (!kept && (!recorded.ended_by || recorded.ended_by->code != ErrorCode::io)) recorded.ended_by = kept.error();
  if (!kept || *kept > 0 || sink.may_be_empty()) return;
  std::error_code problem;
  std::filesystem::remove(file, problem);
  const bool disk_failed = recorded.ended_by && recorded.ended_by->code == ErrorCode::io;
  if (disk_failed) return;
  const bool has_a_reason = recorded.arrived == 0 && recorded.ended_by;
  if (has_a_reason && recorded.ended_by->code != ErrorCode::interrupted) return;
  recorded.ended_by =
      Error{ErrorCode::integrity, "none of " + std::to_string(recorded.arrived) + " frames is complete"};
}

/// Whether it has a frame and ended as requested: at its limit, by Ctrl-C without a limit, or with its source
/// recording.
bool as_wanted(const Recorded& recorded, const RecordArguments& a) {
  if (recorded.frames == 0) return false;
  if (!recorded.ended_by) return true;
  const bool limited = a.frames > 0 || a.seconds > 0;
  if (recorded.ended_by->code == ErrorCode::interrupted) return !limited;
  return recorded.ended_by->code == ErrorCode::disconnected && has_scheme(a.camera, camera_scheme::file) &&
         a.frames == 0 && recorded.arrived > 0;
}

/// Whether the output file is the source of the frames, or one of the files in the source folder.
bool overwrites_its_camera(const std::filesystem::path& file, const std::string& camera) {
  const auto name = camera_name(camera, camera_scheme::file);
  if (!name) return false;
  const std::filesystem::path source = name->substr(0, name->find('?'));
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) return false;
  if (std::filesystem::equivalent(file, source, problem)) return true;
  return std::filesystem::is_directory(source, problem) &&
         std::filesystem::equivalent(std::filesystem::absolute(file).parent_path(), source, problem);
}

/// What the camera or the recording says of itself.
Json source_json(const SourceInfo& info) {
  return {{"vendor", info.vendor},
          {"model", info.model},
          {"serial", info.serial},
          {"firmware", info.firmware},
          {"width", info.width},
          {"height", info.height},
          {"pixel_format", info.pixel_format},
          {"frame_rate_hz", info.frame_rate_hz > 0 ? Json(info.frame_rate_hz) : Json()},
          {"scale", info.scale.describe()},
          {"settings", info.settings},
          {"warnings", info.warnings}};
}

/// The same for people, in two lines; empty parts are left out.
void print_source(const Console& console, const SourceInfo& info) {
  std::string line = info.vendor;
  for (const auto& [what, value] : {std::pair{"", info.model}, std::pair{"serial ", info.serial}}) {
    if (!value.empty()) line += (line.empty() ? "" : what[0] == 0 ? " " : ", ") + std::string(what) + value;
  }
  line += (line.empty() ? "" : ", ") + std::to_string(info.width) + " x " + std::to_string(info.height);
  if (info.frame_rate_hz > 0) line += fmt::format(", {:.4g} Hz", info.frame_rate_hz);
  const auto date = info.settings.find("DateTimeOriginal");
  if (date != info.settings.end() && !date->second.empty()) line += ", " + date->second;
  console.text(line);
  console.text("temperature scale: " + info.scale.describe());
}

int run_record(Console& console, const RecordArguments& a, StopSignals& stop) {
  const std::filesystem::path file = a.out.empty() ? default_file(a) : a.out;
  std::error_code problem;
  if (std::filesystem::exists(file, problem) && !a.overwrite) {
    return report_error(
        console, {ErrorCode::invalid_input,
                  file.string() + ": the file exists already; choose another file or overwrite it with --force"});
  }
  if (overwrites_its_camera(file, a.camera)) {
    return report_error(console, {ErrorCode::invalid_input,
                                  file.string() + ": the frames are read from there; choose another output file"});
  }
  auto camera =
      camera_registry(stop.token(), [&](std::string_view sentence) { console.phase(sentence); }).open(a.camera);
  if (!camera) return report_error(console, camera.error());
  if (auto set = apply_settings(**camera, a.settings, console); !set) return report_error(console, set.error());
  const SourceInfo info = (*camera)->info();
  for (const auto& warning : info.warnings) console.note(warning);
  auto sink = Sink::create(file, a.format, info);
  if (!sink) return report_error(console, sink.error());
  console.phase("recording " + info.id);
  Recorded recorded = take_frames(**camera, *sink, a, console, stop);
  console.end_progress();
  finish(*sink, file, recorded);
  for (const std::string& sentence : {describe(recorded.numbering), recorded.byte_order.note()}) {
    if (!sentence.empty()) console.note(sentence);
  }
  if (console.json()) {
    console.object({{"recording", file.string()},
                    {"camera", info.id},
                    {"source", source_json(info)},
                    {"frames", recorded.frames},
                    {"arrived", recorded.arrived},
                    {"lost", recorded.lost},
                    {"rejected", recorded.rejected},
                    {"byte_order", to_string(recorded.byte_order.verdict())},
                    {"numbering",
                     {{"restarts", recorded.numbering.restarts},
                      {"silent_gaps", recorded.numbering.silent_gaps},
                      {"estimated_lost", recorded.numbering.estimated_lost},
                      {"unread", recorded.numbering.unread}}}});
  } else {
    print_source(console, info);
    std::string doubtful;
    for (const auto& [reason, count] : recorded.rejected) doubtful += ", " + std::to_string(count) + " " + reason;
    console.text(file.string() + ": " + std::to_string(recorded.frames) +
                 (recorded.frames == 1 ? " frame, " : " frames, ") + std::to_string(recorded.lost) + " lost" +
                 doubtful);
  }
  if (as_wanted(recorded, a)) {
    if (!recorded.damaged) return 0;
    console.error(recorded.damaged->message + "; all frames are in " + file.string());
    return exit_code(recorded.damaged->code);
  }
  if (!recorded.ended_by) recorded.ended_by = Error{ErrorCode::timeout, "no frame arrived"};
  console.error("ended early: " + recorded.ended_by->message +
                (recorded.frames > 0 ? "; the frames so far are in " + file.string() : "; no frame was saved"));
  return exit_code(recorded.ended_by->code);
}

}  // namespace

void add_record_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("record", "records the frames of a camera (or of a recording) to a file");
  auto a = std::make_shared<RecordArguments>();
  command->add_option("CAMERA", a->camera, "camera: id as listed by todbench devices, or file:PATH")->required();
  command->add_option("--out", a->out, "output file; default: recording-TIME.todrec in the current folder");
  command
      ->add_option(
          "--format", a->format,
          "format of the file: recording (every frame that arrives) or tiff (16-bit stack of the complete frames)")
      ->check(CLI::IsMember({"recording", "tiff"}))
      ->capture_default_str();
  command->add_option("--frames", a->frames, "stops after this number of frames")
      ->check(whole_number(1, 1'000'000'000));
  command->add_option("--seconds", a->seconds, "stops this time after the first frame, in s")
      ->check(number_in(0.001, 1e7));
  command->add_option("--timeout-s", a->timeout_s, "time without a frame, in s, after which the camera counts as lost")
      ->check(number_in(0.001, 600, "s"))
      ->capture_default_str();
  command->add_option("--set", a->settings,
                      "camera setting FEATURE=VALUE, written before the first frame; may be repeated");
  command->add_flag("--force", a->overwrite, "overwrites an existing file");
  finish_command(*command, program, [a, &program](Console& console) { return run_record(console, *a, *program.stop); });
}

}  // namespace todbench
