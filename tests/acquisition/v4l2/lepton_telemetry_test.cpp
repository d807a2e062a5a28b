// SPDX-License-Identifier: GPL-3.0-or-later
// What the telemetry rows of a Lepton say.
#include "acquisition/v4l2/lepton_telemetry.h"

#include <gmock/gmock.h>

#include <vector>

namespace todbench {
namespace {

/// Words as a Lepton 3.5 with firmware 3.x sends them, put down by word number from the data sheet.
std::vector<std::uint16_t> words() {
  std::vector<std::uint16_t> w(240, 0);
  w[0] = 0x0E0D;              // revision
  w[1] = 0x86A0, w[2] = 1;    // 100 000 ms
  w[3] = 0x0028, w[4] = 0;    // bit 3: desired, bits 4-5 = 2: in progress
  w[20] = 7, w[21] = 0;       // frame counter
  w[24] = 30315;              // 303.15 K
  w[29] = 30200;              // 302.00 K at the last correction
  w[30] = 0x1170, w[31] = 1;  // 70 000 ms
  w[160 + 48] = 1;            // TLinear on
  w[160 + 49] = 1;            // 0.01 K
  return w;
}

TEST(LeptonTelemetry, IsReadByWordNumber) {
  const auto telemetry = parse_lepton_telemetry(words());

  ASSERT_TRUE(telemetry);
  EXPECT_EQ(telemetry->time_ms, 100000U);
  EXPECT_EQ(telemetry->ffc_state(), FfcState::in_progress);
  EXPECT_FALSE(telemetry->agc());
  EXPECT_EQ(telemetry->frame_counter, 7U);
  EXPECT_DOUBLE_EQ(telemetry->fpa_temperature_k, 303.15);
  EXPECT_DOUBLE_EQ(telemetry->fpa_temperature_ffc_k, 302);
  EXPECT_EQ(telemetry->since_ffc_s(), 30.0);
  EXPECT_EQ(telemetry->kelvin_per_count, 0.01);
}

TEST(LeptonTelemetry, HasNoScaleWithoutLinearTemperature) {
  auto w = words();
  w[160 + 48] = 0;

  EXPECT_EQ(parse_lepton_telemetry(w)->kelvin_per_count, std::nullopt);
}

TEST(LeptonTelemetry, ReadsTheCoarseScale) {
  auto w = words();
  w[160 + 49] = 0;

  EXPECT_EQ(parse_lepton_telemetry(w)->kelvin_per_count, 0.1);
}

TEST(LeptonTelemetry, TellsTheTimeSinceACorrectionAcrossAWrapOfItsClock) {
  auto w = words();
  w[1] = 500, w[2] = 0;
  w[30] = 0xFFFF, w[31] = 0xFFFF;  // 1 ms before the wrap

  EXPECT_DOUBLE_EQ(*parse_lepton_telemetry(w)->since_ffc_s(), 0.501);
}

TEST(LeptonTelemetry, KnowsNoTimeBeforeTheFirstCorrection) {
  auto w = words();
  w[3] = 0;

  EXPECT_EQ(parse_lepton_telemetry(w)->since_ffc_s(), std::nullopt);
}

TEST(LeptonTelemetry, ReadsTheStatusBitsOfBothWords) {
  auto w = words();
  w[3] = 1U << 12U | 1U << 15U;
  w[4] = 1U << 4U;

  const auto telemetry = parse_lepton_telemetry(w);

  EXPECT_TRUE(telemetry->agc());
  EXPECT_EQ(telemetry->status, 1U << 12U | 1U << 15U | 1U << 20U);
}

TEST(LeptonTelemetry, IsNotReadFromRowsOfNothing) {
  EXPECT_EQ(parse_lepton_telemetry(std::vector<std::uint16_t>(240, 0)), std::nullopt);
  EXPECT_EQ(parse_lepton_telemetry(std::vector<std::uint16_t>(240, 0xFFFF)), std::nullopt);
  EXPECT_EQ(parse_lepton_telemetry(std::vector<std::uint16_t>(239, 0x0E0D)), std::nullopt);
  EXPECT_EQ(parse_lepton_telemetry({}), std::nullopt);
}

TEST(LeptonTelemetry, EncodingIsTheInverse) {
  const auto telemetry = parse_lepton_telemetry(words()).value();

  EXPECT_EQ(parse_lepton_telemetry(encode_lepton_telemetry(telemetry)), telemetry);
}

TEST(LeptonTelemetry, FillsThreeRowsOfALepton2AndTwoOfALepton3) {
  EXPECT_EQ(lepton_telemetry_rows(80), 3);
  EXPECT_EQ(lepton_telemetry_rows(160), 2);
  EXPECT_EQ(lepton_telemetry_rows(0), 0);
}

}  // namespace
}  // namespace todbench
