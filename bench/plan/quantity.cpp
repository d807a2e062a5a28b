// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/quantity.h"

#include <algorithm>
#include <array>

namespace todbench {
namespace {

constexpr std::array table{
    Quantity{.name = "netd",
             .unit = "K",
             .title = "NETD (temporal noise over the temperature scale)",
             .definition = "Temporal noise of a pixel divided by the slope of the signal transfer.",
             .measure = "noise",
             .second_measure = "transfer",
             .at_most = {"netd", "NETD at most "},
             .stated = StatedUncertainty::scale},
    Quantity{.name = "temporal_noise",
             .unit = "K",
             .title = "Temporal noise of a pixel",
             .definition = "Root of the mean variance of a pixel over the frames at a contrast of 0.",
             .measure = "noise",
             .at_most = {"temporal_noise", "temporal noise of a pixel at most "},
             .stated = StatedUncertainty::camera_scale},
    Quantity{
        .name = "noise_t",
        .unit = "K",
        .title = "3-D noise t: whole frames",
        .definition =
            "Standard deviation of the means of whole frames: component t of the 3-D noise (D'Agostino and Webb 1991).",
        .measure = "noise",
        .at_most = {"noise_t", "3-D noise t at most "},
        .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "noise_v",
             .unit = "K",
             .title = "3-D noise v: fixed rows",
             .definition =
                 "Standard deviation of the means of rows: component v of the 3-D noise (D'Agostino and Webb 1991).",
             .measure = "noise",
             .at_most = {"noise_v", "3-D noise v at most "},
             .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "noise_h",
             .unit = "K",
             .title = "3-D noise h: fixed columns",
             .definition =
                 "Standard deviation of the means of columns: component h of the 3-D noise (D'Agostino and Webb 1991).",
             .measure = "noise",
             .at_most = {"noise_h", "3-D noise h at most "},
             .stated = StatedUncertainty::camera_scale},
    Quantity{
        .name = "noise_tv",
        .unit = "K",
        .title = "3-D noise tv: rows in time",
        .definition =
            "Standard deviation of rows from frame to frame: component tv of the 3-D noise (D'Agostino and Webb 1991).",
        .measure = "noise",
        .at_most = {"noise_tv", "3-D noise tv at most "},
        .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "noise_th",
             .unit = "K",
             .title = "3-D noise th: columns in time",
             .definition = "Standard deviation of columns from frame to frame: component th of the 3-D noise "
                           "(D'Agostino and Webb 1991).",
             .measure = "noise",
             .at_most = {"noise_th", "3-D noise th at most "},
             .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "noise_vh",
             .unit = "K",
             .title = "3-D noise vh: fixed pattern",
             .definition = "Standard deviation of pixels that is the same in every frame: component vh of the 3-D "
                           "noise (D'Agostino and Webb 1991).",
             .measure = "noise",
             .at_most = {"noise_vh", "3-D noise vh at most "},
             .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "noise_tvh",
             .unit = "K",
             .title = "3-D noise tvh: pixels in time",
             .definition = "Standard deviation of pixels from frame to frame: component tvh of the 3-D noise "
                           "(D'Agostino and Webb 1991).",
             .measure = "noise",
             .at_most = {"noise_tvh", "3-D noise tvh at most "},
             .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "transfer_slope",
             .unit = "K/K",
             .title = "Temperature scale (SiTF slope): observed over shown contrast",
             .definition =
                 "Slope of the line through observed contrast over the contrast that the target reports, times the "
                 "transmittance of air and collimator if the plan states it.",
             .measure = "transfer",
             .at_least = {"temperature_scale_at_least", "observed contrast over shown contrast at least "},
             .at_most = {"temperature_scale_at_most", "observed contrast over shown contrast at most "},
             .stated = StatedUncertainty::scale},
    Quantity{.name = "mtf_x",
             .unit = "1",
             .title = "MTF along x at the frequency of the plan",
             .definition = "Modulus of the transfer function along x at one frequency, from a slanted edge (in the "
                           "spirit of ISO 12233:2023).",
             .measure = "mtf",
             .at_least = {"mtf_x", "MTF along x at the frequency of the plan at least "}},
    Quantity{.name = "mtf_y",
             .unit = "1",
             .title = "MTF along y at the frequency of the plan",
             .definition = "Modulus of the transfer function along y at one frequency, from a slanted edge (in the "
                           "spirit of ISO 12233:2023).",
             .measure = "mtf",
             .at_least = {"mtf_y", "MTF along y at the frequency of the plan at least "}},
    Quantity{
        .name = "ctf_x",
        .unit = "1",
        .title = "CTF of four bars along x, best sampling phase",
        .definition =
            "Modulation of four bars along x over the contrast of large areas, largest over the sampling phases.",
        .measure = "ctf",
        .at_least = {"ctf_x", "CTF along x of the bars nearest to the frequency of the plan, best phase, at least "}},
    Quantity{
        .name = "ctf_y",
        .unit = "1",
        .title = "CTF of four bars along y, best sampling phase",
        .definition =
            "Modulation of four bars along y over the contrast of large areas, largest over the sampling phases.",
        .measure = "ctf",
        .at_least = {"ctf_y", "CTF along y of the bars nearest to the frequency of the plan, best phase, at least "}},
    Quantity{.name = "ctf_worst_x",
             .unit = "1",
             .title = "CTF along x, worst sampling phase",
             .definition =
                 "Modulation of four bars along x over the contrast of large areas, smallest over the sampling "
                 "phases.",
             .measure = "ctf",
             .at_least = {"ctf_worst_x",
                          "CTF along x of the bars nearest to the frequency of the plan, worst phase, at least "}},
    Quantity{.name = "ctf_worst_y",
             .unit = "1",
             .title = "CTF along y, worst sampling phase",
             .definition =
                 "Modulation of four bars along y over the contrast of large areas, smallest over the sampling "
                 "phases.",
             .measure = "ctf",
             .at_least = {"ctf_worst_y",
                          "CTF along y of the bars nearest to the frequency of the plan, worst phase, at least "}},
    Quantity{.name = "source_size_loss",
             .unit = "1",
             .title = "Size-of-source effect: loss of a small source",
             .definition =
                 "Share of the signal that a square source of the side in the plan loses against the reference "
                 "aperture, in the middle of each (direct and inverse method, after IEC TS 63144-1:2020, known "
                 "from its abstract).",
             .measure = "source_size",
             .at_most = {"source_size_loss", "loss of a small source by the size-of-source effect at most "},
             .absolute = true},
    Quantity{
        .name = "netd_extended",
        .unit = "K",
        .title = "NETD on an extended source",
        .definition = "Temporal noise of a pixel divided by the slope of the signal transfer on an extended source.",
        .measure = "noise",
        .second_measure = "source_size",
        .at_most = {"netd_extended", "NETD on an extended source at most "},
        .stated = StatedUncertainty::scale},
    Quantity{.name = "transfer_slope_extended",
             .unit = "K/K",
             .title = "Slope of the signal transfer on an extended source",
             .definition =
                 "Signal in the middle of the reference aperture divided by the contrast that the target reports, "
                 "times the transmittance of air and collimator if the plan states it.",
             .measure = "source_size",
             .at_least = {"temperature_scale_extended_at_least",
                          "observed over shown contrast on an extended source at least "},
             .at_most = {"temperature_scale_extended_at_most",
                         "observed over shown contrast on an extended source at most "},
             .stated = StatedUncertainty::scale},
    Quantity{.name = "mrtd_x",
             .unit = "K",
             .title = "MRTD along x, of the bars nearest to the frequency of the plan",
             .definition =
                 "Half the difference of the contrasts of both polarities at which the observer distinguishes "
                 "four bars along x from five of the same square in 75 % of two-interval decisions (Bijl and "
                 "Valeton 1999; target and half difference after STANAG 4349, known second-hand).",
             .measure = "mrtd",
             .at_most = {"mrtd_x", "MRTD along x of the bars nearest to the frequency of the plan at most "},
             .stated = StatedUncertainty::scale},
    Quantity{.name = "mrtd_y",
             .unit = "K",
             .title = "MRTD along y, of the bars nearest to the frequency of the plan",
             .definition =
                 "Half the difference of the contrasts of both polarities at which the observer distinguishes "
                 "four bars along y from five of the same square in 75 % of two-interval decisions (Bijl and "
                 "Valeton 1999; target and half difference after STANAG 4349, known second-hand).",
             .measure = "mrtd",
             .at_most = {"mrtd_y", "MRTD along y of the bars nearest to the frequency of the plan at most "},
             .stated = StatedUncertainty::scale},
    Quantity{.name = "mdtd",
             .unit = "K",
             .title = "MDTD of the spot nearest to the size of the plan",
             .definition = "Half the difference of the contrasts of both polarities at which the observer finds a "
                           "square spot in 75 % of two-interval decisions (in the spirit of ASTM E1311, known from its "
                           "abstract).",
             .measure = "mrtd",
             .at_most = {"mdtd", "MDTD of the spot nearest to the size of the plan at most "},
             .stated = StatedUncertainty::scale},
    Quantity{
        .name = "ifov_x",
        .unit = "mrad",
        .title = "IFOV along x, from the positions of the triangles",
        .definition = "Angle per pixel along x in the middle of the plate: scale of the picture over the distance.",
        .measure = "geometry",
        .at_least = {"ifov_x_at_least", "IFOV along x at least "},
        .at_most = {"ifov_x_at_most", "IFOV along x at most "},
        .stated = StatedUncertainty::distance},
    Quantity{
        .name = "ifov_y",
        .unit = "mrad",
        .title = "IFOV along y, from the positions of the triangles",
        .definition = "Angle per pixel along y in the middle of the plate: scale of the picture over the distance.",
        .measure = "geometry",
        .at_least = {"ifov_y_at_least", "IFOV along y at least "},
        .at_most = {"ifov_y_at_most", "IFOV along y at most "},
        .stated = StatedUncertainty::distance},
    Quantity{.name = "field_of_view_x",
             .unit = "deg",
             .title = "Field of view along x",
             .definition =
                 "Angle between the outer borders of the first and the last pixel along x, through the middle "
                 "of the picture: IFOV and distortion, continued beyond the plate (OIML R 141:2008, 2.7, known "
                 "from its contents).",
             .measure = "geometry",
             .at_least = {"field_of_view_x_at_least", "field of view along x at least "},
             .at_most = {"field_of_view_x_at_most", "field of view along x at most "},
             .stated = StatedUncertainty::distance},
    Quantity{.name = "field_of_view_y",
             .unit = "deg",
             .title = "Field of view along y",
             .definition =
                 "Angle between the outer borders of the first and the last pixel along y, through the middle "
                 "of the picture: IFOV and distortion, continued beyond the plate (OIML R 141:2008, 2.7, known "
                 "from its contents).",
             .measure = "geometry",
             .at_least = {"field_of_view_y_at_least", "field of view along y at least "},
             .at_most = {"field_of_view_y_at_most", "field of view along y at most "},
             .stated = StatedUncertainty::distance},
    Quantity{.name = "aspect_ratio",
             .unit = "1",
             .title = "Aspect ratio of a pixel",
             .definition = "IFOV along x over IFOV along y.",
             .measure = "geometry",
             .at_least = {"aspect_ratio_at_least", "aspect ratio of a pixel at least "},
             .at_most = {"aspect_ratio_at_most", "aspect ratio of a pixel at most "}},
    Quantity{.name = "distortion",
             .unit = "%",
             .title = "Radial distortion at the corner of the picture",
             .definition = "Relative radial displacement at the corner of the picture by the first term of Brown "
                           "(1966), positive for a pincushion.",
             .measure = "geometry",
             .at_most = {"distortion", "distortion at the corner, of either sign, at most "},
             .absolute = true},
    Quantity{
        .name = "drift_rate",
        .unit = "K/min",
        .title = "Drift of the mean after a correction",
        .definition = "Fitted change of the mean of a flat field after a correction, over the time of the observation.",
        .measure = "drift",
        .at_most = {"drift_rate", "drift of the mean after a correction, of either sign, at most "},
        .stated = StatedUncertainty::camera_scale,
        .absolute = true},
    Quantity{
        .name = "drift_pattern_rate",
        .unit = "K/min",
        .title = "Growth of the spatial noise after a correction",
        .definition =
            "Fitted growth of the spatial noise without shading after a correction, over the time of the observation.",
        .measure = "drift",
        .at_most = {"drift_pattern_rate", "growth of the spatial noise after a correction at most "},
        .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "response_time",
             .unit = "ms",
             .title = "Response time: time constant of the step response",
             .definition = "Time constant of a first-order response to contrast steps.",
             .measure = "response",
             .at_most = {"response_time", "response time at most "}},
    Quantity{.name = "shading_range",
             .unit = "K",
             .title = "Shading over the plate, removed",
             .definition = "Range of the second-order surface fitted to the mean frame.",
             .measure = "noise",
             .at_most = {"shading_range", "shading over the plate at most "},
             .stated = StatedUncertainty::camera_scale},
    Quantity{.name = "absolute_error",
             .unit = "K",
             .title = "Error of the absolute temperature, largest over the range",
             .definition = "Mean temperature of the picture minus that of the black body, at the temperature with the "
                           "largest value of either sign (IEC 80601-2-59, VDI/VDE 5585-2, known from abstracts).",
             .measure = "absolute",
             .at_most = {"absolute_error", "error of the absolute temperature, of either sign, at most "},
             .absolute = true},
    Quantity{.name = "absolute_slope",
             .unit = "K/K",
             .title = "Slope of the absolute temperature scale",
             .definition = "Slope of the line through the temperature of the picture over that of the black body.",
             .measure = "absolute",
             .at_least = {"absolute_slope_at_least", "slope of the absolute temperature scale at least "},
             .at_most = {"absolute_slope_at_most", "slope of the absolute temperature scale at most "}},
    Quantity{.name = "repeatability",
             .unit = "K",
             .title = "Repeatability of a temperature",
             .definition = "Standard deviation of the mean temperature of a picture, from rising and falling "
                           "temperatures of the black body.",
             .measure = "absolute",
             .at_most = {"repeatability", "repeatability of a temperature at most "}},
    Quantity{.name = "ietd",
             .unit = "K",
             .title = "Inequivalent temperature difference (IETD)",
             .definition = "Largest standard deviation of the fixed pattern over the temperatures, without shading and "
                           "temporal noise, divided by the slope of the scale (after VDI/VDE 5585, known from "
                           "abstracts).",
             .measure = "absolute",
             .at_most = {"ietd", "inequivalent temperature difference at most "}},
    Quantity{.name = "prnu",
             .unit = "%",
             .title = "Non-uniformity of the responsivity (PRNU)",
             .definition = "Standard deviation of the responsivity over the pixels divided by its mean, without "
                           "shading and temporal noise.",
             .measure = "absolute",
             .at_most = {"prnu", "non-uniformity of the responsivity at most "}},
    Quantity{.name = "camera_pattern",
             .unit = "K",
             .title = "Fixed pattern of the camera, told apart from the black body",
             .definition = "Standard deviation of the part of the picture that stays when the black body is shifted, "
                           "without a linear slope (data reference method).",
             .measure = "absolute",
             .at_most = {"camera_pattern", "fixed pattern of the camera at most "}},
    Quantity{.name = "frame_rate",
             .unit = "Hz",
             .title = "Frame rate",
             .definition = "Inverse slope of the line through the times of the frames over their numbers.",
             .measure = "timing",
             .at_least = {"frame_rate_at_least", "frame rate at least "},
             .at_most = {"frame_rate_at_most", "frame rate at most "}},
    Quantity{.name = "frame_jitter",
             .unit = "ms",
             .title = "Jitter of the frames",
             .definition = "Standard deviation of the times of the frames from a line over their numbers.",
             .measure = "timing",
             .at_most = {"frame_jitter", "jitter of the frames at most "}},
    Quantity{.name = "lost_frames",
             .unit = "1",
             .title = "Lost frames",
             .definition = "Number of frames that did not arrive during the observation.",
             .measure = "timing",
             .at_most = {"lost_frames", "lost frames at most "}},
    Quantity{.name = "latency",
             .unit = "ms",
             .title = "Latency of the time stamps",
             .definition = "Time from a place of a moving target to the time stamp of the frame that shows it, with "
                           "the time constant and half of the exposure of the detector.",
             .measure = "latency",
             .at_most = {"latency", "latency of the time stamps at most "}},
    Quantity{.name = "absolute_offset",
             .unit = "K",
             .title = "Offset of the absolute temperature scale",
             .definition = "Error of the line of the absolute temperature scale in the middle of the range.",
             .measure = "absolute",
             .at_most = {"absolute_offset", "offset of the absolute temperature scale, of either sign, at most "},
             .absolute = true},
    Quantity{.name = "source_pattern",
             .unit = "K",
             .title = "Unevenness of the black body, told apart from the camera",
             .definition = "Standard deviation of the part of the picture that moves with the black body, without a "
                           "linear slope.",
             .measure = "absolute",
             .at_most = {"source_pattern", "unevenness of the black body at most "}},
    Quantity{.name = "dynamic_range",
             .unit = "dB",
             .title = "Dynamic range",
             .definition = "20 log10 of the temperatures from the lowest to the highest count over the temporal noise "
                           "of a pixel.",
             .measure = "absolute",
             .at_least = {"dynamic_range", "dynamic range at least "}},
    Quantity{.name = "range_low",
             .unit = "K",
             .title = "Lowest temperature of the scale",
             .definition = "Temperature of the lowest count.",
             .measure = "absolute",
             .at_most = {"range_low", "lowest temperature of the scale at most "}},
    Quantity{.name = "range_high",
             .unit = "K",
             .title = "Highest temperature of the scale",
             .definition = "Temperature of the highest count.",
             .measure = "absolute",
             .at_least = {"range_high", "highest temperature of the scale at least "}},
    Quantity{.name = "gain_settling_time",
             .unit = "ms",
             .title = "Settling of the automatic gain: time constant",
             .definition = "Time constant of the level round the target after steps of its contrast.",
             .measure = "gain_control",
             .at_most = {"gain_settling_time", "time constant of the automatic gain at most "}},
    Quantity{.name = "gain_ratio",
             .unit = "1",
             .title = "Automatic gain: gain at the largest over gain at the smallest contrast",
             .definition = "Contrast of the picture over that of the target at the largest contrast of the plan, "
                           "divided by the same at the smallest; 1 for a fixed gain.",
             .measure = "gain_control",
             .at_least = {"gain_ratio", "gain at the largest over gain at the smallest contrast at least "}},
    Quantity{.name = "mtf50_x",
             .unit = "1/mrad",
             .title = "Frequency of MTF 0.5 along x",
             .definition = "Lowest frequency at which the MTF along x is 0.5.",
             .measure = "mtf",
             .at_least = {"mtf50_x", "frequency of MTF 0.5 along x at least "}},
    Quantity{.name = "mtf50_y",
             .unit = "1/mrad",
             .title = "Frequency of MTF 0.5 along y",
             .definition = "Lowest frequency at which the MTF along y is 0.5.",
             .measure = "mtf",
             .at_least = {"mtf50_y", "frequency of MTF 0.5 along y at least "}},
    Quantity{.name = "mrtd_mean",
             .unit = "K",
             .title = "MRTD, mean of both axes",
             .definition = "Mean of the MRTD along x and along y, of the bars nearest to the frequency of the plan.",
             .measure = "mrtd",
             .at_most = {"mrtd_mean", "mean of the MRTD along x and along y at most "},
             .stated = StatedUncertainty::scale},
    Quantity{.name = "orientation",
             .unit = "%",
             .title = "Difference of the thresholds of the axes",
             .definition = "Threshold of triangles that point up or down over that of triangles that point left or "
                           "right, minus 1, at the contrast with the largest difference of either sign.",
             .at_most = {"orientation", "difference of the thresholds of the axes, of either sign, at most "},
             .absolute = true},
    Quantity{"netd_model", "K", "NETD, closed form of the sensor model",
             "Temporal noise of one frame of the sensor model in closed form, for a correct temperature scale.",
             "noise"},
    Quantity{"lag1_correlation", "1", "Correlation of a pixel in successive frames",
             "Correlation coefficient of the temporal noise of a pixel in successive frames.", "noise"},
    Quantity{"noise_counts", "counts", "Temporal noise in quantization steps",
             "Temporal noise of a pixel divided by the temperature of one count.", "noise"},
    Quantity{"camera_temperature", "C", "Temperature of the camera by its own sensor",
             "Mean temperature that the camera reports during the absolute temperatures, in degrees Celsius.",
             "absolute"},
    Quantity{"transfer_offset", "K", "Temperature scale (SiTF): offset",
             "Observed contrast at a shown contrast of 0, by the line of the signal transfer.", "transfer"},
    Quantity{"transfer_nonlinearity", "%", "Temperature scale (SiTF): nonlinearity",
             "Largest residual of the line of the signal transfer over its span between the outermost steps.",
             "transfer"},
    Quantity{"mtf_x_model", "1", "MTF along x, closed form of the sensor model",
             "Modulus of the transfer function of the sensor model along the normal of the edge, axis x.", "mtf"},
    Quantity{"mtf_y_model", "1", "MTF along y, closed form of the sensor model",
             "Modulus of the transfer function of the sensor model along the normal of the edge, axis y.", "mtf"},
    Quantity{"ctf_mean_x", "1", "CTF along x, mean of the sampling phases",
             "Modulation of four bars along x over the contrast of large areas, mean over the sampling phases.", "ctf"},
    Quantity{"ctf_x_model", "1", "CTF along x, best phase, closed form of the sensor model",
             "Largest modulation over the sampling phases of four bars along x, from the transfer function of the "
             "sensor model.",
             "ctf"},
    Quantity{"ctf_worst_x_model", "1", "CTF along x, worst phase, closed form of the sensor model",
             "Smallest modulation over the sampling phases of four bars along x, from the transfer function of the "
             "sensor model.",
             "ctf"},
    Quantity{"ctf_mean_y", "1", "CTF along y, mean of the sampling phases",
             "Modulation of four bars along y over the contrast of large areas, mean over the sampling phases.", "ctf"},
    Quantity{"ctf_y_model", "1", "CTF along y, best phase, closed form of the sensor model",
             "Largest modulation over the sampling phases of four bars along y, from the transfer function of the "
             "sensor model.",
             "ctf"},
    Quantity{"ctf_worst_y_model", "1", "CTF along y, worst phase, closed form of the sensor model",
             "Smallest modulation over the sampling phases of four bars along y, from the transfer function of the "
             "sensor model.",
             "ctf"},
    Quantity{"source_size_loss_model", "1", "Size-of-source effect, closed form of the sensor model",
             "Loss of a square source against the reference aperture in the image of the sensor model.", "source_size"},
    Quantity{"ifov_stated", "mrad", "IFOV stated in the plan", "Angle per pixel that the plan states.", "geometry"},
    Quantity{"ifov_model", "mrad", "IFOV of the sensor model", "Angle per sample of the sensor model.", "geometry"},
    Quantity{"plate_rotation", "deg", "Rotation of the plate in the picture, clockwise",
             "Clockwise rotation of the plate in the picture, by the fitted homography.", "geometry"},
    Quantity{"keystone_x", "%",
             "Keystone: scale at the right border of the plate over scale at the left border, minus 1",
             "Scale at the right border of the plate over that at its left border, minus 1, by the fitted homography.",
             "geometry"},
    Quantity{"keystone_y", "%",
             "Keystone: scale at the lower border of the plate over scale at the upper border, minus 1",
             "Scale at the lower border of the plate over that at its upper border, minus 1, by the fitted homography.",
             "geometry"},
    Quantity{"distortion_model", "%", "Radial distortion at the corner of the picture, sensor model",
             "Relative radial displacement at the corner of the picture, sum of both terms of the sensor model.",
             "geometry"},
    Quantity{"geometry_residual", "px", "Positions of the triangles: residual after the lens fit",
             "Root mean square of a coordinate of the triangles after the fit of homography and distortion.",
             "geometry"},
    Quantity{"drift_time_constant", "s", "Drift of the mean: time constant",
             "Time constant of an exponential approach of the mean after a correction.", "drift"},
    Quantity{"drift_pattern_time_constant", "s", "Growth of the spatial noise: time constant",
             "Time constant of an exponential approach of the spatial noise after a correction.", "drift"},
    Quantity{"response_time_rise", "ms", "Response time of rising steps",
             "Time constant of a first-order response to rising contrast steps.", "response"},
    Quantity{"response_time_fall", "ms", "Response time of falling steps",
             "Time constant of a first-order response to falling contrast steps.", "response"},
    Quantity{"response_time_model", "ms", "Response time of the sensor model", "Time constant of the sensor model.",
             "response"},
    Quantity{"bad_pixels", "1", "Bad pixels", "Number of pixels that are stuck, dead, hot, noisy or blinking.",
             "pixels"},
    Quantity{"substituted_pixels", "1", "Substituted pixels",
             "Number of pixels that the camera has replaced by their neighbours.", "pixels"},
    Quantity{"defect_clusters", "1", "Clusters of defective pixels",
             "Number of clusters of at least two touching bad or substituted pixels.", "pixels"},
    Quantity{"largest_cluster", "1", "Largest cluster, pixels",
             "Number of bad and substituted pixels in the largest cluster.", "pixels"},
    Quantity{"operability", "%", "Operability", "Share of the observed pixels that are not bad.", "pixels"},
    Quantity{"pixels_stuck", "1", "Stuck pixels", "Number of pixels whose count never changes.", "pixels"},
    Quantity{"pixels_offset", "1", "Dead or hot pixels, by level",
             "Number of pixels whose level is too far from the median.", "pixels"},
    Quantity{"pixels_unresponsive", "1", "Dead pixels, by response",
             "Number of pixels whose response to contrast is too far from the median.", "pixels"},
    Quantity{"pixels_noisy", "1", "Noisy pixels",
             "Number of pixels whose temporal noise is too large a multiple of the median.", "pixels"},
    Quantity{"pixels_blinking", "1", "Blinking pixels",
             "Number of pixels whose largest change of level is too large a multiple of the median.", "pixels"},
    Quantity{"mrtd_best_phase_x", "K", "MRTD along x at the best sampling phase (MTDP-like)",
             "MRTD along x at the sampling phase of the bars that answers best; not the MTDP of TRM.", "mrtd"},
    Quantity{"mrtd_best_phase_y", "K", "MRTD along y at the best sampling phase (MTDP-like)",
             "MRTD along y at the sampling phase of the bars that answers best; not the MTDP of TRM.", "mrtd"},
    Quantity{"picture_residual", "K", "Picture of the plate against the sensor model: residual",
             "Root mean square difference between the mean picture of the plate and that of the sensor model without "
             "noise."},
    Quantity{"picture_residual_over_noise", "1", "Picture of the plate: residual over the temporal noise of the mean",
             "Residual of the picture of the plate over the temporal noise that remains in the mean of its frames."},
    Quantity{"scene_ratio", "1", "Response to triangles with a hot bar in the field, over the response without it",
             "Contrast of triangles with a hot bar in the field over their contrast without it."},
};

const Quantity* quantity_if(std::string_view name, bool limited) {
  const std::string_view base = name.substr(0, name.find(" ("));
  const auto* const found = std::find_if(table.begin(), table.end(), [&](const Quantity& one) {
    return one.name == base && (!limited || one.can_be_limited());
  });
  return found == table.end() ? nullptr : found;
}

}  // namespace

std::span<const Quantity> quantities() {
  return table;
}

const Quantity* find_quantity(std::string_view name) {
  return quantity_if(name, false);
}

const Quantity* find_limited_quantity(std::string_view name) {
  const Quantity* found = quantity_if(name, true);
  return found != nullptr && found->name == name ? found : nullptr;
}

std::vector<std::string> limited_quantity_names() {
  std::vector<std::string> names;
  for (const Quantity& quantity : table)
    if (quantity.can_be_limited()) names.emplace_back(quantity.name);
  return names;
}

double relative_u(const Plan& plan, StatedUncertainty stated) {
  switch (stated) {
    case StatedUncertainty::none:
      return 0;
    case StatedUncertainty::camera_scale:
      return relative_u_of_camera_scale(plan);
    case StatedUncertainty::scale:
      return relative_u_of_scale(plan);
    case StatedUncertainty::distance:
      return relative_u_of_distance(plan);
  }
  return 0;
}

}  // namespace todbench
