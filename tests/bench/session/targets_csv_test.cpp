// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/targets_csv.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/bench/session/trial_values.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

class TargetsCsv : public ::testing::Test {
 protected:
  void write(const std::vector<Presentation>& presentations) const {
    Result<TargetsWriter> writer = TargetsWriter::create(file_);
    ASSERT_TRUE(writer) << writer.error().message;
    for (const Presentation& shown : presentations) ASSERT_TRUE(writer->append(shown));
  }
  /// The file after its one row was changed; the sentence that refuses it.
  [[nodiscard]] std::string refused(const std::string& from, const std::string& to) const {
    write({testing::full_presentation()});
    std::string text = testing::content_of(file_);
    text.replace(text.find(from), from.size(), to);
    (void)folder_.write("targets.csv", text);
    const auto read = read_targets(file_);
    return read ? "accepted" : read.error().message;
  }
  testing::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "targets.csv";
};

TEST_F(TargetsCsv, EveryValueComesBackExactly) {
  Presentation silent = testing::full_presentation();
  silent.said.plate_temperature_k.reset();
  silent.said.black_body_temperature_k.reset();
  silent.delta_t_k.reset();
  silent.host_time_ns.reset();
  silent.air_transmittance = 0.98765432109876543;
  silent.delta_t_se_k = 0.0012345678901234567;
  silent.reference_triangles = 4;
  silent.asked_px = cv::Point2d(159.80000000000001, 127.25);
  silent.seen_px = cv::Point2d(160.10000000000002, 127.5);
  silent.seen_error_px = 0.012345678901234567;
  const std::vector<Presentation> presentations{testing::full_presentation(), silent};

  write(presentations);

  const auto back = read_targets(file_);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(*back, presentations);
}

TEST_F(TargetsCsv, TheHeaderStatesTheUnits) {
  write({});

  EXPECT_EQ(testing::content_of(file_),
            "presentation,plate,mounting,set_delta_t_k,reached_delta_t_k,delta_t_k,plate_temperature_k,"
            "black_body_temperature_k,settling_s,host_time_ns,set_shift_x_mm,set_shift_y_mm,reached_plate,"
            "reached_mounting,reached_shift_x_mm,reached_shift_y_mm,air_transmittance,delta_t_se_k,"
            "reference_triangles,asked_x_px,asked_y_px,seen_x_px,seen_y_px,seen_error_px\n");
}

TEST_F(TargetsCsv, OfAnEarlierVersionHasNoErrorOfTheContrastAndOfAYetEarlierNoAir) {
  Presentation shown = testing::full_presentation();
  shown.air_transmittance = 0.994;
  shown.delta_t_se_k = 0.0071;
  shown.reference_triangles = 5;
  write({shown});
  std::string text = testing::content_of(file_);
  const auto without = [&](std::initializer_list<std::string> columns) {
    for (const std::string& column : columns) text.erase(text.find(column), column.size());
    (void)folder_.write("targets.csv", text);
    return read_targets(file_);
  };

  const auto without_place = without({",asked_x_px,asked_y_px,seen_x_px,seen_y_px,seen_error_px", ",,,,,"});
  const auto with_air = without({",delta_t_se_k,reference_triangles", ",0.0071,5"});
  const auto with_neither = without({",air_transmittance", ",0.994"});

  ASSERT_TRUE(without_place) << without_place.error().message;
  EXPECT_EQ(*without_place, std::vector{shown});
  ASSERT_TRUE(with_air) << with_air.error().message;
  shown.delta_t_se_k.reset();
  shown.reference_triangles = 0;
  EXPECT_EQ(*with_air, std::vector{shown});
  ASSERT_TRUE(with_neither) << with_neither.error().message;
  EXPECT_EQ(*with_neither, std::vector{testing::full_presentation()});
}

TEST_F(TargetsCsv, WhatATargetSaysThatIsNoNumberIsEmpty) {
  Presentation odd = testing::full_presentation();
  odd.said.state.delta_t_k = std::nan("");

  write({odd});

  const auto back = read_targets(file_);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(std::isnan(back->front().said.state.delta_t_k));
}

TEST_F(TargetsCsv, RefusesWhatItDidNotWriteWithTheLine) {
  EXPECT_THAT(refused("settling_s", "settling_ms"), HasSubstr("targets.csv:1: column 9: expected settling_s, found"));
  EXPECT_THAT(refused("-1.93", ""), HasSubstr("targets.csv:2: column set_delta_t_k: expected a finite number"));
  EXPECT_THAT(refused("rotated_180", "upside down"), HasSubstr("targets.csv:2: column mounting: expected a mounting"));
  EXPECT_THAT(refused("123456789012345", "1.5"), HasSubstr("column host_time_ns: expected a whole number"));
}

TEST_F(TargetsCsv, ASetPointThatIsNotFiniteIsADefect) {
  Result<TargetsWriter> writer = TargetsWriter::create(file_);
  ASSERT_TRUE(writer) << writer.error().message;
  Presentation odd = testing::full_presentation();
  odd.set.delta_t_k = std::nan("");

  const auto appended = writer->append(odd);

  ASSERT_FALSE(appended);
  EXPECT_EQ(appended.error().code, ErrorCode::internal);
}

}  // namespace
}  // namespace todbench
