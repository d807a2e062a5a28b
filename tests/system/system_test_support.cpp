// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/system_test_support.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/session/manifest.h"
#include "tests/support/verify_manifest.h"

namespace todbench::testing {
namespace {

void expect_numbers(const Json& json) {
  EXPECT_TRUE(!json.is_number_float() || std::isfinite(json.get<double>()));
  if (!json.is_structured()) return;
  for (const auto& item : json) expect_numbers(item);
}

}  // namespace

std::string small_plan(int phases, const std::string& more) {
  const bool has_fit = more.find("[fit]") != std::string::npos;
  return "name = \"small\"\n[target]\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\n"
         "delta_t_k = [16.9]\nphases = " +
         std::to_string(phases) + (has_fit ? "" : "\n[fit]\nestimator = \"weibull\"") +
         "\n[simulation]\naccuracy = \"draft\"\n" + more;
}

std::string tall_sensor(double detector_y_um) {
  return "name = \"tall\"\nwidth = 320\nheight = 190\npitch_um = 47.5\npitch_y_um = 60\ndetector_um = 42.5\n"
         "detector_y_um = " +
         std::to_string(detector_y_um) +
         "\nfocal_length_mm = 36.3\nf_number = 1\nwavelength_min_um = 7.5\nwavelength_max_um = 13\n"
         "netd_k = 0.07\nkelvin_per_count = 0.01\n";
}

std::string small_measurement(int phases, const std::string& more) {
  return small_plan(phases, "phases = " + std::to_string(std::min(phases, 16)) +
                                "\n[camera]\nid = \"sim:sc2000\"\nifov_mrad = 1.3085399449\n" + more);
}

Json one_object(const Ended& ended) {
  const Json json = Json::parse(ended.out, nullptr, false);
  EXPECT_TRUE(json.is_object()) << ended.out << ended.err;
  EXPECT_EQ(std::count(ended.out.begin(), ended.out.end(), '\n'), 1) << ended.out;
  expect_numbers(json);
  return json;
}

std::set<std::string> keys_of(const Json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

void expect_refused(const Ended& ended, int code, const std::string& sentence) {
  EXPECT_EQ(ended.code, code) << ended.err;
  EXPECT_EQ(ended.out, "");
  const auto lines = lines_of(ended.err);
  ASSERT_FALSE(lines.empty());
  EXPECT_THAT(lines.back(), ::testing::StartsWith("todbench: "));
  EXPECT_THAT(lines.back(), ::testing::HasSubstr(sentence));
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(), [](const auto& l) { return l.starts_with("todbench: "); }), 1)
      << ended.err;
}

::testing::AssertionResult completed(const Ended& ended) {
  if (ended.code == 0 || ended.code == 1 || ended.code == 3) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "ended with " << ended.code << ": " << ended.err;
}

::testing::AssertionResult same_content(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto first = lines_of(content_of(a)), second = lines_of(content_of(b));
  if (first.empty()) return ::testing::AssertionFailure() << a << " is empty";
  const auto [x, y] = std::mismatch(first.begin(), first.end(), second.begin(), second.end());
  if (x == first.end() && y == second.end()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "line " << x - first.begin() + 1 << ": " << (x == first.end() ? "" : *x)
                                       << " | " << (y == second.end() ? "" : *y);
}

int occurrences(const std::string& text, const std::string& of) {
  int count = 0;
  for (auto at = text.find(of); at != std::string::npos; at = text.find(of, at + 1)) ++count;
  return count;
}

std::map<std::string, std::string> decisions_of(const Json& effects) {
  std::map<std::string, std::string> decisions;
  for (const auto& effect : effects) decisions[effect["name"]] = effect["decision"];
  return decisions;
}

std::size_t rows_in(const std::filesystem::path& csv) {
  const auto lines = lines_of(content_of(csv));
  return lines.empty() ? 0 : lines.size() - 1;
}

void expect_whole_session(const std::filesystem::path& folder, const std::string& state) {
  for (const char* name : {"session.toml", "provenance.json", "trials.csv", "fits.json", "curve.csv", "report.html",
                           "verdict.json", "log.txt", "manifest.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }
  const auto problems = verify_manifest(folder);
  ASSERT_TRUE(problems) << problems.error().message;
  EXPECT_THAT(*problems, ::testing::IsEmpty());
  const Json provenance = Json::parse(content_of(folder / "provenance.json"), nullptr, false);
  ASSERT_TRUE(provenance.is_object());
  EXPECT_EQ(provenance.value("state", ""), state);
}

}  // namespace todbench::testing
