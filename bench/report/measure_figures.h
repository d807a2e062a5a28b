// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of the physical measures in the report. Each measure has one function, defined in the file of the measure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

// Each function returns the figures of the camera (or of the simulated sensor, if `camera` is false) and of the twin;
// empty if the measure exists for neither of them.

/// Returns figures of the signal transfer.
[[nodiscard]] std::optional<FigurePairs> transfer_figures(const SessionMeasures& measures, bool camera);
/// Returns one figure for each position and axis: camera with intervals, twin, closed form.
[[nodiscard]] std::optional<FigurePairs> mtf_figures(const SessionMeasures& measures, bool camera);
/// Returns figures of the drift; for the camera only.
[[nodiscard]] std::optional<FigurePairs> drift_figures(const SessionMeasures& measures, bool camera);
/// Returns figures of the response to contrast steps.
[[nodiscard]] std::optional<FigurePairs> response_figures(const SessionMeasures& measures, bool camera);
/// Returns figures of the distortion.
[[nodiscard]] std::optional<FigurePairs> geometry_figures(const SessionMeasures& measures, bool camera);
/// Returns one figure for each axis: best and worst sampling phase of every group of bars, and the closed form.
[[nodiscard]] std::optional<FigurePairs> ctf_figures(const SessionMeasures& measures, bool camera);
/// Returns figures of the loss of apertures and the gain of opaque spots against their size, with the fitted curve.
[[nodiscard]] std::optional<FigurePairs> source_size_figures(const SessionMeasures& measures, bool camera);
/// Returns figures of the temperature error against temperature; for the camera only.
[[nodiscard]] std::optional<FigurePairs> absolute_figures(const SessionMeasures& measures, bool camera);
/// Returns histograms of the latency over the frames of all runs; for the camera only.
[[nodiscard]] std::optional<FigurePairs> latency_figures(const SessionMeasures& measures, bool camera);
/// Returns figures of the levels against contrast and of the settling after steps; for the camera only.
[[nodiscard]] std::optional<FigurePairs> gain_control_figures(const SessionMeasures& measures, bool camera);
/// Returns a figure of the remaining part of contrast steps over time, with the fitted first-order response; empty if
/// it cannot be drawn.
[[nodiscard]] std::optional<Figure> settling_figure(const StepResponse& response, const std::string& id,
                                                    const std::string& who);
/// Returns one figure of the MRTD for each axis, including the MRTD at the best phase, and one figure of the spots.
[[nodiscard]] std::optional<FigurePairs> mrtd_figures(const SessionMeasures& measures, bool camera);
/// Returns a contrast with three digits, or "none".
[[nodiscard]] RichText contrast_cell(const std::optional<double>& value);
/// Returns the tables of bars and spots in the layout of an acceptance document: frequency, contrast of each polarity,
/// offset, half difference of each axis, best phase. `who` names the side in the captions.
[[nodiscard]] std::vector<Table> mrtd_tables(const MrtdMeasure& mrtd, const std::string& who);
/// Returns the maps of the camera next to the maps of the twin.
[[nodiscard]] std::optional<FigurePairs> pixel_figures(const SessionMeasures& measures, bool camera);

}  // namespace todbench
