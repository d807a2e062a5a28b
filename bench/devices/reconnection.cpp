// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/reconnection.h"

#include <algorithm>

namespace todbench {

std::string_view to_string(LinkState state) {
  switch (state) {
    case LinkState::streaming:
      return "streaming";
    case LinkState::releasing:
      return "releasing";
    case LinkState::waiting:
      return "waiting";
    case LinkState::opening:
      return "opening";
    case LinkState::restoring:
      return "restoring";
    case LinkState::registering:
      return "registering";
    case LinkState::gave_up:
      return "gave_up";
    case LinkState::aborted:
      return "aborted";
  }
  return "";
}

std::optional<LinkState> next_state(LinkState state, LinkEvent event) {
  struct Transition {
    LinkState from;
    LinkEvent event;
    LinkState to;
  };
  using S = LinkState;
  using E = LinkEvent;
  static constexpr std::array transitions{
      Transition{S::streaming, E::lost, S::releasing},   Transition{S::releasing, E::done, S::waiting},
      Transition{S::waiting, E::done, S::opening},       Transition{S::waiting, E::out_of_time, S::gave_up},
      Transition{S::opening, E::done, S::restoring},     Transition{S::opening, E::failed, S::waiting},
      Transition{S::restoring, E::done, S::registering}, Transition{S::restoring, E::failed, S::releasing},
      Transition{S::restoring, E::lost, S::releasing},   Transition{S::restoring, E::refused, S::gave_up},
      Transition{S::registering, E::done, S::streaming}, Transition{S::registering, E::failed, S::releasing},
      Transition{S::registering, E::lost, S::releasing}, Transition{S::registering, E::refused, S::gave_up},
  };
  if (is_final(state)) return std::nullopt;
  if (event == E::abort) return S::aborted;
  for (const auto& transition : transitions) {
    if (transition.from == state && transition.event == event) return transition.to;
  }
  return std::nullopt;
}

std::chrono::milliseconds back_off(int attempt) {
  constexpr std::chrono::milliseconds first{100}, most{3000};
  return std::min(most, first * (1 << std::clamp(attempt, 0, 10)));
}

}  // namespace todbench
