// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/descriptions.h"

#include <gmock/gmock.h>

#include "sim_devices/sensor/effect_list.h"
#include "sim_devices/sensor/sensor_key.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

constexpr const char* small_plate = R"(name = "small"
width_mm = 100
height_mm = 80
[[row]]
size_mm = 10
y_mm = -20
x_mm = [-25, 25]
apex = ["up", "left"]
[[row]]
size_mm = 5
y_mm = 20
x_mm = [0]
apex = ["down"]
names = ["the small one"]
)";

TEST(Resources, TheShippedDescriptionsAreCompiledIn) {
  EXPECT_THAT(resource_names(ResourceKind::sensor), IsSupersetOf({"sc2000"}));
  EXPECT_THAT(resource_names(ResourceKind::observer), IsSupersetOf({"hvs-1", "human-like-1"}));
  EXPECT_THAT(resource_names(ResourceKind::plate), IsSupersetOf({"tcat-a", "tcat-b"}));
  EXPECT_THAT(resource_names(ResourceKind::plan), IsSupersetOf({"demo"}));
}

TEST(Resources, ACompiledInFileIsTheFileByteForByte) {
  const Result<Resource> resource = find_resource(ResourceKind::sensor, "sc2000");

  ASSERT_TRUE(resource) << resource.error().message;
  EXPECT_EQ(resource->text, testing::content_of(source_file("sim_devices/sensors/sc2000.toml")));
}

TEST(Resources, AnUnknownNameIsAnsweredWithTheNearestAndTheKnownOnes) {
  const Result<Resource> resource = find_resource(ResourceKind::observer, "hsv-1");

  ASSERT_FALSE(resource);
  EXPECT_EQ(resource.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(resource.error().message, HasSubstr("unknown observer 'hsv-1', did you mean 'hvs-1'?"));
  EXPECT_THAT(resource.error().message, HasSubstr("'human-like-1', 'hvs-1'"));
}

TEST(Resources, EveryShippedDescriptionReadsAndIsCalledAsItsFile) {
  for (const std::string& name : resource_names(ResourceKind::sensor)) {
    const auto sensor = load_sensor(name);
    ASSERT_TRUE(sensor) << sensor.error().message;
    EXPECT_EQ(sensor->name, name);
  }
  for (const std::string& name : resource_names(ResourceKind::observer)) {
    const auto observer = parse_observer(find_resource(ResourceKind::observer, name).value());
    ASSERT_TRUE(observer) << observer.error().message;
    EXPECT_EQ(observer->name, name);
  }
  for (const std::string& name : resource_names(ResourceKind::plate)) {
    const auto plate = load_plate(name);
    ASSERT_TRUE(plate) << plate.error().message;
    EXPECT_EQ(plate->name, name);
  }
}

TEST(Sensor, Sc2000HasTheValuesOfTheEoVistaTable) {
  const Result<SensorSpec> sensor = load_sensor("sc2000");

  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->width, 320);
  EXPECT_EQ(sensor->height, 240);
  EXPECT_EQ(sensor->pitch_um, 47.5);
  EXPECT_EQ(sensor->detector_um, 42.5);
  EXPECT_EQ(sensor->focal_length_mm, 36.3);
  EXPECT_EQ(sensor->f_number, 1);
  EXPECT_EQ(sensor->wavelength_min_um, 7.5);
  EXPECT_EQ(sensor->wavelength_max_um, 13.0);
  EXPECT_EQ(sensor->optics_transmission, 0.8);
  EXPECT_EQ(sensor->frame_rate_hz, 50);
  EXPECT_EQ(sensor->netd_k, 0.07);
  EXPECT_NEAR(sensor->ifov_mrad(), 1.3085, 5e-5);  // the published figure has four decimals
  EXPECT_EQ(sensor->microscan, 1);
}

