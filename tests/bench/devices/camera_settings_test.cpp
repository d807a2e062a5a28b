// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that takes a setting and has another.
#include "bench/devices/camera_settings.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SettingsOnly final : public FrameSource {
 public:
  explicit SettingsOnly(std::map<std::string, std::string> settings) { info_.settings = std::move(settings); }

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  [[nodiscard]] Result<Frame> next(std::chrono::milliseconds /*timeout*/) override {
    return fail(ErrorCode::timeout, "sends no frames");
  }
  void stop() override {}
  [[nodiscard]] Result<std::string> get(const std::string& feature) override {
    const auto found = info_.settings.find(feature);
    if (found == info_.settings.end()) return fail(ErrorCode::invalid_input, "no feature " + feature);
    return found->second;
  }
  [[nodiscard]] Result<void> set(const std::string& feature, const std::string& value) override {
    info_.settings[feature] = value;
    return {};
  }
  [[nodiscard]] Result<void> correct_nonuniformity() override { return {}; }

 private:
  SourceInfo info_;
};

TEST(CameraSettings, ThatScaleCountsAndReadBackOtherwiseEndTheRun) {
  SettingsOnly camera({{"SensorGainMode", "HighGain"}, {"CurrentCase", "2"}, {"TemperatureLinearMode", "Off"}});
  for (const auto& [feature, value] : std::map<std::string, std::string>{
           {"SensorGainMode", "LowGain"}, {"CurrentCase", "0"}, {"TemperatureLinearMode", "On"}}) {
    const auto checked = check_written_settings(camera, {{feature, value}});
    ASSERT_FALSE(checked) << feature;
    EXPECT_EQ(checked.error().code, ErrorCode::calibration);
    EXPECT_THAT(checked.error().message, HasSubstr(feature + " was set to " + value));
  }
}

TEST(CameraSettings, OfAnotherKindThatReadBackOtherwiseAreAWarning) {
  SettingsOnly camera(std::map<std::string, std::string>{{"NUCMode", "Automatic"}});
  const auto checked = check_written_settings(camera, {{"NUCMode", "Off"}});
  ASSERT_TRUE(checked);
  EXPECT_THAT(*checked, ElementsAre(HasSubstr("NUCMode was set to Off and reads back as Automatic")));
}

TEST(CameraSettings, ThatADeviceWritesInItsOwnWayAreTheSame) {
  SettingsOnly camera({{"ExposureTime", "9999.5"}, {"GainAuto", "false"}, {"IRFormat", "radiometric"}});
  const auto checked = check_written_settings(
      camera, {{"ExposureTime", "10000"}, {"GainAuto", "0"}, {"IRFormat", "Radiometric"}, {"NUCAction", "1"}});
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_THAT(*checked, IsEmpty());
}

TEST(CameraSettings, ThatChangedDuringARunAreNamed) {
  SettingsOnly camera({{"SensorGainMode", "HighGain"}, {"DeviceTemperature", "31.2"}, {"NUCMode", "Off"}});
  const SourceInfo at_start = camera.info();
  EXPECT_THAT(changed_settings(camera, at_start), IsEmpty());
  ASSERT_TRUE(camera.set("SensorGainMode", "LowGain"));
  ASSERT_TRUE(camera.set("DeviceTemperature", "33"));
  ASSERT_TRUE(camera.set("NUCMode", "Manual"));
  const auto changed = changed_settings(camera, at_start);
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_TRUE(scales_counts(changed.front().feature));
  EXPECT_EQ(sentence(changed.front()), "SensorGainMode was HighGain at the start and is LowGain at the end");
}

}  // namespace
}  // namespace todbench
