// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/template_bank.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/rng.h"
#include "hvs/observer/template_observer.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

TEST(TemplateBank, HasTheSizeThatTheObserverIsDefinedWith) {
  const auto bank = TemplateBank::build({}, triangle_alternatives(), 2.0, 1);

  ASSERT_TRUE(bank.has_value());
  EXPECT_EQ(bank->window_samples(), 10);  // half = ceil(1.05 * 2 + 2) = 5 pitches
  EXPECT_EQ(bank->templates(), 4 * 17 * 17);
  const auto microscan = TemplateBank::build({}, triangle_alternatives(), 2.0, 2);
  ASSERT_TRUE(microscan.has_value());
  EXPECT_EQ(microscan->window_samples(), 2 * 2 * 4);  // size 1 pitch: half = ceil(3.05) = 4 pitches of 2 samples
}

TEST(TemplateBank, TemplatesHaveZeroMeanAndUnitNorm) {
  const auto bank = TemplateBank::build({}, triangle_alternatives(), 1.6, 1);

  for (const int place : {0, 37, bank->central_place(), 288}) {
    const cv::Mat1f t = bank->image(2, place);
    EXPECT_NEAR(cv::sum(t)[0], 0, 1e-5);
    EXPECT_NEAR(cv::norm(t), 1, 1e-6);
  }
}

TEST(TemplateBank, ManyPatchesHaveTheScoresOfEach) {
  const auto bank = TemplateBank::build({}, triangle_alternatives(), 1.6, 1);
  ASSERT_TRUE(bank.has_value());
  const auto samples = static_cast<std::size_t>(bank->window_samples() * bank->window_samples());
  const RandomStream numbers(7, "patches");
  for (const std::size_t count : {0U, 1U, 4U, 7U}) {
    std::vector<std::vector<float>> patches(count, std::vector<float>(samples));
    std::vector<std::vector<float>> scores(count, std::vector<float>(bank->padded_templates(), -1.0F));
    for (std::size_t k = 0; k < count; ++k) numbers.sub(k).fill_normal(patches[k]);
    bank->project_all(std::vector<std::span<const float>>(patches.begin(), patches.end()),
                      std::vector<std::span<float>>(scores.begin(), scores.end()));
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<float> alone(bank->padded_templates());
      bank->project(patches[k], alone);
      EXPECT_EQ(scores[k], alone) << "patch " << k << " of " << count;
    }
  }
}

class TemplateBankOfSamples : public ::testing::TestWithParam<double> {};

