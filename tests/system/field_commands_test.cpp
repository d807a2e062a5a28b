// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges, pictures, identification, MRTD and test pictures as a user runs them.
#include <sys/stat.h>

#include <cmath>
#include <sstream>
#include <tuple>

#include "acquisition/recording/picture_file.h"
#include "acquisition/recording/tiff_writer.h"
#include "bench/picture_files/encoded_picture.h"
#include "bench/plan/descriptions.h"
#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

TEST(RangeCommand, FindsTheClosedFormsOfAcquireAndTtpOnGivenCurves) {
  const TemporaryFolder folder;
  std::ostringstream mrtd, ctf;
  mrtd.precision(17);
  ctf.precision(17);
  mrtd << "frequency_per_mrad,mrtd_k\n0,0.01\n3," << 0.01 * std::exp(18.0) << "\n";
  ctf << "frequency_per_mrad,ctf\n0,0.01\n3," << 0.01 * std::exp(7.5) << "\n";
  folder.write("m.csv", mrtd.str());
  folder.write("c.csv", ctf.str());

  const Ended acquire = todbench({"range", "--size-m", "2.3", "--delta-t-k", "2", "--extinction-per-km", "0.2",
                                  "--mrtd", "m.csv", "--models", "acquire", "--n50", "1", "--json"},
                                 {.folder = folder.path()});
  const Ended ttp = todbench({"range", "--size-m", "3.11", "--delta-t-k", "2", "--extinction-per-km", "0.2", "--ctf",
                              "c.csv", "--target-contrast", "0.3", "--v50", "14.8", "--models", "ttp", "--json"},
                             {.folder = folder.path()});

  // tests/golden/reference_mrtd_ttp_shared.json.
  ASSERT_EQ(acquire.code, 0) << acquire.err;
  EXPECT_NEAR(one_object(acquire)["models"]["acquire"]["r50_m"].get<double>(), 1886.397824, 1e-5);
  ASSERT_EQ(ttp.code, 0) << ttp.err;
  EXPECT_NEAR(one_object(ttp)["models"]["ttp"]["r75_m"].get<double>(), 405.68794744, 1e-5);

  // Behind the air the display shows at most 1, also of a stated contrast: 5 is that of 100 K on a display of 10 K.
  const auto strong = [&](const std::vector<std::string>& contrast) {
    std::vector<std::string> words{"range", "--size-m", "3.11",  "--extinction-per-km",
                                   "0.2",   "--ctf",    "c.csv", "--v50",
                                   "14.8",  "--models", "ttp",   "--json"};
    words.insert(words.end(), contrast.begin(), contrast.end());
    return one_object(todbench(words, {.folder = folder.path()}))["models"]["ttp"]["r75_m"];
  };
  EXPECT_EQ(strong({"--delta-t-k", "2", "--target-contrast", "5"}), strong({"--delta-t-k", "100"}));
  EXPECT_TRUE(strong({"--delta-t-k", "2", "--target-contrast", "5"}).is_number());
}

/// Commands whose mathematics needs square pixels say so, and the others take the shape from the file.
TEST(UnlikePitches, AreRefusedBySentenceWhereTheyAreNotSupported) {
  const TemporaryFolder folder;
  folder.write("tall.toml", tall_sensor(42.5));
  const std::vector<std::vector<std::string>> refused{
      {"mrtd", "--sensor", "tall.toml"},
      {"dynamic", "--sensor", "tall.toml", "--speeds-mrad-s", "10"},
      {"identify", "small-craft", "--sensor", "tall.toml", "--ranges", "400,600"}};
  for (const auto& arguments : refused) {
    const Ended ended = todbench(arguments, {.folder = folder.path()});
    EXPECT_EQ(ended.code, 2) << arguments.front() << ": " << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("needs square pixels")) << arguments.front();
  }

  const Ended range =
      todbench({"range", "--sensor", "tall.toml", "--size-m", "2.3", "--delta-t-k", "2", "--models", "ttp"},
               {.folder = folder.path()});
  const Ended render =
      todbench({"render", "--sensor", "tall.toml", "--size-pitch", "3", "--json"}, {.folder = folder.path()});
  const Ended mtf =
      todbench({"mtf", "--sensor", "tall.toml", "--frequency-per-pitch", "0.3", "--json"}, {.folder = folder.path()});

  EXPECT_EQ(range.code, 3) << range.err;  // no model has a range
  EXPECT_THAT(range.out, HasSubstr("needs square pixels"));
  ASSERT_EQ(render.code, 0) << render.err;
  EXPECT_NEAR(one_object(render)["pitch_y_mrad"].get<double>(), 60 / 36.3, 1e-9);
  // The detector along y is as high as along x wide: at one frequency in space both axes are equal.
  ASSERT_EQ(mtf.code, 0) << mtf.err;
  EXPECT_NEAR(one_object(mtf)["system_y"][0].get<double>(), one_object(mtf)["system"][0].get<double>(), 1e-12);
}

