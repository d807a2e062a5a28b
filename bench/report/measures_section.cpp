#include "bench/report/measures_section.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bench/report/number_format.h"
#include "bench/report/report_pieces.h"

namespace todbench {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 15> names{{
    {"transfer_slope", "Temperature scale: contrast seen over contrast shown"},
    {"transfer_offset", "Temperature scale: offset"},
    {"transfer_nonlinearity", "Temperature scale: nonlinearity"},
    {"temporal_noise", "Temporal noise of a pixel"},
    {"netd", "NETD (temporal noise over the temperature scale)"},
    {"lag1_correlation", "Correlation of a pixel in successive frames"},
    {"noise_counts", "Temporal noise in steps of the counts"},
    {"shading_range", "Shading over the plate, taken out"},
    {"noise_t", "3-D noise t: whole frames"},
    {"noise_v", "3-D noise v: fixed rows"},
    {"noise_h", "3-D noise h: fixed columns"},
    {"noise_tv", "3-D noise tv: rows in time"},
    {"noise_th", "3-D noise th: columns in time"},
    {"noise_vh", "3-D noise vh: fixed pattern"},
    {"noise_tvh", "3-D noise tvh: pixels in time"},
}};

std::string name_of(const MeasureLine& line) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const auto& row) { return row.first == line.measure; });
  return (found == names.end() ? line.measure : std::string(found->second)) +
         (line.unit == "1" ? "" : " (" + line.unit + ")");
}

RichText value_of(const MeasureLine* line) {
  if (line == nullptr) return missing("not measured");
  if (!line->value) return missing("not known");
  if (!line->ci95.low && !line->ci95.high) return plain(significant(*line->value, 3));
  return interval_or_missing(line->value, line->ci95, "not measured");
}

const MeasureLine* line_of(const std::optional<MeasureLines>& side, std::string_view measure) {
  if (!side) return nullptr;
  const auto found = std::find_if(side->lines.begin(), side->lines.end(),
                                  [&](const MeasureLine& line) { return line.measure == measure; });
  return found == side->lines.end() ? nullptr : &*found;
}

}  // namespace

std::optional<Section> measures_section(const ReportData& data) {
  if (!data.measures || (!data.measures->main && !data.measures->twin)) return std::nullopt;
  const auto& main = data.measures->main;
  const auto& twin = data.measures->twin;
  Section section{"Physical measures", {}};
  Table table{.caption = "", .header = {"Measure", data.camera ? "camera" : "simulated sensor"}, .rows = {}};
  if (twin) table.header.emplace_back("simulated twin");
  std::vector<std::string> conditions;
  for (const MeasureLine& line : (main ? main : twin)->lines) {
    std::vector<RichText> row{plain(name_of(line)), value_of(line_of(main, line.measure))};
    if (twin) row.push_back(value_of(line_of(twin, line.measure)));
    table.rows.push_back(std::move(row));
    if (std::find(conditions.begin(), conditions.end(), line.conditions) == conditions.end())
      conditions.push_back(line.conditions);
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  if (!conditions.empty()) section.blocks.emplace_back(list_of(conditions));
  std::vector<std::string> reasons;
  if (main) reasons = main->reasons;
  if (twin) {
    for (const auto& reason : twin->reasons) reasons.push_back("Simulated twin: " + reason);
  }
  if (!reasons.empty()) section.blocks.emplace_back(list_of(reasons));
  section.blocks.emplace_back(note(
      plain("In brackets 95 % intervals of the finite number of frames, pixels and steps. Black body, air path and "
            "emissivity are not in them.")));
  return section;
}

}  // namespace todbench
