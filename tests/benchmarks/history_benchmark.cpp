// SPDX-License-Identifier: GPL-3.0-or-later
// The history of ten thousand sessions: made again from their folders, and a chart of one unit.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include "bench/history/control_chart.h"
#include "bench/history/history_series.h"
#include "bench/session/manifest.h"
#include "bench/text/json.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

constexpr int units = 100, sessions_of_unit = 100;
/// Of the demonstration with a table of the twin.
constexpr std::size_t fits_bytes = 470000;

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::string serial_of(int unit) {
  return "S" + std::to_string(1000 + unit);
}

template <typename T>
T checked(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return *std::move(result);
}

/// Sessions of a camera with measures, each as long as that of the demonstration. The fits are those of a unit, one
/// file with many names.
class ManySessions {
 public:
  ManySessions() {
    const std::filesystem::path golden = source_file("tests/golden/session-0.1");
    auto provenance = Json::parse(read_file(golden / "provenance.json"));
    provenance["side"] = "measured";
    std::string curve = read_file(golden / "curve.csv"), fits = read_file(golden / "fits.json");
    for (std::size_t at = 0; (at = curve.find("simulated", at)) != std::string::npos;) curve.replace(at, 9, "measured");
    Json quantities = Json::array();
    for (const char* name : {"netd", "temporal_noise", "noise_t", "noise_v", "noise_h", "noise_tvh", "mtf_x", "mtf_y"})
      quantities.push_back({{"measure", name}, {"unit", "K"}, {"value", 0.05}, {"ci95", {0.049, 0.051}}});
    const std::string measures = Json{{"main", {{"quantities", quantities}}}}.dump();
    for (int unit = 0; unit < units; ++unit) {
      provenance["camera"] = {{"vendor", "FLIR"}, {"model", "SC2000"}, {"serial", serial_of(unit)}, {"firmware", "1"}};
      std::string own = fits;
      own.replace(own.find("\"sc2000\""), 8, "\"SC2000 " + serial_of(unit) + "\"");
      own.resize(fits_bytes, ' ');
      for (int k = 0; k < sessions_of_unit; ++k) {
        char utc[32];
        std::snprintf(utc, sizeof utc, "%04d-%02d-%02dT%02d:00:00Z", 2018 + k / 12, 1 + k % 12, 1 + unit % 28, k % 24);
        provenance["started_utc"] = utc;
        const auto folder = folder_.path() / serial_of(unit) / std::to_string(1000 + k);
        std::filesystem::create_directories(folder);
        std::filesystem::copy(golden / "session.toml", folder / "session.toml");
        write_file(folder / "provenance.json", provenance.dump(2));
        write_file(folder / "curve.csv", curve);
        write_file(folder / "measures.json", measures);
        const auto first = folder.parent_path() / "1000" / "fits.json";
        if (k == 0) {
          write_file(first, own);
          entries_.clear();
          (void)update_entries(folder, {"fits.json"}, entries_);
        } else {
          std::filesystem::create_hard_link(first, folder / "fits.json");
        }
        (void)update_entries(folder, {"session.toml", "provenance.json", "curve.csv", "measures.json"}, entries_);
        if (!write_manifest(folder, entries_)) throw std::runtime_error("no manifest");
      }
    }
  }

  [[nodiscard]] std::filesystem::path index_file() const { return folder_.path() / "index" / "history.sqlite"; }

  /// As `todbench history add` does.
  void add_all() const {
    std::filesystem::remove_all(index_file().parent_path());
    auto index = checked(HistoryIndex::open(index_file()));
    int added = 0;
    for (const auto& folder : checked(session_folders_below(folder_.path()))) {
      if (checked(index.add(checked(read_history_session(folder)))) == Adding::added) ++added;
    }
    if (added != units * sessions_of_unit) throw std::runtime_error("not every session was added");
  }

 private:
  testing::TemporaryFolder folder_;
  ManifestEntries entries_;
};

const ManySessions& many_sessions() {
  static const ManySessions sessions;
  return sessions;
}

/// 60 s are allowed.
void index_of_10000_sessions(benchmark::State& state) {
  const ManySessions& sessions = many_sessions();
  for (auto _ : state) sessions.add_all();
}
BENCHMARK(index_of_10000_sessions)->Unit(benchmark::kSecond)->Iterations(1)->MeasureProcessCPUTime();

/// Of one unit with 100 sessions and its nine measures, from the index: 0.2 s are allowed.
void charts_of_a_unit(benchmark::State& state) {
  const ManySessions& sessions = many_sessions();
  if (!std::filesystem::exists(sessions.index_file())) sessions.add_all();
  for (auto _ : state) {
    const auto index = checked(HistoryIndex::open(sessions.index_file()));
    for (const HistorySeries& series : checked(history_series(index, serial_of(7), "")))
      benchmark::DoNotOptimize(control_chart(series.values, {}));
  }
}
BENCHMARK(charts_of_a_unit)->Unit(benchmark::kMillisecond);

/// The same of every unit at once, as the window reads them.
void charts_of_all_units(benchmark::State& state) {
  const ManySessions& sessions = many_sessions();
  if (!std::filesystem::exists(sessions.index_file())) sessions.add_all();
  for (auto _ : state) {
    const auto index = checked(HistoryIndex::open(sessions.index_file()));
    for (const HistorySeries& series : checked(history_series(index, "", "")))
      benchmark::DoNotOptimize(control_chart(series.values, {}));
  }
}
BENCHMARK(charts_of_all_units)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace todbench
