// SPDX-License-Identifier: GPL-3.0-or-later
// Published figures beside ours: gains from acuities, and the page.
#include "bench/studies/eo_vista_figures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/report/html.h"
#include "bench/report/markup.h"

namespace todbench {
namespace {

/// Acuity 0.5 at every contrast for every sensor and observer, times `factor` for one of them.
std::vector<ReproducedThreshold> thresholds(const std::string& sensor, double factor) {
  std::vector<ReproducedThreshold> all;
  for (const char* s : {eo_vista::normal, eo_vista::microscan, eo_vista::still, eo_vista::dsr2, eo_vista::dsr2_exact}) {
    for (const char* o : {eo_vista::hvs, eo_vista::human}) {
      for (const double c : eo_vista_contrasts_k) {
        const double acuity = 0.5 * (s == sensor ? factor : 1);
        all.push_back({s, o, c, acuity, {acuity * std::exp(-0.03), acuity * std::exp(0.03)}, ""});
      }
    }
  }
  return all;
}

TEST(EoVistaFigures, GainsAreRatiosOfAcuitiesWithJoinedErrors) {
  const auto all = thresholds(eo_vista::microscan, 1.55);

  const auto figures = eo_vista_figures(all, {});

  const auto& gain = figures.front();  // microscan, HVS, 16.9 K
  EXPECT_NEAR(gain.value.value(), 55, 1e-9);
  EXPECT_NEAR(gain.ci95.high.value(), 100 * (1.55 * std::exp(0.03 * std::sqrt(2.0)) - 1), 1e-9);
  EXPECT_EQ(difference_in_words(gain), "0 points");
  for (const auto& figure : figures) EXPECT_FALSE(figure.remark.empty()) << figure.quantity;
}

TEST(EoVistaFigures, GradedAnswersStandBesideRightAndWrongOnesWhereACameraAnswered) {
  auto all = thresholds(eo_vista::dsr2, 1.4);
  for (ReproducedThreshold& t : all) {
    if (t.sensor != eo_vista::dsr2) continue;
    t.graded_acuity_per_mrad = 0.75;
    t.graded_ci95 = {0.75 * std::exp(-0.01), 0.75 * std::exp(0.01)};
  }

  const auto figures = eo_vista_figures(all, {});

  int graded = 0;
  for (const auto& figure : figures) {
    const bool of_the_camera = figure.quantity.starts_with("DSR2 gain");
    EXPECT_EQ(figure.graded_value.has_value(), of_the_camera) << figure.quantity;
    if (!figure.graded_value) continue;
    ++graded;
    EXPECT_NEAR(*figure.value, 40, 1e-9) << figure.quantity;
    EXPECT_NEAR(*figure.graded_value, 50, 1e-9) << figure.quantity;
    EXPECT_NEAR(*figure.graded_ci95.high, 100 * (1.5 * std::exp(std::hypot(0.01, 0.03)) - 1), 1e-9);
  }
  EXPECT_EQ(graded, 5);
}

TEST(EoVistaFigures, WhatWasNotFoundIsMissingAndNotMadeUp) {
  const auto figures = eo_vista_figures({}, {});

  for (const auto& figure : figures) {
    if (figure.quantity.starts_with("M75")) continue;
    EXPECT_FALSE(figure.value.has_value()) << figure.quantity;
    EXPECT_EQ(difference_in_words(figure), "");
  }
}

TEST(ReproductionPage, ShowsEveryFigureAndEscapesTexts) {
  Reproduction reproduction;
  reproduction.title = "A < B";
  reproduction.model_observer = eo_vista::hvs;
  reproduction.simulated_sensors = {eo_vista::normal, eo_vista::microscan};
  reproduction.cameras = {eo_vista::still, eo_vista::dsr2};
  reproduction.thresholds = thresholds(eo_vista::microscan, 1.5);
  reproduction.figures = eo_vista_figures(reproduction.thresholds, {});

  const std::string page = render_html(reproduction_document(reproduction));

  EXPECT_NE(page.find("A &lt; B"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  for (const auto& figure : reproduction.figures)
    EXPECT_NE(page.find(escaped(figure.quantity).text), std::string::npos) << figure.quantity;
}

TEST(ReproductionPage, TellsAChangeFromAShareByItsKindWhateverItsWords) {
  const auto said = [](FigureKind kind) {
    Reproduction reproduction;
    ReproducedFigure figure;
    figure.kind = kind;
    figure.quantity = "Correct at last";
    figure.unit = "%";
    figure.value = 12;
    reproduction.figures = {figure};
    return render_html(reproduction_document(reproduction));
  };

  EXPECT_NE(said(FigureKind::change).find(">+12"), std::string::npos);
  EXPECT_EQ(said(FigureKind::share).find(">+12"), std::string::npos);
}

}  // namespace
}  // namespace todbench