TEST(RangeCommand, ReadsTheSessionThroughAirAndRefusesWhatIsNone) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(8));
  ASSERT_TRUE(completed(todbench({"simulate", "./plan.toml", "--out", "s"}, {.folder = folder.path()})));
  folder.write("unsorted.csv", "range_km,transmittance\n1,0.5\n0.5,0.7\n");
  folder.write("empty.csv", "");
  folder.write("short.csv", "range_m,tau\n10,0.99\n50,0.98\n");
  std::ostringstream table;
  table.precision(17);
  table << "range_km,transmittance\n";
  for (const double range_km : {0.01, 0.3, 40.0}) table << range_km << "," << std::exp(-0.3 * range_km) << "\n";
  folder.write("exponential.csv", table.str());
  const auto range = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"range", "--tod", "s", "--size-m", "4.9", "--delta-t-k", "20", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return todbench(arguments, {.folder = folder.path()});
  };

  const Json plain = one_object(range({}));
  const Json clear = one_object(range({"--atmosphere", "clear"}));
  const Json lambert = one_object(range({"--extinction-per-km", "0.3"}));
  const Json tabulated = one_object(range({"--atmosphere", "./exponential.csv"}));
  const Json all =
      one_object(range({"--atmosphere", "us-standard", "--models", "all", "--page", "p.html", "--svg", "p.svg"}));
  const Ended beyond = range({"--atmosphere", "./short.csv"});

  const Json grid = one_object(range({"--models", "all", "--grid-sizes-m", "2,4.9", "--grid-contrasts-k", "5,20",
                                      "--grid-ranges-m", "100,200,400"}))["grid"];

  ASSERT_EQ(grid["models"].size(), 4u);
  EXPECT_EQ(grid["models"]["acquire"]["probability"][1][1].size(), 3u);
  EXPECT_NEAR(grid["models"]["tod"]["r75_m"][1][1].get<double>() / plain["r75_m"].get<double>(), 1, 1e-9);
  expect_refused(range({"--grid-sizes-m", "2,4.9"}), 2, "--grid-contrasts-k");
  expect_refused(range({"--grid-sizes-m", "2", "--grid-contrasts-k", "0"}), 2, "no contrast");
  const Json own = one_object(range({"--m75", "5.1", "--m75-u-percent", "10"}));
  EXPECT_THAT(plain["m75_origin"].get<std::string>(), HasSubstr("people"));
  EXPECT_TRUE(plain["m75_ci95"].is_null());
  EXPECT_EQ(own["m75_origin"], "stated by the user");
  EXPECT_NEAR(own["m75_ci95"][0].get<double>(), 5.1 * std::exp(-0.195996), 1e-4);
  EXPECT_EQ(own["r75_m"], plain["r75_m"]);
  EXPECT_LT(own["r75_ci95_m"][0].get<double>(), plain["r75_ci95_m"][0].get<double>());
  EXPECT_EQ(own["models"]["tod"]["r75_ci95_m"], own["r75_ci95_m"]);
  EXPECT_EQ(clear["r75_m"], plain["r75_m"]);
  EXPECT_EQ(clear["curve"], plain["curve"]);
  EXPECT_EQ(plain["models"]["tod"]["r75_m"], plain["r75_m"]);
  EXPECT_NEAR(tabulated["r75_m"].get<double>() / lambert["r75_m"].get<double>(), 1, 1e-9);
  for (const char* name : {"tod", "acquire", "ttp", "mtdp"}) {
    EXPECT_TRUE(all["models"][name]["r75_m"].is_number()) << name;
    EXPECT_FALSE(all["models"][name]["criterion"]["origin"].get<std::string>().empty());
    EXPECT_FALSE(all["models"][name]["display"].get<std::string>().empty());
  }
  EXPECT_THAT(content_of(folder.path() / "p.html"), HasSubstr("ACQUIRE"));
  EXPECT_THAT(content_of(folder.path() / "p.html"), HasSubstr("M75: people, small craft"));
  EXPECT_EQ(occurrences(content_of(folder.path() / "p.html"), "judged by hvs-1"), 1);
  EXPECT_EQ(beyond.code, 3);
  EXPECT_TRUE(one_object(beyond)["r75_m"].is_null());
  EXPECT_EQ(one_object(beyond)["r75_ci95_m"][0], 50.0);
  expect_refused(range({"--atmosphere", "./unsorted.csv"}), 2, "must increase");
  expect_refused(range({"--atmosphere", "./empty.csv"}), 2, "empty");
  expect_refused(range({"--atmosphere", "us-standrd"}), 2, "us-standard");
  for (const auto& [option, value, sentence] :
       {std::tuple{"--background-k", "15", "from 150 to 2000, found '15'; is the value in degrees Celsius?"},
        {"--surround-k", "-60", "from 50 to 2000, found '-60'; is the value in degrees Celsius?"},
        {"--air-k", "20", "from 150 to 400, found '20'; is the value in degrees Celsius?"},
        {"--air-k", "0", "from 150 to 400"},
        {"--grid-sizes-m", "2300", "is the value in mm?"}})
    expect_refused(range({option, value}), 2, sentence);
  const Json weak = one_object(range({"--cn2", "1e-16"}));
  const Json strong = one_object(range({"--cn2", "1e-11", "--models", "all", "--page", "turbulent.html"}));
  EXPECT_THAT(content_of(folder.path() / "p.html"), Not(HasSubstr("1e-11")));
  EXPECT_THAT(content_of(folder.path() / "turbulent.html"), HasSubstr("1e-11"));
  EXPECT_EQ(weak["r75_m"], plain["r75_m"]);
  EXPECT_EQ(weak["turbulence"]["decision"], "skip");
  EXPECT_EQ(strong["turbulence"]["decision"], "simulate");
  for (const char* name : {"tod", "acquire", "ttp", "mtdp"}) {
    EXPECT_LT(strong["models"][name]["r75_m"].get<double>(),
              all["models"][name]["r75_m"].get<double>() / all["atmosphere"]["transmittance_at_r75"].get<double>())
        << name;
  }
  EXPECT_NEAR(strong["models"]["tod"]["r75_m"].get<double>() / strong["r75_m"].get<double>(), 1, 1e-6);
  expect_refused(range({"--cn2", "1e-14", "--grid-sizes-m", "2", "--grid-contrasts-k", "5"}), 2, "--cn2");
  expect_refused(range({"--cn2", "-1"}), 2, "--cn2");
  expect_refused(range({"--models", "tod,nvthermip"}), 2, "unknown model");
  const Json bars = one_object(range({"--models", "mtdp", "--tod-transfer", "simulated-imagers-1"}))["models"]["mtdp"];
  EXPECT_THAT(bars["reads"].get<std::string>(), HasSubstr("simulated-imagers-1"));
  EXPECT_LT(bars["r75_ci95_m"][0].get<double>(), bars["r75_m"].get<double>());
  expect_refused(range({"--models", "mtdp", "--tod-transfer", "fraunhofer"}), 2, "simulated-imagers-1");
  expect_refused(range({"--tod-transfer", "simulated-imagers-1"}), 2, "--models");
  expect_refused(range({"--atmosphere", "tropical", "--extinction-per-km", "0.2"}), 2, "has its own extinction");
}

