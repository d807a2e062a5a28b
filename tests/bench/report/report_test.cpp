// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <set>

#include "bench/report/fit_words.h"
#include "bench/report/number_format.h"
#include "tests/bench/report/report_sample.h"

namespace todbench {
namespace {

/// Reads a page as XML: every tag closed in order, attributes quoted and not repeated, only known entities. Says what
/// is wrong, or nothing.
class WellFormedness {
 public:
  explicit WellFormedness(const std::string& page) : page_(page) {}

  std::string complaint() {
    for (at_ = page_.find('<'); at_ != std::string::npos; at_ = page_.find('<', at_)) {
      if (page_.compare(at_, 9, "<!DOCTYPE") == 0) {
        at_ = page_.find('>', at_);
        continue;
      }
      const std::string wrong = tag();
      if (!wrong.empty()) return wrong + " at byte " + std::to_string(at_);
    }
    if (!open_.empty()) return "<" + open_.back() + "> is never closed";
    return entities();
  }

 private:
  std::string tag() {
    ++at_;
    const bool closing = page_[at_] == '/';
    if (closing) ++at_;
    const std::string name = word();
    if (name.empty()) return "a tag without name";
    std::set<std::string> seen;
    for (;;) {
      while (at_ < page_.size() && std::isspace(static_cast<unsigned char>(page_[at_])) != 0) ++at_;
      if (at_ >= page_.size()) return "<" + name + " has no end";
      if (page_[at_] == '>' || page_.compare(at_, 2, "/>") == 0) break;
      const std::string attribute = word();
      if (attribute.empty() || page_.compare(at_, 2, "=\"") != 0) return "an attribute of <" + name + "> is not quoted";
      if (!seen.insert(attribute).second) return "attribute " + attribute + " twice";
      at_ += 2;
      const std::size_t end = page_.find('"', at_);
      if (page_.substr(at_, end - at_).find('<') != std::string::npos) return "< in an attribute";
      at_ = end + 1;
    }
    if (page_[at_] == '/') return {};
    if (!closing) {
      open_.push_back(name);
      return {};
    }
    if (open_.empty() || open_.back() != name)
      return "</" + name + "> closes " + (open_.empty() ? "nothing" : open_.back());
    open_.pop_back();
    return {};
  }

  std::string word() {
    const std::size_t start = at_;
    while (at_ < page_.size() && (std::isalnum(static_cast<unsigned char>(page_[at_])) != 0 || page_[at_] == '-'))
      ++at_;
    return page_.substr(start, at_ - start);
  }

