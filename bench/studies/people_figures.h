// SPDX-License-Identifier: GPL-3.0-or-later
// Single published figures of human vision, quoted with their sources.
#pragma once

namespace todbench::people {

/// Threshold of a grating with a Gaussian or nearly Gaussian envelope.
struct Grating {
  const char* study;
  double luminance_cd_m2, frequency_per_degree, sigma_deg;
  double sensitivity;  ///< 1 over luminance contrast
};

/// Static achromatic gratings at the fovea, from 0.1 to 3000 cd/m2: every third value of the data used in the fit, in
/// the order of the collection. castleCSF data, MIT licence, (c) 2023 University of Cambridge, converted from cone
/// contrast to luminance contrast.
inline constexpr Grating gratings[] = {
    {"ColorFest 2002", 40, 1.2, 0.5, 71.81},  {"ColorFest 2002", 40, 2, 0.5, 128.4},
    {"ColorFest 2002", 40, 2.8, 0.5, 155.2},  {"Wuerger 2020", 0.2, 2, 0.25, 13.73},
    {"Wuerger 2020", 0.2, 6, 0.08333, 1.929}, {"Wuerger 2020", 2, 1, 0.5, 57.27},
    {"Wuerger 2020", 20, 0.5, 1, 38.2},       {"Wuerger 2020", 20, 6, 0.08333, 14.36},
    {"Wuerger 2020", 20, 6, 0.3333, 53.23},   {"Wuerger 2020", 200, 0.5, 1, 37.03},
    {"Wuerger 2020", 200, 4, 0.5, 159.6},     {"Wuerger 2020", 200, 6, 0.08333, 28.1},
    {"Wuerger 2020", 2000, 0.5, 1, 28.47},    {"Wuerger 2020", 2000, 2, 0.25, 53.03},
    {"Mantiuk 2011", 0.2, 0.125, 1.5, 20.03}, {"Mantiuk 2011", 0.2, 0.25, 1.5, 32.06},
    {"Mantiuk 2011", 0.2, 8, 1.5, 9.193},     {"Mantiuk 2011", 0.2, 16, 1.5, 1.355},
    {"Mantiuk 2011", 2, 0.25, 1.5, 43.98},    {"Mantiuk 2011", 2, 0.5, 1.5, 107},
    {"Mantiuk 2011", 2, 1, 0.15, 20.02},      {"Mantiuk 2011", 2, 1.41, 1.5, 186},
    {"Mantiuk 2011", 2, 2.83, 1.5, 161.3},    {"Mantiuk 2011", 2, 16, 1.5, 5.402},
    {"Mantiuk 2011", 20, 1, 0.5, 71.17},      {"Mantiuk 2011", 20, 2, 1.5, 297.6},
    {"Mantiuk 2011", 20, 8, 0.5, 63.58},      {"Mantiuk 2011", 150, 2, 1.5, 257.9},
    {"Mantiuk 2011", 150, 2.83, 1.5, 274.4},  {"Robson 1966", 20, 22.63, 1.25, 17.74},
    {"Rovamo 1993", 50, 0.125, 17.51, 219.1}, {"Rovamo 1993", 50, 0.25, 2.143, 83.93},
    {"Rovamo 1993", 50, 1, 4.377, 404.2},     {"Rovamo 1993", 50, 1, 8.775, 546.6},
    {"Rovamo 1993", 50, 2, 8.875, 612.2},     {"Rovamo 1993", 50, 8, 0.5335, 255},
    {"Rovamo 1993", 50, 8, 2.084, 402.2},     {"Rovamo 1993", 50, 16, 0.03188, 7.973},
    {"Rovamo 1993", 50, 16, 0.5431, 73.94},   {"Rovamo 1993", 50, 16, 1.077, 61.22},
    {"Rovamo 1993", 50, 32, 0.06814, 3.892},  {"Virsu 1979", 10, 0.5, 2.5, 177.2},
};

/// Gratings from the same collection, measured by laboratories whose data were not used in the fit. Each value was
/// measured at the lowest temporal frequency of its study, which is below 1.1 Hz.
inline constexpr Grating other_laboratories[] = {
    {"Snowden 1995", 0.11, 0.1, 1.599, 12.34}, {"Snowden 1995", 0.11, 1, 1.599, 64.17},
    {"Snowden 1995", 2.89, 0.1, 1.599, 19.95}, {"Snowden 1995", 2.89, 1, 1.599, 156.9},
    {"Snowden 1995", 2.89, 4, 1.599, 99.11},   {"Snowden 1995", 3.85, 0.1, 1.599, 29.19},
    {"Snowden 1995", 3.85, 1, 1.599, 204},     {"Snowden 1995", 170, 0.1, 1.599, 6.247},
    {"Snowden 1995", 170, 1, 1.599, 207.7},    {"Snowden 1995", 170, 4, 1.599, 247},
    {"Snowden 1995", 236, 0.1, 1.599, 12.34},  {"Snowden 1995", 236, 1, 1.599, 70.9},
    {"Virsu 1982", 10, 1, 1, 36.45},           {"Virsu 1982", 10, 2, 1, 66.51},
    {"Virsu 1982", 10, 3.031, 1, 85.82},       {"Virsu 1982", 10, 4, 1, 88.49},
    {"Virsu 1982", 10, 6.063, 1, 76.72},       {"Virsu 1982", 10, 8, 1, 53.7},
    {"Virsu 1982", 10, 11.31, 1, 30.03},       {"Virsu 1982", 10, 16, 1, 12.76},
    {"Virsu 1982", 10, 22.63, 1, 5.819},       {"Wright 1983", 100, 2, 0.864, 203.2},
    {"Wright 1983", 100, 6, 0.864, 147.5},     {"Wright 1983", 100, 9, 0.49, 93.17},
};

/// Threshold of a disc.
struct DiscOfLight {
  double luminance_cd_m2, radius_deg, sensitivity;
};
/// Discs (Wuerger 2020) from the same collection, from 0.1 to 3000 cd/m2.
inline constexpr DiscOfLight discs[] = {
    {0.2, 0.08333, 24.03}, {20, 0.08333, 100}, {200, 0.08333, 134.2}, {0.2, 0.25, 28.75}, {2, 0.25, 80.62},
    {20, 0.25, 124.5},     {0.2, 1, 39.93},    {20, 1, 131.3},        {200, 1, 172.4},
};

/// ModelFest (Carney et al. 1999, Watson and Ahumada 2005): log10 of the sensitivity at 30 cd/m2, averaged over 16
/// people. At threshold, 84 % of the answers in a two-alternative forced choice are correct.
struct ModelFestGabor {
  double frequency_per_degree, sigma_deg, log10_sensitivity;
};
inline constexpr ModelFestGabor modelfest_gabors[] = {
    {1.12, 0.5, 1.821}, {2, 0.5, 1.960},    {2.83, 0.5, 2.063}, {4, 0.5, 2.106},    {5.66, 0.5, 1.992},
    {8, 0.5, 1.844},    {11.3, 0.5, 1.621}, {16, 0.5, 1.298},   {22.6, 0.5, 0.960}, {30, 0.5, 0.567},
    {2, 0.28, 1.769},   {4, 0.14, 1.619},   {8, 0.07, 1.193},   {16, 0.035, 0.514}};

/// Threshold of a Gaussian blob of ModelFest.
struct ModelFestBlob {
  double sigma_arcmin, log10_sensitivity;
};
inline constexpr ModelFestBlob modelfest_blobs[] = {{30, 1.636}, {8.43, 1.526}, {2.106, 1.208}, {1.05, 0.830}};
/// Stripes of 0.5 arcmin in a Gaussian window of 0.5 degrees, and a disc of 0.25 degrees diameter.
inline constexpr double modelfest_line = 0.934, modelfest_dipole = 0.626, modelfest_disc = 1.626;

/// Loss of acuity when reading Japanese text at reduced contrast, 14 people (abstract, CiNii 1522262179753702912):
/// increase of logMAR relative to full contrast.
struct ReadingLoss {
  double contrast, log_mar;
};
inline constexpr ReadingLoss reading_losses[] = {{0.4, 0.11}, {0.2, 0.21}, {0.1, 0.34}};

}  // namespace todbench::people