TEST(Sensor, ADetectorLargerThanThePitchIsRefusedWithTheFile) {
  std::string text(find_resource(ResourceKind::sensor, "sc2000")->text);
  text.replace(text.find("42.5"), 4, "48.0");

  const Result<SensorSpec> sensor = parse_sensor({"mine.toml", text});

  ASSERT_FALSE(sensor);
  EXPECT_EQ(sensor.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(sensor.error().message, HasSubstr("mine.toml: "));
  EXPECT_THAT(sensor.error().message, HasSubstr("detector_um"));
}

TEST(Sensor, AMissingOrMisspeltParameterIsRefusedWithItsLine) {
  const std::string text(find_resource(ResourceKind::sensor, "sc2000")->text);
  std::string without = text;
  without.erase(without.find("netd_k"), without.find('\n', without.find("netd_k")) - without.find("netd_k"));
  std::string misspelt = text;
  misspelt.replace(misspelt.find("netd_k"), 6, "ntd_k ");

  EXPECT_THAT(parse_sensor({"s.toml", without}).error().message, HasSubstr("s.toml:1: missing key 'netd_k'"));
  EXPECT_THAT(parse_sensor({"s.toml", misspelt}).error().message,
              HasSubstr("unknown key 'ntd_k', did you mean 'netd_k'?"));
}

/// Text of the parameter that the key sets.
std::string value_text(const SensorSpec& spec, const SensorKey& key) {
  if (const auto* number = std::get_if<double SensorSpec::*>(&key.member)) return std::to_string(spec.**number);
  if (const auto* whole = std::get_if<int SensorSpec::*>(&key.member)) return std::to_string(spec.**whole);
  return '"' + std::string(to_string(spec.*std::get<DisplayReconstruction SensorSpec::*>(key.member))) + '"';
}

/// A sensor file of all required keys, with `text` for one key; nothing: without it.
std::string file_with(std::string_view name, const std::optional<std::string>& text) {
  std::string file = "name = \"s\"\n";
  for (const SensorKey& key : sensor_keys()) {
    if (key.name == name) {
      if (text) file += std::string(name) + " = " + *text + "\n";
    } else if (key.presence == KeyPresence::required) {
      file += std::string(key.name) + " = " + value_text(SensorSpec{}, key) + "\n";
    }
  }
  return file;
}

TEST(Sensor, EveryKeyIsReadIsRequiredOrHasItsDefaultAndKeepsItsRange) {
  for (const SensorKey& key : sensor_keys()) {
    const std::string name(key.name);
    const auto absent = parse_sensor({"s.toml", file_with(name, std::nullopt)});
    if (key.presence == KeyPresence::required) {
      EXPECT_THAT(absent.error().message, HasSubstr("missing key '" + name + "'"));
    } else {
      EXPECT_EQ(value_text(absent.value(), key), value_text(SensorSpec{}, key)) << name;
    }
    const bool is_word = std::holds_alternative<DisplayReconstruction SensorSpec::*>(key.member);
    const auto wrong = parse_sensor({"s.toml", file_with(name, is_word ? "\"mirror\"" : "-1e300")});
    if (key.range.low > -1e300 || is_word) {
      EXPECT_THAT(wrong.error().message, HasSubstr("'" + name + "'"));
    }
  }
}

TEST(Sensor, EveryKeyIsInTheDocument) {
  const std::string document = testing::content_of(source_file("docs/method/sensor-model.md"));

  for (const SensorKey& key : sensor_keys()) EXPECT_THAT(document, HasSubstr("`" + std::string(key.name) + "`"));
  for (const Effect effect : all_effects)
    EXPECT_THAT(document, HasSubstr("| `" + std::string(to_string(effect)) + "`"));
}

TEST(ObserverFile, Hvs1IsTheDefaultOfTheStruct) {
  EXPECT_EQ(load_observer("hvs-1").value(), TemplateObserverSpec{});
}

TEST(ObserverFile, Hvs2HasTheDefaultEye) {
  const auto observer = parse_observer(find_resource(ResourceKind::observer, "hvs-2").value());

  ASSERT_TRUE(observer) << observer.error().message;
  EXPECT_EQ(observer->eye, EyeParameters{});
  EXPECT_EQ(observer->internal_noise, 0);
  EXPECT_EQ(observer->sensor_noise_factor, 1.75);
  EXPECT_EQ(observer->window_margin_arcmin, 6);
}

TEST(ObserverFile, HumanLike1DiffersInBlurInternalNoiseAndSensorNoiseOnly) {
  TemplateObserverSpec expected;
  expected.name = "human-like-1";
  expected.blur_sigma_samples = 0.5;
  expected.internal_noise = 0.025;
  expected.sensor_noise_factor = 1.75;

  EXPECT_EQ(load_observer("human-like-1").value(), expected);
}

TEST(PlateFile, RowsBecomeTrianglesWithPlacesApexesAndNames) {
  const Result<TargetPlate> plate = parse_plate({"small.toml", small_plate});

  ASSERT_TRUE(plate) << plate.error().message;
  EXPECT_EQ(plate->name, "small");
  EXPECT_EQ(plate->width_mm, 100);
  EXPECT_EQ(plate->height_mm, 80);
  ASSERT_EQ(plate->triangles.size(), 3u);
  EXPECT_EQ(plate->triangles[1].name, "row 1, triangle 2");
  EXPECT_EQ(plate->triangles[1].position_mm, cv::Point2d(25, -20));
  EXPECT_EQ(plate->triangles[1].size_mm, 10);
  EXPECT_EQ(plate->triangles[1].apex, Apex::left);
  EXPECT_EQ(plate->triangles[2].name, "the small one");
  EXPECT_EQ(plate->triangles[2].apex, Apex::down);
}

TEST(PlateFile, MistakesAreNamedWithTheirLine) {
  const auto with = [](std::string_view old, std::string_view replacement) {
    std::string text = small_plate;
    text.replace(text.find(old), old.size(), replacement);
    const auto plate = parse_plate({"p.toml", text});
    return plate ? std::string() : plate.error().message;
  };

  EXPECT_EQ(with("[\"up\", \"left\"]", "[\"up\", \"lfet\"]"),
            "p.toml:8: key 'apex' in [row]: expected one of 'up', 'right', 'down', 'left', found \"lfet\", did you "
            "mean 'left'?");
  EXPECT_EQ(with("[\"up\", \"left\"]", "[\"up\"]"),
            "p.toml:8: key 'apex' in [row]: expected 2 values as in x_mm, found 1");
  EXPECT_EQ(with("size_mm = 5", "size_mm = 0"),
            "p.toml:10: key 'size_mm' in [row]: expected a number from 0.02 to 10000, found 0");
  EXPECT_THAT(with("x_mm = [-25, 25]", "x_mm = [-25, 47]"),
              HasSubstr("p.toml: "));  // base 4.4 mm right of the centroid: leaves the plate
}

TEST(PlateFile, RectanglesAreReadWithTheirTurn) {
  const auto plate = parse_plate({"e.toml",
                                  "name = \"e\"\nwidth_mm = 100\nheight_mm = 80\n[[rectangle]]\nx_mm = 1\n"
                                  "y_mm = 2\nwidth_mm = 20\nheight_mm = 10\nangle_deg = 5\n"});

  ASSERT_TRUE(plate) << plate.error().message;
  ASSERT_EQ(plate->rectangles.size(), 1u);
  EXPECT_TRUE(plate->triangles.empty());
  EXPECT_EQ(plate->rectangles[0].name, "rectangle 1");
  EXPECT_EQ(plate->rectangles[0].position_mm, cv::Point2d(1, 2));
  EXPECT_EQ(plate->rectangles[0].size_mm, cv::Size2d(20, 10));
  EXPECT_EQ(plate->rectangles[0].angle_deg, 5);
}

TEST(PlateFile, BarsAreReadAsGroupsOfFourAcrossTheirAxis) {
  const auto plate = parse_plate({"b.toml",
                                  "name = \"b\"\nwidth_mm = 100\nheight_mm = 80\n[[bars]]\nx_mm = 1\ny_mm = 2\n"
                                  "bar_mm = 2\nlength_mm = 20\naxis = \"y\"\n"});

  ASSERT_TRUE(plate) << plate.error().message;
  ASSERT_EQ(plate->bars.size(), 1u);
  const auto cut_outs = straight_cut_outs(*plate);
  ASSERT_EQ(cut_outs.size(), 4u);
  EXPECT_EQ(cut_outs[0].name, "bars 1, bar 1");
  EXPECT_NEAR(cut_outs[0].position_mm.y, 2 - 6, 1e-12);
  EXPECT_NEAR(cut_outs[3].position_mm.y, 2 + 6, 1e-12);
  EXPECT_NEAR(cut_outs[0].position_mm.x, 1, 1e-12);
  // Seen in a mirror a group that is turned is turned the other way.
  TargetPlate turned = *plate;
  turned.bars[0].angle_deg = 96;
  const TargetPlate mirrored = mounted(turned, Mounting::mirrored_horizontally);
  EXPECT_EQ(mirrored.bars[0].position_mm.x, -1);
  EXPECT_EQ(mirrored.bars[0].angle_deg, -96);
  for (const char* wrong :
       {"bar_mm = 0\nlength_mm = 20\naxis = \"y\"", "bar_mm = 2\nlength_mm = 20\naxis = \"z\"",
        "bar_mm = 9\nlength_mm = 20\naxis = \"x\"\nangle_deg = 60", "bar_mm = 20\nlength_mm = 20\naxis = \"x\""}) {
    EXPECT_FALSE(parse_plate({"b.toml", std::string("name = \"b\"\nwidth_mm = 100\nheight_mm = 80\n[[bars]]\n"
                                                    "x_mm = 1\ny_mm = 2\n") +
                                            wrong + "\n"}))
        << wrong;
  }
}

TEST(PlateFile, IsFoundByItsPath) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.write("small.toml", small_plate);

  EXPECT_EQ(load_plate(file.string()).value().name, "small");
  EXPECT_THAT(load_plate((folder.path() / "other.toml").string()).error().message,
              HasSubstr("other.toml: no such file"));
}

}  // namespace
}  // namespace todbench
