// SPDX-License-Identifier: GPL-3.0-or-later
// todbench pattern
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "acquisition/base/safe_text.h"
#include "bench/cli/commands.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/picture_files/npy.h"
#include "bench/report/pattern_truth.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tod/pattern/test_picture.h"

namespace todbench {
namespace {

struct PatternArguments {
  std::string kind, format, out;
  std::vector<int> pixels;
  double low = 0, high = 1, level = 0.5, angle_deg = 5;
  int spokes = 36;
  std::vector<double> sizes_px, frequencies_per_px;
};

PictureKind kind_of(const PatternArguments& a, std::uint64_t seed) {
  if (a.kind == "tod") return TodPicture{a.sizes_px, seed};
  if (a.kind == "mrtd") return a.frequencies_per_px.empty() ? MrtdPicture{} : MrtdPicture{a.frequencies_per_px};
  if (a.kind == "edge") return EdgePicture{a.angle_deg};
  if (a.kind == "ramp") return RampPicture{};
  if (a.kind == "siemens") return SiemensPicture{a.spokes};
  return FlatPicture{a.level};
}

Result<std::string> encoded(const cv::Mat1d& levels, const std::string& format) {
  if (format == "npy") {
    NpyArray array{{static_cast<std::size_t>(levels.rows), static_cast<std::size_t>(levels.cols)}, {}};
    array.values.assign(levels.begin(), levels.end());
    return to_npy(array);
  }
  if (format == "tiff") return tiff_of(cv::Mat1f(levels));
  cv::Mat1w counts;
  levels.convertTo(counts, CV_16U, 65535);
  return png_of(counts);
}

/// Rejects an existing file that is not the truth of this picture: it is a plan, a plate or the truth of another
/// picture.
Result<void> may_be_written(const std::string& truth_file, const std::string& out, const std::string& truth) {
  if (truth_file == out)
    return fail(ErrorCode::invalid_input,
                "--out " + out + ": the file for the true values has this name; choose another extension");
  std::error_code problem;
  if (!std::filesystem::exists(truth_file, problem)) return {};
  const auto there = read_text_file(truth_file);
  const std::string_view title = std::string_view(truth).substr(0, truth.find(':') + 1);
  if (there && there->starts_with(title)) return {};
  const bool of_other = there && there->starts_with(title.substr(0, title.find(" of ") + 4));
  return fail(ErrorCode::invalid_input,
              "--out " + out + ": the true values would overwrite " + truth_file + ", which is " +
                  (of_other ? "the file of another picture" : "not a file of true values") + "; choose another name");
}

/// The format of the option, else that of the extension, else PNG.
std::string format_of(const PatternArguments& a) {
  const std::string extension = lower_case(std::filesystem::path(a.out).extension().string());
  if (!a.format.empty()) return a.format;
  if (extension == ".npy") return "npy";
  return extension == ".tif" || extension == ".tiff" ? "tiff" : "png16";
}

int run_pattern(Console& console, const PatternArguments& a, std::uint64_t seed) {
  const std::string format = format_of(a);
  const PictureRequest request{
      .size = {a.pixels[0], a.pixels[1]}, .low = a.low, .high = a.high, .kind = kind_of(a, seed)};
  const auto picture = drawn_picture(request);
  if (!picture) return report_error(console, picture.error());
  const auto bytes = encoded(picture->levels, format);
  if (!bytes) return report_error(console, bytes.error());
  const std::filesystem::path folder = std::filesystem::path(a.out).parent_path();
  std::error_code problem;
  if (a.out.empty() || std::filesystem::is_directory(a.out, problem))
    return report_error(console, {ErrorCode::invalid_input, "--out '" + a.out + "': expected the name of a file"});
  if (!folder.empty() && !std::filesystem::is_directory(folder, problem))
    return report_error(console,
                        {ErrorCode::invalid_input, "--out " + a.out + ": " + folder.string() + " is not a folder"});
  const std::string truth_file = std::filesystem::path(a.out).replace_extension(".toml").string();
  const std::string truth = pattern_truth(request, *picture, std::filesystem::path(a.out).filename().string());
  if (const auto may = may_be_written(truth_file, a.out, truth); !may) return report_error(console, may.error());
  if (auto written = write_file_atomically(a.out, *bytes); !written) return report_error(console, written.error());
  if (auto written = write_file_atomically(truth_file, truth); !written) return report_error(console, written.error());
  if (console.json()) {
    console.object({{"pattern", a.kind},
                    {"picture", a.out},
                    {"truth", truth_file},
                    {"format", format},
                    {"width_px", a.pixels[0]},
                    {"height_px", a.pixels[1]},
                    {"triangles", picture->plate.triangles.size()},
                    {"bar_groups", picture->bars.size()}});
    return 0;
  }
  console.text(a.out + "; true values: " + truth_file);
  return 0;
}

}  // namespace

void add_pattern_command(CLI::App& app, Program& program) {
  auto* command =
      app.add_subcommand("pattern", "draws a test picture for projectors and monitors, and writes its true values");
  auto a = std::make_shared<PatternArguments>();
  command->add_option("KIND", a->kind, "kind of picture: tod, mrtd, edge, ramp, siemens or flat")
      ->required()
      ->check(CLI::IsMember({"tod", "mrtd", "edge", "ramp", "siemens", "flat"}));
  command->add_option("--pixels", a->pixels, "width and height of the picture in pixels")
      ->required()
      ->expected(2)
      ->check(whole_number(1, 16384));
  command
      ->add_option(
          "--format", a->format,
          "format of the file: png16 (level 1 is 65535), tiff (32-bit floating point) or npy (64-bit floating point); "
          "by default that of the extension of --out, else png16")
      ->check(CLI::IsMember({"png16", "tiff", "npy"}));
  command
      ->add_option("--out", a->out,
                   "file of the picture; its true values are written beside it, to a file that ends with .toml")
      ->required();
  command->add_option("--low", a->low, "level of the background, 0 to 1")
      ->check(number_in(0, 1))
      ->capture_default_str();
  command->add_option("--high", a->high, "level of the pattern, 0 to 1")->check(number_in(0, 1))->capture_default_str();
  command
      ->add_option("--size-px", a->sizes_px,
                   "tod: sizes of the triangles in pixels, one row for each; default: as many as fit")
      ->delimiter(',')
      ->check(number_in(0.1, 16384));
  command
      ->add_option("--frequency-per-px", a->frequencies_per_px,
                   "mrtd: spatial frequencies in cycles per pixel, at most 0.5 (Nyquist); default: 0.05 to 0.5")
      ->delimiter(',')
      ->check(number_in(1e-4, 1));
  command->add_option("--angle-deg", a->angle_deg, "edge: angle of the edge from the vertical in degrees")
      ->check(number_in(-180, 180))
      ->capture_default_str();
  command->add_option("--spokes", a->spokes, "siemens: number of spokes")
      ->check(whole_number(2, 1000))
      ->capture_default_str();
  command->add_option("--level", a->level, "flat: level of the picture, 0 to 1")
      ->check(number_in(0, 1))
      ->capture_default_str();
  finish_command(*command, program,
                 [a, &program](Console& console) { return run_pattern(console, *a, program.common.seed); });
}

}  // namespace todbench
