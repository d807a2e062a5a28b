// SPDX-License-Identifier: GPL-3.0-or-later
// GigE Vision cameras whose description would end, fill or stop the program: the real back end refuses each with a
// sentence.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <chrono>
#include <stop_token>

#include "tests/acquisition/description/hostile_descriptions.h"
#include "tests/support/gvsp_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

/// Resident memory at its largest since the process began; sanitizers need more for themselves.
[[maybe_unused]] long most_resident_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

std::string own_description(CameraModel model = CameraModel::ax5) {
  return genicam_xml(describe_camera(model, {}).genicam);
}

GvspCameraConfig with_url(const std::string& url) {
  GvspCameraConfig config;
  config.description_url = url;
  return config;
}

GvspCameraConfig with_description(std::string description) {
  GvspCameraConfig config;
  config.description = std::move(description);
  return config;
}

/// The same, zipped.
GvspCameraConfig with_archive(std::string archive) {
  GvspCameraConfig config = with_url(fmt::format("Local:camera.zip;100000;{:X}", archive.size()));
  config.description = std::move(archive);
  return config;
}

/// The refusal of a camera; fails the test where it is opened.
Error refusal(const GvspCameraConfig& config, const AravisOptions& options = {}) {
  const auto camera = start_gvsp_camera(config);
  const auto source = aravis_backend(options)->open("gige:127.0.0.1");
  EXPECT_FALSE(source);
  EXPECT_FALSE(camera && camera->controlled());
#ifndef TODBENCH_SANITIZED
  EXPECT_LT(most_resident_mib(), 1024);
#endif
  return source ? Error{} : source.error();
}

class HostileCamera : public testing::TestWithParam<HostileDescription> {};

TEST_P(HostileCamera, IsRefusedWithASentence) {
  const Error error = refusal(with_description(with_hostile_nodes(own_description(), GetParam())));

  EXPECT_EQ(error.code, ErrorCode::not_found);
  EXPECT_THAT(error.message, HasSubstr(GetParam().says));
  EXPECT_THAT(error.message, HasSubstr("the camera's description is rejected"));
}

INSTANTIATE_TEST_SUITE_P(Descriptions, HostileCamera, testing::ValuesIn(hostile_descriptions()),
                         [](const auto& row) { return row.param.name; });

TEST(HostileUrl, OfADeviceOfTheHostIsRefused) {
  const Error error = refusal(with_url("File:///dev/zero"));

  EXPECT_EQ(error.code, ErrorCode::not_found);
  EXPECT_THAT(error.message, HasSubstr("not a regular file"));
}

TEST(HostileUrl, OfAnotherHostIsRefused) {
  const Error error = refusal(with_url("http://127.0.0.1/camera.xml"));

  EXPECT_EQ(error.code, ErrorCode::not_found);
  EXPECT_THAT(error.message, HasSubstr("only descriptions stored in the camera or in a file"));
}

TEST(HostileArchive, ThatUnpacksToMoreThanItStatesIsRefused) {
  const std::string zeros(std::size_t{20} << 20U, ' ');

  EXPECT_THAT(refusal(with_archive(zip_archive(zeros))).message, HasSubstr("at most"));
  EXPECT_THAT(refusal(with_archive(zip_archive(zeros, 4000000000U))).message, HasSubstr("at most"));
  EXPECT_THAT(refusal(with_archive(zip_archive(zeros, 1U << 20U))).message, HasSubstr("differs from the size"));
  EXPECT_THAT(refusal(with_archive("PK\5\6" + std::string(40, '\xFF'))).message, HasSubstr("zipped description"));
}

TEST(ZippedCamera, IsOpened) {
  const auto camera = start_gvsp_camera(with_archive(zip_archive(own_description())));

  const auto source = open_camera();

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().settings.at("CameraFamily"), "FLIR Ax5");
}

TEST(SlowDescription, IsToldOfAndGivenUpInTime) {
  GvspCameraConfig config;
  config.memory_delay = 100ms;
  std::vector<std::string> said;
  AravisOptions options{.description_patience = 2500ms};
  options.on_progress = [&](std::string_view sentence) { said.emplace_back(sentence); };

  const Error error = refusal(config, options);

  EXPECT_EQ(error.code, ErrorCode::not_found);
  EXPECT_THAT(error.message, HasSubstr("bytes in 2 s"));
  ASSERT_FALSE(said.empty());
  EXPECT_THAT(said.front(), HasSubstr("reading the camera's description: "));
}

TEST(SlowDescription, IsNotWaitedForOnAStopRequest) {
  GvspCameraConfig config;
  config.memory_delay = 100ms;
  std::stop_source stop;
  AravisOptions options;
  options.stop = stop.get_token();
  options.on_progress = [&](std::string_view) { stop.request_stop(); };

  EXPECT_EQ(refusal(config, options).code, ErrorCode::interrupted);
}

TEST(UnreadableFeature, OfAGoodCameraIsLeftAlone) {
  // The description is good but for a feature that depends on what does not exist, and one whose length only the camera
  // knows: 4000000000 bytes.
  std::string xml = own_description();
  const std::string port = "<pPort>Device</pPort>";
  xml.insert(
      xml.find("</RegisterDescription>"),
      "<Integer Name=\"Dangling\"><pValue>Nowhere</pValue></Integer>"
      "<IntReg Name=\"LengthRegister\"><Address>0xE980</Address><Length>4</Length><Endianess>BigEndian</Endianess>" +
          port +
          "</IntReg>"
          "<IntSwissKnife Name=\"Immense\"><pVariable Name=\"V\">LengthRegister</pVariable>"
          "<Formula>V * 2000000000</Formula></IntSwissKnife>"
          "<StringReg Name=\"LongText\"><Address>0x48</Address><pLength>Immense</pLength>" +
          port +
          "</StringReg>"
          "<StringReg Name=\"Text\"><Address>0x48</Address><pLength>Small</pLength>" +
          port +
          "</StringReg>"
          "<IntSwissKnife Name=\"Small\"><pVariable Name=\"V\">LengthRegister</pVariable>"
          "<Formula>(V * 0) + 8</Formula></IntSwissKnife>"
          "<IntReg Name=\"Wide\"><Address>0xE980</Address><Length>8</Length>" +
          port +
          "</IntReg>"
          "<IntSwissKnife Name=\"Trapping\"><pVariable Name=\"V\">Wide</pVariable>"
          "<Formula>(V | (1 &lt;&lt; 63)) / ((V * 0) - 1)</Formula></IntSwissKnife>");
  const auto camera = start_gvsp_camera(with_description(xml));

  const auto source = open_camera();

  ASSERT_TRUE(source);
  EXPECT_THAT(source->get("Dangling").error().message, HasSubstr("Nowhere, which does not exist"));
  EXPECT_THAT(source->get("LongText").error().message, HasSubstr("its length is 4000000000 bytes"));
  EXPECT_THAT(source->get("Trapping").error().message, HasSubstr("divide the smallest integer"));
  EXPECT_EQ(source->get("Text").value_or(""), "FLIR");
}

}  // namespace
}  // namespace todbench
