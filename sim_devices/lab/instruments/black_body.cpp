// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/instruments/black_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim_devices/lab/instruments/elapsed_time.h"

namespace todbench {
namespace {

double real_difference_k(const BlackBodyOptions& options, double indicated_k) {
  return options.real_delta_t_k ? options.real_delta_t_k(indicated_k) : indicated_k;
}

// Written so that NaN fails.
bool is_valid(const BlackBodyOptions& o) {
  return o.time_constant_s > 0 && o.stable_window_k > 0 && o.stable_dwell_s >= 0 && o.resolution_k > 0 &&
         o.min_delta_t_k <= 0 && o.max_delta_t_k >= 0 && o.ambient_k > 0 && std::isfinite(o.plate_coupling) &&
         std::isfinite(real_difference_k(o, o.min_delta_t_k)) && std::isfinite(real_difference_k(o, o.max_delta_t_k)) &&
         o.now;
}

}  // namespace

Result<std::unique_ptr<BlackBody>> BlackBody::start(BlackBodyOptions options) {
  if (!is_valid(options))
    return fail(ErrorCode::invalid_input, "black body " + options.serial +
                                              ": time constant, window and resolution must be positive, the limits "
                                              "must enclose 0 and all numbers must be finite");
  const Settling at_rest{0, 0, options.now() - std::chrono::hours(24), options.stable_window_k};
  auto server_options = options.server;
  auto black_body = std::make_unique<BlackBody>(std::move(options), at_rest);
  auto server = ScpiServer::start(std::move(server_options), black_body->language());
  if (!server) return fail("starting the emulated black body", server.error());
  black_body->server_ = std::move(*server);
  return black_body;
}

BlackBody::BlackBody(BlackBodyOptions options, Settling settling) : options_(std::move(options)), settling_(settling) {}

double BlackBody::indicated(const Settling& settling, std::chrono::steady_clock::time_point time) const {
  const double elapsed_s = seconds_between(settling.since, time);
  return settling.set_point_k +
         (settling.start_k - settling.set_point_k) * std::exp(-elapsed_s / options_.time_constant_s);
}

BlackBody::Settling BlackBody::settling() const {
  const std::scoped_lock lock(mutex_);
  return settling_;
}

BlackBodyState BlackBody::state() const {
  const auto time = options_.now();
  const Settling current = settling();
  BlackBodyState state;
  state.set_point_k = current.set_point_k;
  state.indicated_delta_t_k = indicated(current, time);
  state.delta_t_k = real_difference_k(options_, state.indicated_delta_t_k);
  state.plate_temperature_k = options_.ambient_k + options_.plate_coupling * state.delta_t_k;
  state.black_body_temperature_k = state.plate_temperature_k + state.delta_t_k;
  // The exponential enters the window at tau ln(gap/window) and never leaves it.
  const double gap_k = std::abs(current.start_k - current.set_point_k);
  const double entered_s =
      gap_k > current.window_k ? options_.time_constant_s * std::log(gap_k / current.window_k) : 0.0;
  state.is_stable = seconds_between(current.since, time) >= entered_s + options_.stable_dwell_s;
  return state;
}

void BlackBody::set_point(double delta_t_k) {
  const auto time = options_.now();
  const double rounded = std::round(delta_t_k / options_.resolution_k) * options_.resolution_k;
  const std::scoped_lock lock(mutex_);
  if (rounded == settling_.set_point_k) return;  // a repeated set-point does not restart the dwell
  settling_.start_k = indicated(settling_, time);
  settling_.set_point_k = rounded;
  settling_.since = std::max(time, settling_.since);
}

double BlackBody::radiator_k(double delta_t_k) const {
  return options_.ambient_k + (1 + options_.plate_coupling) * delta_t_k;
}

double BlackBody::difference_k(double radiator_k) const {
  return (radiator_k - options_.ambient_k) / (1 + options_.plate_coupling);
}

ScpiLanguage BlackBody::language() {
  using Parameters = std::span<const std::string>;
  const auto number = [this](double BlackBodyState::*value) {
    return [this, value](Parameters parameters) -> ScpiAnswer {
      if (auto count = scpi_count(parameters, 0); !count) return tl::unexpected(count.error());
      return scpi_decimal(state().*value, 4);
    };
  };
  const auto set = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 1); !count) return tl::unexpected(count.error());
    const auto value = scpi_number(parameters[0], options_.min_delta_t_k, options_.max_delta_t_k, "K");
    if (!value) return tl::unexpected(value.error());
    set_point(*value);
    return "";
  };
  const auto get = [this](Parameters parameters) -> ScpiAnswer {
    if (parameters.empty()) return scpi_decimal(settling().set_point_k, 4);
    if (auto count = scpi_count(parameters, 1); !count) return tl::unexpected(count.error());
    if (scpi_keyword(parameters[0], "MINimum")) return scpi_decimal(options_.min_delta_t_k, 4);
    if (scpi_keyword(parameters[0], "MAXimum")) return scpi_decimal(options_.max_delta_t_k, 4);
    return tl::unexpected(ScpiError{-224, "Illegal parameter value"});
  };
  const auto set_absolute = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 1); !count) return tl::unexpected(count.error());
    const auto value =
        scpi_number(parameters[0], radiator_k(options_.min_delta_t_k), radiator_k(options_.max_delta_t_k), "K");
    if (!value) return tl::unexpected(value.error());
    set_point(difference_k(*value));
    return "";
  };
  const auto get_absolute = [this](Parameters parameters) -> ScpiAnswer {
    if (parameters.empty()) return scpi_decimal(radiator_k(settling().set_point_k), 4);
    if (auto count = scpi_count(parameters, 1); !count) return tl::unexpected(count.error());
    if (scpi_keyword(parameters[0], "MINimum")) return scpi_decimal(radiator_k(options_.min_delta_t_k), 4);
    if (scpi_keyword(parameters[0], "MAXimum")) return scpi_decimal(radiator_k(options_.max_delta_t_k), 4);
    return tl::unexpected(ScpiError{-224, "Illegal parameter value"});
  };
  const auto absolute = [this](double BlackBodyState::*value) {
    return [this, value](Parameters parameters) -> ScpiAnswer {
      if (auto count = scpi_count(parameters, 0); !count) return tl::unexpected(count.error());
      constexpr double zero_celsius_k = 273.15;
      return scpi_decimal(state().*value - (options_.celsius ? zero_celsius_k : 0), 4);
    };
  };
  const auto set_window = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 1); !count) return tl::unexpected(count.error());
    const auto value = scpi_number(parameters[0], options_.resolution_k, 1.0, "K");
    if (!value) return tl::unexpected(value.error());
    const std::scoped_lock lock(mutex_);
    settling_.window_k = *value;
    return "";
  };
  const auto get_window = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 0); !count) return tl::unexpected(count.error());
    return scpi_decimal(settling().window_k, 4);
  };
  const auto condition = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 0); !count) return tl::unexpected(count.error());
    return state().is_stable ? "0" : "2";
  };
  const auto reset = [this](Parameters parameters) -> ScpiAnswer {
    if (auto count = scpi_count(parameters, 0); !count) return tl::unexpected(count.error());
    set_point(0);
    return "";
  };
  return {"todbench,Emulated differential black body," + options_.serial + ",1.0",
          {{"*RST", reset},
           {"[SOURce:]TEMPerature:DIFFerence", set},
           {"[SOURce:]TEMPerature:DIFFerence?", get},
           {"[SOURce:]TEMPerature:STABility:WINDow", set_window},
           {"[SOURce:]TEMPerature:STABility:WINDow?", get_window},
           {"MEASure:TEMPerature:DIFFerence?", number(&BlackBodyState::indicated_delta_t_k)},
           {"[SOURce:]TEMPerature:ABSolute", set_absolute},
           {"[SOURce:]TEMPerature:ABSolute?", get_absolute},
           {"MEASure:TEMPerature:PLATe?", absolute(&BlackBodyState::plate_temperature_k)},
           {"MEASure:TEMPerature:BBODy?", absolute(&BlackBodyState::black_body_temperature_k)},
           {"STATus:OPERation:CONDition?", condition}}};
}

}  // namespace todbench