TEST(RangeCommand, RefusesAThresholdThatFallsWithFrequencyOverItsWholeLength) {
  const TemporaryFolder folder;
  folder.write("m.csv", "frequency_per_mrad,mrtd_k\n0.1,0.5\n0.2,0.3\n0.3,0.1\n");
  folder.write("scatter.csv", "frequency_per_mrad,mrtd_k\n0.1,0.05\n0.2,0.04\n0.3,0.1\n0.4,0.9\n");
  folder.write("t.csv", "frequency_per_mrad,mtdp_k\n0.1,0.5\n0.2,0.5\n0.3,0.1\n");
  const auto range = [&](const char* model, const char* option, const char* file) {
    return todbench({"range", "--size-m", "2.3", "--delta-t-k", "4", "--models", model, option, file},
                    {.folder = folder.path()});
  };

  expect_refused(range("acquire", "--mrtd", "m.csv"), 2, "a threshold that rises with frequency is expected");
  expect_refused(range("mtdp", "--mtdp", "t.csv"), 2, "column mtdp_k falls over its whole length");
  EXPECT_NE(range("acquire", "--mrtd", "scatter.csv").code, 2);
}

TEST(PatternCommand, WritesPictureAndPlate) {
  const TemporaryFolder folder;
  for (const char* kind : {"tod", "mrtd", "edge", "ramp", "siemens", "flat"}) {
    for (const char* format : {"png16", "tiff", "npy"}) {
      const std::string out = std::string(kind) + "-" + format + ".picture";
      const Ended drawn =
          todbench({"pattern", kind, "--pixels", "320", "240", "--format", format, "--out", out, "--json"},
                   {.folder = folder.path()});
      EXPECT_EQ(drawn.code, 0) << drawn.err;
      EXPECT_FALSE(content_of(folder.path() / out).empty());
      EXPECT_EQ(one_object(drawn)["truth"], std::string(kind) + "-" + format + ".toml");
    }
  }

  const auto plate = load_plate((folder.path() / "tod-npy.toml").string());

  ASSERT_TRUE(plate) << plate.error().message;
  EXPECT_EQ(plate->width_mm, 320);
  EXPECT_GE(plate->triangles.size(), 20u);
  expect_refused(todbench({"pattern", "tod", "--pixels", "3", "3", "--out", "x.png"}, {.folder = folder.path()}), 2,
                 "are too few for");
  expect_refused(todbench({"pattern", "tod", "--pixels", "300", "300", "--out", "no/x.png"}, {.folder = folder.path()}),
                 2, "not a folder");
}

