// SPDX-License-Identifier: GPL-3.0-or-later
// A published experiment repeated, as a user asks for it.
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

TEST(ReproduceCommand, WritesAPageWithThePublishedFiguresBesideOurs) {
  const TemporaryFolder folder;
  const auto reproduce = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"reproduce", "eo-vista", "--out", "r", "--accuracy", "draft", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return todbench(arguments, {.folder = folder.path()});
  };

  const Ended ended = reproduce({});
  const Ended again = reproduce({});

  ASSERT_EQ(ended.code, 0) << ended.err;
  expect_refused(again, 2, "is not empty (--force overwrites");
  const Json json = one_object(ended);
  EXPECT_THAT(keys_of(json), UnorderedElementsAre("experiment", "source", "figures", "thresholds", "ranges",
                                                  "assumptions", "settings", "figure_12"));
  ASSERT_EQ(json["figure_12"].size(), 3u);
  for (const auto& picture : json["figure_12"])
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "r" / picture["png"].get<std::string>())) << picture;
  EXPECT_EQ(Json::parse(content_of(folder.path() / "r/reproduction.json")), json);
  std::set<std::string> cells;  // of Table 2: every sensor judged by every observer
  for (const auto& t : json["thresholds"]) {
    cells.insert(t["sensor"].get<std::string>() + ", " + t["observer"].get<std::string>());
    EXPECT_TRUE(t["acuity_per_mrad"].is_number()) << t;
  }
  for (const char* sensor : {"SC2000", "SC2000 + microscan", "emulated camera, still", "emulated camera + DSR2"}) {
    for (const char* observer : {"hvs-1", "human-like-1"})
      EXPECT_EQ(cells.count(std::string(sensor) + ", " + observer), 1u) << sensor << observer;
  }
  std::set<std::string> published;
  for (const auto& figure : json["figures"]) {
    if (figure["published"].is_string()) published.insert(figure["published"]);
    EXPECT_TRUE(figure["value"].is_number()) << figure;
    EXPECT_FALSE(figure["remark"].get<std::string>().empty()) << figure;
  }
  const std::string page = content_of(folder.path() / "r/reproduction.html");
  for (const char* figure : {"55 %, roughly constant", "60 % at all contrasts", "50 %", "18 % on average over sensors",
                             "35 % on average over sensors", "450 m", "700 m", "about 80 %", "5.1"}) {
    EXPECT_EQ(published.count(figure), 1u) << figure;
    EXPECT_THAT(page, HasSubstr(figure));
  }
  EXPECT_THAT(page, AllOf(HasSubstr("<svg"), HasSubstr("A fit, not a confirmation"),
                          HasSubstr("Assumptions not stated in the paper")));
  for (const char* outside : {"<script", "http://", "https://"}) {
    // The name of the markup language is the only address in it.
    std::string text = page;
    for (const char* known : {"http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg"}) {
      for (auto at = text.find(known); at != std::string::npos; at = text.find(known))
        text.erase(at, std::string(known).size());
    }
    EXPECT_EQ(text.find(outside), std::string::npos) << outside;
  }
  expect_refused(todbench({"reproduce", "another"}, {.folder = folder.path()}), 2, "expected eo-vista or vision");
}

TEST(ReproduceCommand, HoldsTheObserverWithAnEyeAgainstPeopleFailuresFirst) {
  const TemporaryFolder folder;

  const Ended ended =
      todbench({"reproduce", "vision", "--out", "v", "--accuracy", "draft", "--json"}, {.folder = folder.path()});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_THAT(keys_of(json), UnorderedElementsAre("experiment", "observer", "statement", "failures", "kinds",
                                                  "not_comparable", "settings"));
  ASSERT_EQ(json["failures"].size(), 6u);
  for (std::size_t i = 0; i < json["failures"].size(); ++i) EXPECT_EQ(json["kinds"][i]["name"], json["failures"][i]);
  for (const auto& kind : json["kinds"]) {
    EXPECT_TRUE(kind["rms_error"].is_number()) << kind["name"];
    for (const auto& point : kind["points"]) EXPECT_TRUE(point["error"].is_number()) << kind["name"] << point;
  }
  EXPECT_TRUE(json["not_comparable"][0]["value"].is_null());
  EXPECT_EQ(Json::parse(content_of(folder.path() / "v/vision.json")), json);
  const std::string page = content_of(folder.path() / "v/vision.html");
  EXPECT_THAT(page, AllOf(HasSubstr("<svg"), HasSubstr("is not a validated model of people"),
                          HasSubstr("Not comparable: another model")));
}

}  // namespace
}  // namespace todbench::testing