  [[nodiscard]] std::string entities() const {
    for (std::size_t at = page_.find('&'); at != std::string::npos; at = page_.find('&', at + 1)) {
      const std::string name = page_.substr(at, page_.find(';', at) - at + 1);
      static const std::set<std::string> known{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
      if (known.count(name) == 0) return "unknown entity " + name.substr(0, 12);
    }
    return {};
  }

  const std::string& page_;
  std::size_t at_ = 0;
  std::vector<std::string> open_;
};

std::string malformed(const std::string& page) {
  return WellFormedness(page).complaint();
}

/// Instead of a matcher, so that a failure names the missing part and not the whole page.
bool contains(const std::string& page, const std::string& part) {
  return page.find(part) != std::string::npos;
}

/// The page without tags, style and letter case.
std::string visible_text(const std::string& page) {
  std::string text;
  bool inside = false;
  for (std::size_t i = page.find("</style>"); i < page.size(); ++i) {
    if (page[i] == '<') inside = true;
    if (!inside) text += static_cast<char>(std::tolower(static_cast<unsigned char>(page[i])));
    if (page[i] == '>') inside = false;
  }
  return text;
}

/// Whether a word stands in the text on its own: "inf" but not "infrared".
bool has_word(const std::string& text, const std::string& word) {
  const auto letter = [&](std::size_t i) {
    return i < text.size() && std::isalpha(static_cast<unsigned char>(text[i])) != 0;
  };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    if (!(at > 0 && letter(at - 1)) && !letter(at + word.size())) return true;
  return false;
}

/// Of all figures of a document, in its order.
std::vector<std::string> ids_of_figures(const Document& document) {
  std::vector<std::string> ids;
  const auto add = [&](const Figure& figure) { ids.push_back(figure.drawing ? figure.drawing->id : "none"); };
  for (const Section& section : document.sections) {
    for (const Block& block : section.blocks) {
      if (const auto* figure = std::get_if<Figure>(&block)) add(*figure);
      if (const auto* pairs = std::get_if<FigurePairs>(&block))
        for (const Figure& figure : pairs->figures) add(figure);
    }
  }
  return ids;
}

TEST(WellFormednessCheck, FindsWhatIsWrong) {
  EXPECT_EQ(malformed("<p>a &amp; b<br/></p>"), "");
  EXPECT_NE(malformed("<p><b></p></b>"), "");
  EXPECT_NE(malformed("<p>"), "");
  EXPECT_NE(malformed("<p>a & b;</p>"), "");
  EXPECT_NE(malformed("<p class=x></p>"), "");
}

TEST(Report, IsWellFormedAndNeedsNothingFromOutside) {
  std::string page = render_report(sample_report());

  EXPECT_EQ(malformed(page), "");
  EXPECT_EQ(page.find("<!DOCTYPE html>\n<html lang=\"en\""), 0U);
  EXPECT_FALSE(contains(page, "<script"));
  EXPECT_FALSE(contains(page, "<link"));
  EXPECT_FALSE(contains(page, "<img"));
  EXPECT_FALSE(contains(page, "@import"));
  EXPECT_FALSE(contains(page, "src="));
  for (const std::string name : {"http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg"})
    for (std::size_t at = page.find(name); at != std::string::npos; at = page.find(name)) page.erase(at, name.size());
  EXPECT_FALSE(contains(page, "http"));
}

TEST(Report, IdentifiesUnitOperatorPlaceAndSession) {
  const std::string page = render_report(sample_report());

  for (const char* part :
       {"Example Infrared", "TI-320", "48000123", "2.14.0", "A. Operator", "Laboratory 2, optical bench",
        "20240311T091500Z_TI-320_48000123_tod", "2024-03-11T09:58:12Z", "Example Customs"})
    EXPECT_TRUE(contains(page, part)) << part;
}

TEST(Report, PutsTheVerdictWithItsRuleBeforeEverythingElse) {
  const std::string page = render_report(sample_report());

  const std::size_t verdict = page.find("✗ FAIL");
  const std::size_t rule = page.find("Guarded acceptance and rejection");
  ASSERT_NE(verdict, std::string::npos);
  EXPECT_LT(verdict, rule);
  EXPECT_LT(rule, page.find("<h2"));
}

TEST(Report, ShowsEveryResultWithItsInterval) {
  const std::string page = render_report(sample_report());

  // Acuity 1/2.083 within 1/(2.083 1.026) and 1.026/2.083; half of its width is 0.0123, so three decimals.
  for (const char* part : {"0.480 [0.468, 0.493]", "2.083 [2.030, 2.137]", "16.9000 ± 0.0042", "≥ 0.44", "1280 / 16"})
    EXPECT_TRUE(contains(page, part)) << part;
  // Comparison: ratio 0.985 times 0.962 and 1.041.
  for (const char* part : {"0.985 [0.948, 1.025]", "&lt; 0.001", "0.012", "equivalent", "different", "inconclusive"})
    EXPECT_TRUE(contains(page, part)) << part;
}

TEST(Report, ShowsGeometryEffectsFramesAndProvenance) {
  const std::string page = render_report(sample_report());

  // One pixel on the plate: 1.309 mrad at 3 m is 3.927 mm; the largest triangle of 18 mm is 6 mrad.
  for (const char* part :
       {"3.000 m", "1.309 mrad", "3.927 mm", "6.00", "mirrored left to right", "0.041", "serial 7711"})
    EXPECT_TRUE(contains(page, part)) << part;
  for (const char* part :
       {"Diffraction", "The footprint is 0.89 of the pitch.", "skipped", "no criterion predicts a value"})
    EXPECT_TRUE(contains(page, part)) << part;
  // 44 of 1580 received frames: 2.78 %.
  for (const char* part :
       {"1536", "44 (2.78 % of those received)", "nonuniformity correction", "0.0713 K", "TemperatureLinear10mK"})
    EXPECT_TRUE(contains(page, part)) << part;
  for (const char* part :
       {"0123456789abcdef", "bench-2", "relate only to the item tested", "coverage of 95 %", "Signature:"})
    EXPECT_TRUE(contains(page, part)) << part;
}

TEST(Report, DrawsTheTodCurveAndOneFunctionPerContrast) {
  const std::string page = render_report(sample_report());

  for (const char* part : {"id=\"tod-title\"", "id=\"psychometric-1-title\"", "id=\"psychometric-2-title\"",
                           "id=\"psychometric-3-title\""})
    EXPECT_TRUE(contains(page, part)) << part;
  EXPECT_FALSE(contains(page, "psychometric-4"));
}

TEST(Report, HasEveryFigureOfItsDocumentInOrder) {
  ReportData full = sample_report();
  full.human = full.measured;
  full.cost.emplace();
  ReportData without_curves = sample_report();
  without_curves.measured.reset();
  without_curves.simulated.reset();
  for (const ReportData& data : {full, sample_report(), without_curves, ReportData{}}) {
    const std::string page = render_report(data);
    std::size_t at = 0;
    const std::vector<std::string> expected = ids_of_figures(report_document(data));
    for (const std::string& id : expected) {
      at = page.find("aria-labelledby=\"" + id + "-title ", at);
      ASSERT_NE(at, std::string::npos) << id;
      ++at;
    }
    std::size_t drawn = 0;
    for (at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1)) ++drawn;
    EXPECT_EQ(expected.size(), drawn);
  }
}

TEST(Report, NamesTheTimeOfTheCostOfAccuracyAsComputingTime) {
  ReportData data = sample_report();
  data.cost.emplace();

  const std::string page = render_report(data);

  EXPECT_TRUE(contains(page, "Computing time (s)"));
  EXPECT_TRUE(contains(page, "the smaller of wall time and processor time"));
  EXPECT_FALSE(contains(page, "Wall time"));
}

TEST(Report, HasNoIdTwice) {
  const std::string page = render_report(sample_report());

  std::set<std::string> ids;
  for (std::size_t at = page.find(" id=\""); at != std::string::npos; at = page.find(" id=\"", at + 1)) {
    const std::string id = page.substr(at + 5, page.find('"', at + 5) - at - 5);
    EXPECT_TRUE(ids.insert(id).second) << id;
  }
}

TEST(Report, EscapesEveryTextFromOutside) {
  const std::string hostile = "<b>\"O'Neil\" & Co</b>";
  ReportData data = sample_report();
  data.title = data.session = data.description = data.operator_name = data.place = data.target = data.observer =
      hostile;
  data.started = data.finished = data.verdict->rule_in_words = hostile;
  data.conditions = data.provenance = {{hostile, hostile}};
  data.camera->vendor = data.camera->model = data.camera->serial = data.camera->firmware = data.camera->id = hostile;
  data.camera->settings = {{hostile, hostile}};
  data.camera->warnings = data.notes = {hostile};
  data.simulated_sensor->name = hostile;
  data.frames_rejected = {{hostile, 1}};
  data.set_ups[0].plate = data.plates[0].name = hostile;
  data.verdict->demands[0].reason = hostile;
  data.plan.decisions[0].reason = hostile;
  data.interrupted = hostile;

  const std::string page = render_report(data);

  EXPECT_EQ(malformed(page), "");
  EXPECT_TRUE(contains(page, "&lt;b&gt;&quot;O&#39;Neil&quot; &amp; Co&lt;/b&gt;"));
  EXPECT_FALSE(contains(page, "O'Neil"));
}

TEST(Report, NamesSessionAndItemAtTheFootOfEveryPrintedPage) {
  ReportData data = sample_report();
  data.session = "a\"}</style>\\";
  data.camera->serial = "7é";

  const std::string page = render_report(data);

  EXPECT_EQ(malformed(page), "");
  EXPECT_TRUE(
      contains(page, R"(@bottom-left{content:"a\22 \7d \3c \2f style\3e \5c \2c \20 serial\20 number\20 7é"})"));
  EXPECT_TRUE(contains(page, "counter(page)"));
}

TEST(Report, BytesThatAreNoTextBecomeReplacementCharacters) {
  ReportData data = sample_report();
  data.camera->serial = std::string("12\x01") + '\0' + "\xE9" + "34\xC0\x80" + "\xED\xA0\x80";
  data.operator_name = "Zoë Łukasiewicz 李";

  const std::string page = render_report(data);

  EXPECT_TRUE(contains(page,
                       "12\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD"
                       "34\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD<"));
  EXPECT_TRUE(contains(page, "Zoë Łukasiewicz 李"));
}

TEST(Report, WithoutAnythingSaysWhatIsMissingAndWhy) {
  const std::string page = render_report(ReportData{});

  EXPECT_EQ(malformed(page), "");
  for (const char* part : {"NO VERDICT", "simulation only, no camera was measured", "not stated in the plan",
                           "no results", "needs a measured and a simulated curve", "no sensor was simulated"})
    EXPECT_TRUE(contains(page, part)) << part;
}

TEST(Report, NeverShowsANumberThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  ReportData data = sample_report();
  data.distance_m = infinity;
  data.ifov_mrad = data.temporal_noise_k = nan;
  data.measured->points[0].fit.ci95 = {nan, infinity};
  data.measured->points[1].fit.threshold = nan;
  data.measured->points[1].fit.slope = infinity;
  data.measured->points[2].delta_t_k = nan;
  data.measured->points[2].fit.lapse = nan;
  data.simulated->points[0].direct_s75_mrad = nan;
  data.comparison->points[0].ratio = infinity;
  data.comparison->points[0].p_difference = nan;
  data.comparison->points[1].delta_t_a_k = nan;
  data.verdict->demands[0].result = nan;
  data.verdict->demands[0].limit = infinity;
  data.plan.decisions[0].predicted_change_percent = nan;
  data.set_ups[0].registration.residual_px = nan;

  const std::string page = render_report(data);

  EXPECT_EQ(malformed(page), "");
  EXPECT_FALSE(has_word(visible_text(page), "nan"));
  EXPECT_FALSE(has_word(visible_text(page), "inf"));
  EXPECT_FALSE(contains(page, "\"nan"));
  EXPECT_FALSE(contains(page, "\"inf"));
}

TEST(Report, AOneSidedLimitIsShownAsOneInTableAndFigure) {
  ReportData data = sample_report();
  data.simulated.reset();
  data.comparison.reset();
  PsychometricFit& fit = data.measured->points[0].fit;
  fit.verdict = FitVerdict::below_range;
  fit.threshold.reset();
  fit.slope.reset();
  fit.ci95 = {{}, 1.27};

  const std::string page = render_report(data);

  EXPECT_TRUE(contains(page, "≤ 1.27"));
  EXPECT_TRUE(contains(page, "≥ 0.787"));
  EXPECT_TRUE(contains(page, "answers correct at every size: only an upper limit of the threshold"));
  EXPECT_TRUE(contains(page, "(not identified)"));
}

TEST(Report, SaysOnceWhatTheAnswersAreAndWhereTheyDiffer) {
  ReportData data = sample_report();
  ASSERT_EQ(data.measured->points.size(), 3u);
  const auto give = [](TodCurve& curve, AnswerKind kind, AnswersReason reason, const std::vector<int>& frames) {
    for (std::size_t i = 0; i < curve.points.size(); ++i)
      curve.points[i].answers = AnswersTaken{kind, frames.at(i % frames.size()), reason};
  };
  const auto set = [&](std::size_t i) { return stated(data.measured->points[i].set_delta_t_k) + " K"; };
  for (TodCurve* curve : {&*data.measured, &*data.simulated})
    give(*curve, AnswerKind::graded, AnswersReason::twin, {1, 2, 10});
  const std::string graded = "graded: the observer's probability of a correct answer (" +
                             std::string(in_words(AnswersReason::twin)) + "), averaged over ";

  EXPECT_EQ(answers_in_words(data), " Answers are " + graded + "1 frame of a presentation at " + set(0) +
                                        ", 2 frames at " + set(1) + ", 10 frames at " + set(2) + ".");
  give(*data.measured, AnswerKind::graded, AnswersReason::twin, {4});
  give(*data.simulated, AnswerKind::graded, AnswersReason::twin, {4});
  EXPECT_EQ(answers_in_words(data), " Answers are " + graded + "4 frames of a presentation.");
  give(*data.simulated, AnswerKind::binary, AnswersReason::plan, {1});
  const std::string binary =
      "right or wrong, one answer for each frame (" + std::string(in_words(AnswersReason::plan)) + ")";
  EXPECT_EQ(answers_in_words(data),
            " Answers are " + graded + "4 frames of a presentation. The answers of the twin are " + binary + ".");
  data.simulated.reset();
  data.measured->points[1].answers = AnswersTaken{AnswerKind::binary, 1, AnswersReason::plan};
  EXPECT_EQ(answers_in_words(data), " Answers are " + graded + "4 frames of a presentation at " + set(0) + ", " +
                                        set(2) + "; " + binary + " at " + set(1) + ".");
  for (TodPoint& point : data.measured->points) point.answers.reset();
  EXPECT_EQ(answers_in_words(data), "");
}

TEST(Report, AFreeLapseThatFitsBetterIsSaidAndDrawn) {
  ReportData data = sample_report();
  TodPoint& point = data.measured->points[0];
  point.lapse_warning = true;
  point.free_lapse_fit = point.fit;
  point.free_lapse_fit->lapse = 0.034;

  const std::string page = render_report(data);

  EXPECT_TRUE(contains(page, "free: 0.034, fits better"));
  EXPECT_TRUE(contains(page, "measured, free lapse"));
}

TEST(Report, WhatSpeaksAgainstANumberStandsBesideItAndInASentence) {
  ReportData data = sample_report();
  ASSERT_FALSE(contains(render_report(data), "not fit for a decision"));
  data.measured->points[1].adequacy =
      Adequacy{{{FindingKind::lapse, 20, 6, "lapses <that> the fit does not allow for", true}}};
  data.simulated->points[0].adequacy =
      Adequacy{{{FindingKind::rounding, 0.3, 0.5, "rounding is no white noise", false}}};
  data.comparison->adequacy = Adequacy{{{FindingKind::identity, {}, {}, "other plates were used", true}}};

  const std::string page = render_report(data);

  EXPECT_EQ(malformed(page), "");
  EXPECT_TRUE(contains(page, "lapses &lt;that&gt; the fit does not allow for"));
  EXPECT_TRUE(contains(page, "not fit for a decision"));
  EXPECT_TRUE(contains(page, "rounding is no white noise"));
  EXPECT_TRUE(contains(page, "other plates were used"));
}

TEST(Report, CatchTrialsAreInTheAppendixAndNotOnTheLogarithmicAxis) {
  ReportData data = sample_report();
  data.measured->points[0].levels.push_back({0, 5, 20, -1});

  const std::string page = render_report(data);

  EXPECT_EQ(malformed(page), "");
  EXPECT_TRUE(contains(page, "0 (catch trials)"));
}

TEST(Report, TheSameValuesGiveTheSameBytes) {
  EXPECT_EQ(render_report(sample_report()), render_report(sample_report()));
}

TEST(Report, ADemandThatIsNoNumberIsShownWithItsReason) {
  ReportData data = sample_report();
  data.verdict->demands = {
      {.kind = DemandKind::identified, .delta_t_k = 2, .reason = "The threshold cannot be found."}};

  const std::string page = render_report(data);

  EXPECT_TRUE(contains(page, "Identified threshold at 2 K"));
  EXPECT_TRUE(contains(page, "(no limit value)"));
  EXPECT_TRUE(contains(page, "The threshold cannot be found."));
  EXPECT_FALSE(contains(page, "limit (minimum acuity)"));
}

TEST(Report, AnIntervalOfAnotherConfidenceSaysSo) {
  ReportData data = sample_report();
  data.verdict->demands = {{.kind = DemandKind::equivalence,
                            .limit = 10,
                            .result = 3.1,
                            .interval = {0, 6.2},
                            .interval_percent = 90,
                            .reason = "equivalent"}};

  const std::string page = render_report(data);

  EXPECT_TRUE(contains(page, "≤ 10"));
  EXPECT_TRUE(contains(page, "(90 %)"));
}

TEST(Report, AVerdictThatWasMadeAfterTheRunSaysSo) {
  ReportData data = sample_report();
  const std::string at_once = render_report(data);
  data.verdict->judged = JudgedWhen::afterwards;

  const std::string afterwards = render_report(data);

  EXPECT_FALSE(contains(at_once, "stored no verdict"));
  EXPECT_TRUE(contains(afterwards, "The run of this session stored no verdict. The session was judged afterwards"));
}

TEST(Report, ShowsSetReadBackAndSeenContrastWherePresentationsAreKnown) {
  const std::string caption = "Set contrast, read-back of the target";
  ReportData data = sample_report();
  const std::string without = render_report(data);
  Presentation told;
  told.set.delta_t_k = 2;
  told.said.state.delta_t_k = 2.125;
  told.delta_t_k = 1.875;
  data.presentations = {told};

  const std::string page = render_report(data);

  EXPECT_FALSE(contains(without, caption));
  EXPECT_TRUE(contains(page, caption));
  EXPECT_TRUE(contains(page, "0.1250 (0.1250)"));
  EXPECT_TRUE(contains(page, "−0.2500"));
}

TEST(ReportVerdict, IsTheDecisionThatWasMadeAndNotAnotherOne) {
  ReportData data = sample_report();  // its demands: pass, inconclusive, fail

  EXPECT_EQ(report_verdict(data), ReportVerdict::fail);
  data.verdict->decision = VerdictKind::inconclusive;
  EXPECT_EQ(report_verdict(data), ReportVerdict::inconclusive);
  data.verdict->decision = VerdictKind::pass;
  EXPECT_EQ(report_verdict(data), ReportVerdict::pass);
}

TEST(ReportVerdict, OfChangedFilesIsNoneAndNoLimitLooksMet) {
  ReportData data = sample_report();
  ASSERT_TRUE(contains(render_report(data), " pass</strong>"));
  data.accepted_changes = {"fits.json"};

  EXPECT_EQ(report_verdict(data), ReportVerdict::changed);
  EXPECT_FALSE(contains(render_report(data), " pass</strong>"));
}

TEST(ReportVerdict, WithoutLimitsIsNone) {
  ReportData data = sample_report();
  data.verdict->decision = VerdictKind::pass;
  data.verdict->demands = {{.kind = DemandKind::identified, .delta_t_k = 2, .decision = VerdictKind::pass}};

  EXPECT_EQ(report_verdict(data), ReportVerdict::not_judged);
  data.verdict.reset();
  EXPECT_EQ(report_verdict(data), ReportVerdict::not_judged);
}

TEST(ReportVerdict, AnInterruptedRunCannotPassButAViolatedLimitStaysOne) {
  ReportData data = sample_report();
  data.interrupted = "Stopped by the operator.";

  EXPECT_EQ(report_verdict(data), ReportVerdict::fail);
  data.verdict->decision = VerdictKind::pass;
  EXPECT_EQ(report_verdict(data), ReportVerdict::interrupted);
  const std::string page = render_report(data);
  EXPECT_TRUE(contains(page, "INTERRUPTED"));
  EXPECT_TRUE(contains(page, "Stopped by the operator."));
  EXPECT_FALSE(contains(page, "✓ PASS"));
}

}  // namespace
}  // namespace todbench