TEST(PatternCommand, ReplacesItsOwnTruthAndNoOtherFile) {
  const TemporaryFolder folder;
  const auto drawn = [&](const std::string& kind, const std::string& out) {
    return todbench({"pattern", kind, "--pixels", "64", "48", "--out", out}, {.folder = folder.path()});
  };
  EXPECT_EQ(drawn("edge", "x.png").code, 0);
  EXPECT_EQ(drawn("flat", "x.png").code, 0);
  const std::string truth = content_of(folder.path() / "x.toml");
  EXPECT_THAT(truth, HasSubstr("flat"));

  expect_refused(drawn("edge", "x.tiff"), 2, "x.toml, which is the file of another picture");
  EXPECT_EQ(content_of(folder.path() / "x.toml"), truth);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "x.tiff"));
  folder.write("plan.toml", "name = \"plan\"\n");
  expect_refused(drawn("edge", "plan.png"), 2, "plan.toml, which is not a file of true values");
  EXPECT_EQ(content_of(folder.path() / "plan.toml"), "name = \"plan\"\n");
}

TEST(PatternCommand, WritesTheFormatOfTheExtensionAndToFilesOnly) {
  const TemporaryFolder folder;
  const auto drawn = [&](const std::string& out) {
    return todbench({"pattern", "edge", "--pixels", "64", "48", "--out", out, "--json"}, {.folder = folder.path()});
  };

  for (const auto& [out, format, start] :
       {std::tuple("a.npy", "npy", "\x93NUMPY"), std::tuple("b.TIFF", "tiff", "II*"),
        std::tuple("c.png", "png16", "\x89PNG"), std::tuple("d", "png16", "\x89PNG")}) {
    EXPECT_EQ(one_object(drawn(out))["format"], format);
    EXPECT_TRUE(content_of(folder.path() / out).starts_with(start)) << out;
  }

  expect_refused(drawn(""), 2, "expected the name of a file");
  expect_refused(drawn("."), 2, "expected the name of a file");
  ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  expect_refused(drawn("pipe"), 2, "is a pipe, a socket or a device");
}

