// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers in the wrong unit and numbers beyond any: refused with a sentence, or a result without NaN.
#include <fstream>
#include <sstream>

#include "sim_devices/sensor/sensor_key.h"
#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The text with another value of a key; a key that it does not have is put first.
std::string with_value(const std::string& text, const std::string& key, const std::string& value) {
  std::istringstream lines(text);
  std::string out, line;
  bool there = false;
  while (std::getline(lines, line)) {
    if (line.starts_with(key + " =")) line = key + " = " + value, there = true;
    out += line + "\n";
  }
  return there ? out : key + " = " + value + "\n" + out;
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void expect_no_nan(const Ended& ended, const std::string& about) {
  EXPECT_THAT(ended.code, AnyOf(0, 1, 2, 3)) << about << ": " << ended.err;
  EXPECT_THAT(ended.out, Not(HasSubstr("nan"))) << about;
  EXPECT_THAT(ended.out, Not(HasSubstr("inf"))) << about;
  if (ended.code != 0) {
    EXPECT_FALSE(ended.err.empty()) << about;
  }
}

TEST(PhysicalRanges, NoValueOfASensorKeyGivesANumberThatIsNone) {
  const TemporaryFolder folder;
  const std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  for (const SensorKey& key : sensor_keys()) {
    if (std::holds_alternative<DisplayReconstruction SensorSpec::*>(key.member)) continue;
    const bool whole = std::holds_alternative<int SensorSpec::*>(key.member);
    for (const std::string value : {"1e308", "-1e308", "1e-320", "0.0", "nan", "inf"}) {
      std::ofstream(folder.path() / "s.toml") << with_value(sensor, std::string(key.name), whole ? "0" : value);
      expect_no_nan(
          todbench({"mtf", "--sensor", "s.toml", "--frequency-per-pitch", "0.1", "--json"}, {.folder = folder.path()}),
          std::string(key.name) + " = " + value);
      if (whole) break;
    }
  }
}

TEST(PhysicalRanges, AWavelengthInMillimetresIsRefusedWithItsUnit) {
  const TemporaryFolder folder;
  const std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  std::ofstream(folder.path() / "s.toml")
      << with_value(with_value(sensor, "wavelength_min_um", "0.0075"), "wavelength_max_um", "0.013");

  const Ended ended =
      todbench({"mtf", "--sensor", "s.toml", "--frequency-per-pitch", "0.1", "--json"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 2);
  EXPECT_THAT(ended.err, HasSubstr("expected a number from 0.1 to 100, found 0.0075; is the value in mm?"));
}

TEST(PhysicalRanges, ASensorKeyInAnotherUnitIsRefusedWithItsUnit) {
  struct Mistake {
    const char *key, *value, *hint;
  };
  const Mistake mistakes[] = {{"netd_k", "70", "mK"},
                              {"row_noise_k", "30", "mK"},
                              {"column_noise_k", "30", "mK"},
                              {"fixed_pattern_k", "50", "mK"},
                              {"focal_length_mm", "0.0363", "m"},
                              {"scene_temperature_k", "27", "degrees Celsius"},
                              {"time_constant_ms", "0.010", "s"},
                              {"pitch_um", "0.0475", "mm"}};
  const TemporaryFolder folder;
  const std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  for (const auto& [key, value, hint] : mistakes) {
    std::ofstream(folder.path() / "s.toml") << with_value(sensor, key, value);

    const Ended ended =
        todbench({"mtf", "--sensor", "s.toml", "--frequency-per-pitch", "0.1", "--json"}, {.folder = folder.path()});

    EXPECT_EQ(ended.code, 2) << key;
    EXPECT_THAT(ended.err, HasSubstr(key));
    EXPECT_THAT(ended.err, HasSubstr("; is the value in " + std::string(hint) + "?")) << key;
  }
}

TEST(PhysicalRanges, ACurveBeyondAnyCameraIsRefused) {
  const TemporaryFolder folder;
  for (const std::string value : {"1e308", "1e-320", "nan", "inf", "-1"}) {
    std::ofstream(folder.path() / "c.csv") << "frequency_per_mrad,mrtd_k\n0.1,0.1\n1," << value << "\n";
    const Ended ended = todbench({"range", "--size-m", "2.3", "--delta-t-k", "2", "--mrtd", "c.csv", "--models",
                                  "acquire", "--extinction-per-km", "0.2", "--json"},
                                 {.folder = folder.path()});
    EXPECT_EQ(ended.code, 2) << value << ended.out;
  }
}

}  // namespace
}  // namespace todbench::testing
