// SPDX-License-Identifier: GPL-3.0-or-later
// The Aravis back end and the GigE Vision camera on plain sockets: discovery, exposures, chunks, addresses.
#include <arv.h>
#include <gmock/gmock.h>

#include <chrono>

#include "acquisition/aravis/glib_ptr.h"
#include "tests/acquisition/aravis/gvsp_passages.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

TEST(GvspCamera, IsFoundByDiscovery) {
  const auto camera = start_gvsp_camera({});

  const auto cameras = aravis_backend()->list();

  ASSERT_TRUE(cameras && cameras->size() == 1);
  EXPECT_EQ(cameras->front().id, "gige:FLIR-TB0002");
  EXPECT_EQ(cameras->front().model, "AX5");
}

TEST(GvspCamera, SendsItsExposuresByteForByte) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  // 200 frames pass the wrap of the 16-bit block id.
  const Received got = receive(*source, config, 200);

  EXPECT_EQ(got.complete, 200);
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_EQ(got.gaps, 0);
}

class PackedPixels : public testing::TestWithParam<PixelFormat> {};

std::string packed_name(const testing::TestParamInfo<PixelFormat>& info) {
  return std::string(to_string(info.param));
}
INSTANTIATE_TEST_SUITE_P(Gvsp, PackedPixels,
                         testing::Values(PixelFormat::mono10p, PixelFormat::mono12p, PixelFormat::mono10_packed,
                                         PixelFormat::mono12_packed),
                         packed_name);

// 159 pixels of 10 bits do not fill whole bytes: rows of a picture without padding then share a byte.
TEST_P(PackedPixels, OfACameraThatOffersNothingElseAreItsExposures) {
  for (const int width : {160, 159}) {
    auto config = quick(CameraModel::unlisted);
    config.width = width;
    config.only_format = GetParam();
    config.significant_bits = significant_bits(GetParam());
    const auto camera = start_gvsp_camera(config);
    const auto source = open_started();
    ASSERT_TRUE(source);

    const Received got = receive(*source, config, 10);

    EXPECT_EQ(source->info().pixel_format, to_string(GetParam()));
    EXPECT_EQ(source->info().significant_bits, significant_bits(GetParam()));
    EXPECT_EQ(got.complete, 10) << width;
    EXPECT_EQ(got.false_pixels, 0) << width;
  }
}

TEST(GvspCamera, SendsChunksThatAravisUnderstands) {
  const auto camera = start_gvsp_camera(quick());
  GErrorSlot error;
  const GObjectPtr<ArvCamera> client(arv_camera_new("127.0.0.1", error.out()));
  ASSERT_TRUE(client) << error.message();
  arv_camera_gv_set_stream_options(client.get(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  arv_camera_set_string(client.get(), "PixelFormat", "Mono14", nullptr);
  arv_camera_set_string(client.get(), "ChunkModeActive", "On", error.out());
  ASSERT_FALSE(error) << error.message();
  const GObjectPtr<ArvStream> stream(arv_camera_create_stream(client.get(), nullptr, nullptr, error.out()));
  ASSERT_TRUE(stream) << error.message();
  const auto payload = arv_camera_get_payload(client.get(), nullptr);
  for (int i = 0; i < 4; ++i) arv_stream_push_buffer(stream.get(), arv_buffer_new_allocate(payload));
  const GObjectPtr<ArvChunkParser> parser(arv_camera_create_chunk_parser(client.get()));
  arv_camera_start_acquisition(client.get(), nullptr);

  const GObjectPtr<ArvBuffer> buffer(arv_stream_timeout_pop_buffer(stream.get(), 20000000));

  ASSERT_TRUE(buffer);
  ASSERT_EQ(arv_buffer_get_status(buffer.get()), ARV_BUFFER_STATUS_SUCCESS);
  ASSERT_TRUE(arv_buffer_has_chunks(buffer.get()));
  EXPECT_EQ(arv_chunk_parser_get_integer_value(parser.get(), buffer.get(), "ChunkExposureIndex", error.out()), 0);
  EXPECT_FALSE(error) << error.message();
  EXPECT_NEAR(arv_chunk_parser_get_float_value(parser.get(), buffer.get(), "ChunkSensorTemperature", error.out()), 31.2,
              1e-6);
  EXPECT_FALSE(error) << error.message();
}

TEST(GvspCamera, RefusesAnAddressThatAnotherCameraHas) {
  const auto first = start_gvsp_camera({});
  GvspCameraConfig config;
  config.serial = "TB0003";

  const auto second = GvspCamera::start(config, gvsp_test_exposures(config));

  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("busy"));
}

}  // namespace
}  // namespace todbench