TEST(PictureCommand, WritesEveryStageOnOneGreyScale) {
  const TemporaryFolder folder;
  const std::vector<std::string> asked{
      "picture", "craft-at-sea", "--sensor", "sc2000", "--range-m", "300",   "--extinction-per-km",
      "0.5",     "--accuracy",   "draft",    "--out",  "p",         "--json"};

  const Ended ended = todbench(asked, {.folder = folder.path()});
  const Ended again = todbench(asked, {.folder = folder.path()});

  ASSERT_EQ(ended.code, 0) << ended.err;
  expect_refused(again, 2, "--force");
  const Json json = one_object(ended);
  const double tau = std::exp(-0.5 * 0.3);
  EXPECT_NEAR(json["transmittance"].get<double>(), tau, 1e-12);
  EXPECT_NEAR(json["apparent_delta_t_k"].get<double>(), json["target"]["dt_rss_k"].get<double>() * tau, 1e-9);
  ASSERT_EQ(json["stages"].size(), 7u);
  double before = 1e9;
  for (const auto& stage : json["stages"]) {
    const auto picture = read_picture(folder.path() / "p" / stage["tiff"].get<std::string>());
    ASSERT_TRUE(picture.has_value()) << stage;
    EXPECT_FALSE(picture->counts.has_value()) << stage;  // floating point
    EXPECT_EQ(picture->picture.cols, stage["width"].get<int>());
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "p" / stage["png"].get<std::string>()));
    // What is filtered has no more contrast than before.
    if (stage["name"] <= "4") {
      EXPECT_LE(stage["max_k"].get<double>(), before + 1e-4);
      before = stage["max_k"];
    }
  }
  EXPECT_EQ(read_picture(folder.path() / "p/frame.tiff")->picture.size(), cv::Size(320, 240));
  EXPECT_EQ(content_of(folder.path() / "p/pictures.html").find("<script"), std::string::npos);

  auto moving = asked;
  moving.insert(moving.end(), {"--force", "--motion-mrad-s", "40", "0"});
  folder.write("slow.toml", content_of(source_file("sim_devices/sensors/sc2000.toml")) + "\ntime_constant_ms = 10\n");
  moving[3] = "./slow.toml";
  const Json smeared = one_object(todbench(moving, {.folder = folder.path()}));
  moving[moving.size() - 2] = "0";
  const Json resting = one_object(todbench(moving, {.folder = folder.path()}));
  EXPECT_EQ(decisions_of(smeared["effects"]).at("motion"), "simulate");
  EXPECT_EQ(decisions_of(resting["effects"]).at("motion"), "skip");
  // A smear of 40 mrad/s x 10 ms is a third of a pitch and only lowers the contrast of the samples.
  EXPECT_LT(smeared["stages"][3]["max_k"].get<double>(), resting["stages"][3]["max_k"].get<double>());
  EXPECT_GT(smeared["stages"][3]["max_k"].get<double>(), 0.5 * resting["stages"][3]["max_k"].get<double>());
  EXPECT_EQ(resting["stages"][3]["max_k"], json["stages"][3]["max_k"]);

  auto turbulent = asked;
  turbulent.insert(turbulent.end(), {"--force", "--cn2", "1e-11"});
  const Json blurred = one_object(todbench(turbulent, {.folder = folder.path()}));
  EXPECT_TRUE(json["turbulence"].is_null());
  EXPECT_EQ(blurred["turbulence"]["path_m"], 300.0);
  const Json decisions = blurred["atmosphere"]["decisions"];
  ASSERT_EQ(decisions.size(), 4);
  EXPECT_EQ(decisions[2]["name"], "turbulence");
  EXPECT_EQ(decisions[3]["name"], "image_dance");
  // The page states each once, as an effect of the atmosphere.
  const std::string page = content_of(folder.path() / "p/pictures.html");
  const auto rows = [&](const std::string& name) { return occurrences(page, "<th scope=\"row\">" + name + "</th>"); };
  EXPECT_EQ(rows("atmosphere: turbulence"), 1);
  EXPECT_EQ(rows("atmosphere: image_dance"), 1);
  EXPECT_EQ(rows("turbulence"), 1) << "its numbers";
  EXPECT_EQ(rows("image_dance"), 0);
  EXPECT_EQ(rows("diffraction"), 1);
  turbulent.back() = "1e-3";
  expect_refused(todbench(turbulent, {.folder = folder.path()}), 2, "--cn2");
}