/// Of displayed samples as high as wide, and of higher and flatter ones.
TEST_P(TemplateBankOfSamples, HasTheIdealTriangleThroughBoxAndGaussian) {
  const double size = 2.2, aspect = GetParam();
  const auto bank = TemplateBank::build({.sample_aspect = aspect}, triangle_alternatives(), size, 1);
  ASSERT_TRUE(bank);
  // Independent second method: the same filter by supersampled area coverage (64 x 64 points per sample) and direct
  // convolution.
  const int ss = 16;
  const double sigma = 0.6;
  const int half = bank->window_samples() / 2;
  const int n = static_cast<int>(std::ceil((2 * half + 8) * std::max(1.0, aspect))) * ss;
  cv::Mat1d shape(n, n, 0.0);
  const Polygon t = triangle(size, Apex::right);
  const auto inside = [&](double x, double y) {
    int side = 0;
    for (std::size_t e = 0; e < 3; ++e) {
      const auto d = t[(e + 1) % 3] - t[e];
      side += d.x * (y - t[e].y) - d.y * (x - t[e].x) > 0 ? 1 : -1;
    }
    return std::abs(side) == 3;
  };
  const double origin = n / 2.0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      int hits = 0;
      for (int b = 0; b < 8; ++b) {
        for (int a = 0; a < 8; ++a)
          hits += inside((i + (a + 0.5) / 8 - origin) / ss, (j + (b + 0.5) / 8 - origin) / ss) ? 1 : 0;
      }
      shape(j, i) = hits / 64.0;
    }
  }
  const int reach = 4 * ss;
  // Box * Gauss sampled at k / ss.
  const auto kernel_of = [&](double box) {
    std::vector<double> values;
    const auto cdf = [&](double x) { return 0.5 * std::erfc(-x / sigma / std::numbers::sqrt2); };
    for (int k = -reach; k <= reach; ++k) {
      const double at = static_cast<double>(k) / ss;
      values.push_back((cdf(at + box / 2) - cdf(at - box / 2)) / ss);
    }
    return values;
  };
  const std::vector<double> kernel = kernel_of(1), kernel_y = kernel_of(aspect);
  cv::Mat1d rows(n, n, 0.0), blurred(n, n, 0.0);
  for (int j = reach; j < n - reach; ++j) {
    for (int i = reach; i < n - reach; ++i) {
      for (int k = -reach; k <= reach; ++k) rows(j, i) += kernel[static_cast<std::size_t>(k + reach)] * shape(j, i - k);
    }
  }
  const int dx = 3;  // search place: 3/8 of a sample to the right, 1/8 up
  const int dy = -1;
  std::vector<double> expected;
  for (int j = 0; j < 2 * half; ++j) {
    for (int i = 0; i < 2 * half; ++i) {
      const double x = (i - half + 0.5 - dx / 8.0) * ss + origin - 0.5;
      const double y = (j - half + 0.5 - dy / 8.0) * aspect * ss + origin - 0.5;
      // x and y may fall between cells: linear between the two neighbours in each direction.
      double value = 0;
      for (const int a : {0, 1}) {
        for (const int b : {0, 1}) {
          const int column = static_cast<int>(std::floor(x)) + a;
          const int row = static_cast<int>(std::floor(y)) + b;
          double sum = 0;
          for (int k = -reach; k <= reach; ++k) {
            const int r = row - k;
            if (r >= 0 && r < n) sum += kernel_y[static_cast<std::size_t>(k + reach)] * rows(r, column);
          }
          const double share_x = x - std::floor(x), share_y = y - std::floor(y);
          value += sum * (a == 0 ? 1 - share_x : share_x) * (b == 0 ? 1 - share_y : share_y);
        }
      }
      expected.push_back(value);
    }
  }
  double mean = 0, energy = 0;
  for (const double v : expected) mean += v / static_cast<double>(expected.size());
  for (double& v : expected) {
    v -= mean;
    energy += v * v;
  }

  const cv::Mat1f actual = bank->image(static_cast<int>(Apex::right), (dy + 8) * 17 + dx + 8);

  double largest = 0;
  for (int s = 0; s < static_cast<int>(expected.size()); ++s) {
    const double e = expected[static_cast<std::size_t>(s)] / std::sqrt(energy);
    largest = std::max(largest, std::abs(e - static_cast<double>(actual(s / (2 * half), s % (2 * half)))));
  }
  // Second method: cells of 1/16 sample and averaging of neighbours blur by (1/16)^2 / 4 of a second derivative below
  // 3: 3e-3 / 4.
  EXPECT_LT(largest, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(All, TemplateBankOfSamples, ::testing::Values(1.0, 1.25, 0.75),
                         [](const auto& one) { return "Aspect" + std::to_string(static_cast<int>(100 * one.param)); });

TEST(TemplateBank, ProjectionEqualsTheSumOfProducts) {
  const auto bank = TemplateBank::build({}, triangle_alternatives(), 1.3, 1);
  const int n = bank->window_samples();
  std::vector<float> patch(static_cast<std::size_t>(n * n));
  RandomStream(1, "patch").fill_normal(patch);
  std::vector<float> scores(bank->padded_templates());

  bank->project(patch, scores);

  for (const int o : {0, 3}) {
    for (const int place : {0, 100, 288}) {
      const cv::Mat1f t = bank->image(o, place);
      double sum = 0;
      for (int s = 0; s < n * n; ++s)
        sum += static_cast<double>(t(s / n, s % n)) * static_cast<double>(patch[static_cast<std::size_t>(s)]);
      EXPECT_NEAR(static_cast<double>(scores[static_cast<std::size_t>(o * 289 + place)]), sum, 2e-6);
    }
  }
}

TEST(TemplateBank, RefusesATargetThatIsTooLargeForItsMemory) {
  const auto bank = TemplateBank::build({}, triangle_alternatives(), 500, 1);

  ASSERT_FALSE(bank.has_value());
  EXPECT_EQ(bank.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
