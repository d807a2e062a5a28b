// SPDX-License-Identifier: GPL-3.0-or-later
// Judgement of blind recordings by an observer.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "acquisition/recording/frame_stream.h"
#include "bench/plan/descriptions.h"
#include "bench/round_robin/blind_items.h"
#include "bench/text/csv_table.h"
#include "bench/text/text.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/registration/patch_windows.h"

namespace todbench {
namespace {

/// Text fields and numbers of a table by the names of its columns.
class NamedColumns {
 public:
  static Result<NamedColumns> read(const std::filesystem::path& file) {
    TODBENCH_TRY(const std::string text, read_text_file(file));
    TODBENCH_TRY(CsvTable table, parse_csv(text, file.string()));
    return NamedColumns(std::move(table));
  }
  [[nodiscard]] const std::vector<CsvRow>& rows() const { return table_.rows; }
  [[nodiscard]] Result<std::string> text(const CsvRow& row, const std::string& name) const {
    const auto found = table_.column(name);
    if (!found) return table_.wrong(1, "missing column '" + name + "'");
    return row.fields[*found];
  }
  [[nodiscard]] Result<double> number(const CsvRow& row, const std::string& name, double low, double high) const {
    TODBENCH_TRY(const std::string field, text(row, name));
    const auto found = parse_number(field);
    if (found && *found >= low && *found <= high) return *found;
    return table_.wrong(row.line, "column " + name + ": expected a number from " + number_text(low) + " to " +
                                      number_text(high) + ", found '" + one_line(field) + "'");
  }
  [[nodiscard]] tl::unexpected<Error> wrong(const CsvRow& row, const std::string& sentence) const {
    return table_.wrong(row.line, sentence);
  }

 private:
  explicit NamedColumns(CsvTable table) : table_(std::move(table)) {}
  CsvTable table_;
};

/// Facts of an item that the coordinator states.
struct StatedItem {
  std::string name, quantity;
  double delta_t_k = 0, ifov_mrad = 0;
};

/// Answers to every triangle of every frame.
Result<std::vector<Level>> answers_to(const std::filesystem::path& folder, const StatedItem& item,
                                      TemplateObserver& observer, const RandomStream& noise,
                                      const std::stop_token& stop) {
  TODBENCH_TRY(const auto stream, open_frame_stream(folder / (item.name + ".todrec")));
  TODBENCH_TRY(const auto table, NamedColumns::read(folder / (item.name + "-triangles.csv")));
  const auto scale = std::make_shared<const RadiometricScale>(stream.recording.info.scale);
  std::vector<Level> out;
  cv::Mat1d kelvin;
  std::optional<std::uint64_t> shown;
  for (const CsvRow& row : table.rows()) {
    if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
    TODBENCH_TRY(const double frame_number, table.number(row, "frame", 0, 1e6));
    TODBENCH_TRY(const double size_mrad, table.number(row, "size_mrad", 1e-3, 1e3));
    TODBENCH_TRY(const double x_px, table.number(row, "x_px", 0, 1e5));
    TODBENCH_TRY(const double y_px, table.number(row, "y_px", 0, 1e5));
    TODBENCH_TRY(const std::string apex_name, table.text(row, "apex"));
    const auto apex = apex_from(apex_name);
    if (!apex) return table.wrong(row, "column apex: expected a direction, found '" + one_line(apex_name) + "'");
    if (const auto wanted = static_cast<std::uint64_t>(frame_number); shown != wanted) {
      TODBENCH_TRY(const RecordedFrame recorded, stream.recording.read(wanted));
      Frame frame;
      frame.counts = recorded.counts;
      frame.scale = scale;
      TODBENCH_TRY(kelvin, to_kelvin(frame));
      shown = wanted;
    }
    TODBENCH_TRY(const auto prepared, observer.prepare(size_mrad / item.ifov_mrad, 1));
    const PatchWindow window = patch_window({x_px, y_px}, prepared->window_samples());
    if ((window.pixels & cv::Rect({0, 0}, kelvin.size())) != window.pixels)
      return table.wrong(row, "the window of the triangle is not inside the picture");
    const Patch patch{.kelvin = kelvin(window.pixels).clone(), .phase = window.phase, .noise_k = 0};
    const int answer = prepared->choose(patch, item.delta_t_k, noise.sub(out.size())).alternative;
    out.push_back(
        {.size = size_mrad, .correct = answer == static_cast<int>(*apex) ? 1.0 : 0.0, .total = 1, .cluster = -1});
  }
  return out;
}

}  // namespace

Result<std::vector<SubmittedResult>> judged_items(const std::filesystem::path& folder, const std::string& laboratory,
                                                  const std::string& observer_name, std::uint64_t seed,
                                                  std::stop_token stop) {
  TODBENCH_TRY(const auto items, NamedColumns::read(folder / "items.csv"));
  TODBENCH_TRY(const auto spec, load_observer(observer_name));
  if (spec.sensor_noise_factor > 1) {
    return fail(ErrorCode::invalid_input, "observer " + spec.name +
                                              " enlarges the noise of the camera (sensor_noise_factor = " +
                                              number_text(spec.sensor_noise_factor) +
                                              "), which blind recordings do not state: use an observer "
                                              "with a factor of 1 (hvs-1)");
  }
  TemplateObserver observer(spec, triangle_alternatives());
  const RandomStream noise(seed, "round_robin.judge " + laboratory);
  std::vector<SubmittedResult> out;
  for (const CsvRow& row : items.rows()) {
    StatedItem item;
    TODBENCH_TRY(item.name, items.text(row, "item"));
    TODBENCH_TRY(item.quantity, items.text(row, "quantity"));
    TODBENCH_TRY(item.delta_t_k, items.number(row, "set_delta_t_k", 1e-6, 1e6));
    TODBENCH_TRY(item.ifov_mrad, items.number(row, "ifov_mrad", 1e-6, 1e6));
    if (item.name.empty() || item.name.find_first_of("/\\") != std::string::npos)
      return items.wrong(row, "column item: expected the name of a recording in the folder");
    TODBENCH_TRY(const auto answers, answers_to(folder, item, observer, noise.sub(out.size()), stop));
    const auto fit = fit_psychometric(answers, {});
    if (!fit) return fail(item.name, fit.error());
    if (!fit->threshold || !fit->ci95.low || !fit->ci95.high) {
      return fail(ErrorCode::not_identifiable, item.name + ": the answers of " + observer_name +
                                                   " give no threshold with both ends of its interval");
    }
    out.push_back({laboratory, item.name, item.quantity, "", *fit->threshold,
                   (*fit->ci95.high - *fit->ci95.low) / (2 * normal_z95), folder.string()});
  }
  return out;
}

}  // namespace todbench