TEST(PictureCommand, RefusesScenesAndRangesThatCannotBe) {
  const TemporaryFolder folder;
  folder.write("crossing.toml",
               "name = \"c\"\nbackground_k = 290\n[[region]]\nx_m = [0, 1, 1, 0]\ny_m = [0, 1, 0, 1]\n"
               "temperature_k = 300\n");
  folder.write("cold.toml",
               "name = \"c\"\nbackground_k = 290\n[[region]]\nx_m = [0, 1, 1]\ny_m = [0, 0, 1]\ntemperature_k = -5\n");
  folder.write("coarse.toml",
               "name = \"c\"\nbackground_k = 290\n[picture]\nfile = \"p.tiff\"\npixel_mrad = 1\nrange_m = 100\n");
  folder.write("bare.toml",
               "name = \"c\"\nbackground_k = 290\n[picture]\nfile = \"c.tiff\"\npixel_mrad = 0.1\nrange_m = 9\n");
  folder.write("short.csv", "range_m,tau\n10,0.99\n50,0.98\n");
  folder.write("p.tiff", *tiff_of(cv::Mat1f(40, 40, 300.0F)));
  ASSERT_TRUE(TiffWriter::create(folder.path() / "c.tiff")->append(cv::Mat1w(40, 40, 3000)));
  const auto picture = [&](const std::string& scene, const std::string& range_m, const std::string& air = "clear") {
    return todbench({"picture", scene, "--sensor", "sc2000", "--range-m", range_m, "--atmosphere", air, "--out", "p"},
                    {.folder = folder.path()});
  };

  expect_refused(picture("./crossing.toml", "100"), 2, "crosses itself");
  expect_refused(picture("./cold.toml", "100"), 2, "temperature_k");
  expect_refused(picture("./coarse.toml", "100"), 2, "quarter of a pixel");
  expect_refused(picture("./bare.toml", "100"), 2, "needs a scale");
  expect_refused(picture("craft-at-sea", "100000", "us-standard"), 2, "table ends");
  expect_refused(picture("craft-at-sea", "100", "./short.csv"), 2, "table ends at 50 m");
  expect_refused(picture("tcat-a", "5000"), 2, "smaller than a pixel");
  expect_refused(picture("craft-at-see", "100"), 2, "craft-at-sea");
  expect_refused(picture("craft-at-sea", "-1"), 2, "--range-m");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "p"));
  // Before anything is read or computed.
  folder.write("p/notes.txt", "mine");
  expect_refused(picture("./crossing.toml", "100"), 2, "not empty");
}

TEST(IdentifyCommand, SaysWhereASetIsToldApartAndWhatTheTodCurveWouldHaveSaid) {
  const TemporaryFolder folder;
  folder.write("set.toml",
               "name = \"three\"\ntargets = [\"craft-01\", \"craft-07\", \"craft-12\"]\nazimuths_deg = [90]\n"
               "background_k = 288\n");
  folder.write("twins.toml",
               "name = \"t\"\ntargets = [\"craft-01\", \"craft-01\"]\nazimuths_deg = [90]\nbackground_k = 288\n");
  const auto identify = [&](const std::string& set, const std::string& ranges) {
    return todbench({"identify", set, "--sensor", "sc2000", "--ranges", ranges, "--decisions", "64", "--accuracy",
                     "draft", "--extinction-per-km", "0.1", "--json"},
                    {.folder = folder.path()});
  };

  const Ended ended = identify("./set.toml", "800,2500,8000");
  const Ended again = identify("./set.toml", "800,2500,8000");

  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, again.out);
  const Json json = one_object(ended);
  ASSERT_EQ(json["ranges"].size(), 3u);
  EXPECT_GT(json["ranges"][0]["proportion_correct"].get<double>(), 0.9);
  for (const auto& range : json["ranges"]) {
    double right = 0;
    for (std::size_t shown = 0; shown < 3; ++shown) {
      int all = 0;
      for (const auto& answers : range["confusion"][shown]) all += answers.get<int>();
      EXPECT_EQ(all, 64);
      right += range["confusion"][shown][shown].get<double>() / (3 * 64);
    }
    EXPECT_NEAR(range["proportion_correct"].get<double>(), right, 1e-9);
  }
  const double r75_m = json["r75_m"];
  EXPECT_GT(r75_m, 800);
  EXPECT_LT(r75_m, 8000);
  EXPECT_LE(json["r75_ci95_m"][0].get<double>(), r75_m);
  EXPECT_NEAR(json["v50"]["value"].get<double>(), json["m75"]["value"].get<double>() / 0.6, 1e-9);
  EXPECT_TRUE(json["predicted"]["r75_m"].is_number());
  const Ended always_right = identify("./set.toml", "100,200");
  EXPECT_EQ(always_right.code, 3);  // 75 % lies beyond
  const Json near = one_object(always_right)["ranges"][0];
  ASSERT_EQ(near["proportion_correct"].get<double>(), 1);
  // Wilson 1927, of 64 draws that all agree.
  EXPECT_NEAR(near["ci95"][0].get<double>(), 64 / (64 + 1.959964 * 1.959964), 1e-6);
  EXPECT_EQ(near["ci95"][1].get<double>(), 1);
  EXPECT_FALSE(json.contains("r75_spread_m")) << "an observer without an eye has no open parameters";
  expect_refused(identify("./twins.toml", "500,800"), 2, "listed twice");
  expect_refused(identify("./set.toml", "800,500"), 2, "increase");
  expect_refused(identify("no-such-set", "500,800"), 2, "small-craft");
}

TEST(IdentifyCommand, StatesRangeAndCriteriaOfAnEyeOverItsOpenParameters) {
  const TemporaryFolder folder;
  folder.write("set.toml",
               "name = \"two\"\ntargets = [\"craft-01\", \"craft-12\"]\nazimuths_deg = [90]\nbackground_k = 288\n");
  folder.write("display.toml",
               "[simulation]\nsensor = \"sc2000\"\n[display]\npixel_pitch_mm = 0.25\nviewing_distance_m = 0.6\n"
               "luminance_white_cd_m2 = 200\nzoom = 2\n");

  const Ended ended =
      todbench({"identify", "./set.toml", "--sensor", "sc2000", "--ranges", "400,800,1600,3200,6400", "--decisions",
                "64", "--accuracy", "draft", "--observer", "hvs-2", "--display", "./display.toml", "--json"},
               {.folder = folder.path()});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(json["observer"], "hvs-2");
  const auto expect_within = [](const Json& value, const Json& spread) {
    ASSERT_TRUE(value.is_number() && spread.is_array()) << value << spread;
    EXPECT_LE(spread[0].get<double>(), value.get<double>());
    EXPECT_GE(spread[1].get<double>(), value.get<double>());
    EXPECT_LT(spread[0].get<double>(), spread[1].get<double>());
  };
  expect_within(json["r75_m"], json["r75_spread_m"]);
  for (const char* criterion : {"m75", "v50"}) expect_within(json[criterion]["value"], json[criterion]["spread"]);
  expect_within(json["predicted"]["r75_m"], json["predicted"]["r75_spread_m"]);
  for (const Json& point : json["tod"]) expect_within(point["s75_mrad"], point["s75_spread_mrad"]);
}

TEST(MrtdCommand, TellsWhatIsAnMrtdFromWhatAMachineDoesBeyond) {
  const TemporaryFolder folder;
  const auto mrtd = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"mrtd", "--sensor", "sc2000", "--draws", "128", "--accuracy", "draft", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return todbench(arguments, {.folder = folder.path()});
  };

  const Ended ended = mrtd({"--of-nyquist", "0.4,1.2", "--page", "mrtd.html", "--svg", "mrtd.svg"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(json["criterion"], "four-or-five");
  for (const char* axis : {"horizontal", "vertical"}) {
    const Json& points = json["axes"][axis];
    ASSERT_EQ(points.size(), 2u);
    EXPECT_GT(points[0]["mrtd_k"].get<double>(), points[0]["ideal_k"].get<double>() * 0.8);
    EXPECT_TRUE(points[0]["formula_mrtd_k"].is_number());
    EXPECT_TRUE(points[1]["threshold_k"].is_number());
    EXPECT_TRUE(points[1]["mrtd_k"].is_null());
    // On the page in place of a number, not beside an interval of nothing.
    EXPECT_THAT(content_of(folder.path() / "mrtd.html"), HasSubstr(points[1]["reason"].get<std::string>()));
  }
  EXPECT_EQ(content_of(folder.path() / "mrtd.html").find("<script"), std::string::npos);
  EXPECT_NE(content_of(folder.path() / "mrtd.svg").find("<svg"), std::string::npos);
  // Behind air every contrast of the bars is exp(k R) times that at the camera: the answers are the same ones.
  const Json far = one_object(mrtd({"--of-nyquist", "0.4,1.2", "--range-m", "1500", "--extinction-per-km", "0.7"}));
  EXPECT_NEAR(far["transmittance"].get<double>(), std::exp(-1.05), 1e-12);
  EXPECT_TRUE(json["range_m"].is_null());
  for (const char* key :
       {"threshold_k", "mrtd_k", "best_phase_k", "worst_phase_k", "formula_mrtd_k", "ideal_k", "highest_k"}) {
    const Json &own = json["axes"]["horizontal"][0][key], &behind = far["axes"]["horizontal"][0][key];
    ASSERT_EQ(own.is_number(), behind.is_number()) << key;
    if (!own.is_number()) continue;
    EXPECT_NEAR(behind.get<double>(), own.get<double>() * std::exp(1.05), 1e-9) << key;
  }
  EXPECT_NEAR(far["axes"]["vertical"][0]["threshold_ci95_k"][1].get<double>(),
              json["axes"]["vertical"][0]["threshold_ci95_k"][1].get<double>() * std::exp(1.05), 1e-9);
  expect_refused(mrtd({"--atmosphere", "tropical"}), 2, "--range-m");
  expect_refused(mrtd({"--atmosphere", "tropical", "--range-m", "1e6"}), 2, "table ends");
  expect_refused(mrtd({"--extinction-per-km", "1e3", "--range-m", "1e6"}), 2, "the air transmits no contrast");
  // Microscan does not make the detectors smaller: next to Nyquist bars are told apart, but not resolved.
  const std::vector<std::string> resolved{"--axis",      "vertical", "--criterion", "bars-resolved",
                                          "--microscan", "2",        "--of-nyquist"};
  const auto at = [&](const std::string& share) {
    auto arguments = resolved;
    arguments.push_back(share);
    return mrtd(arguments).code;
  };
  EXPECT_EQ(at("0.4"), 0);
  EXPECT_EQ(at("0.99"), 3);
  expect_refused(mrtd({"--frequencies-per-mrad", "50"}), 2, "samples per side");
  expect_refused(mrtd({"--criterion", "flir92"}), 2, "four-or-five");
  expect_refused(mrtd({"--frequencies-per-mrad", "nan"}), 2, "--frequencies-per-mrad");
}

}  // namespace
}  // namespace todbench::testing
