// SPDX-License-Identifier: GPL-3.0-or-later
// States and transitions between the loss of a camera and the continued measurement. The transitions are a pure
// function; reconnecting_source.h executes them.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string_view>

namespace todbench {

/// State of the connection to a camera.
enum class LinkState {
  streaming,    ///< frames arrive
  releasing,    ///< lost: all objects of the old connection are destroyed
  waiting,      ///< back-off before the next attempt
  opening,      ///< the camera with the same serial number is being opened
  restoring,    ///< all settings are written and read back; the stream is started
  registering,  ///< the plate is located at its former position
  gave_up,      ///< final: the camera was away too long, or camera, settings or plate position differ
  aborted,      ///< final: stopped on request
};

/// Event that changes the state.
enum class LinkEvent {
  done,         ///< the task of the state succeeded
  lost,         ///< no frames and no response
  failed,       ///< the attempt failed; the next attempt may succeed
  refused,      ///< the camera responds but differs from its former state
  out_of_time,  ///< away longer than the patience
  abort,        ///< stopped on request
};

inline constexpr std::array all_link_states{LinkState::streaming, LinkState::releasing, LinkState::waiting,
                                            LinkState::opening,   LinkState::restoring, LinkState::registering,
                                            LinkState::gave_up,   LinkState::aborted};
inline constexpr std::array all_link_events{LinkEvent::done,    LinkEvent::lost,        LinkEvent::failed,
                                            LinkEvent::refused, LinkEvent::out_of_time, LinkEvent::abort};

/// Returns the name of the enumerator.
[[nodiscard]] std::string_view to_string(LinkState state);

/// Returns the state after an event; empty if the event cannot happen in that state.
///
///   streaming    lost -> releasing
///   releasing    done -> waiting
///   waiting      done -> opening       out_of_time -> gave_up
///   opening      done -> restoring     failed -> waiting
///   restoring    done -> registering   failed, lost -> releasing   refused -> gave_up
///   registering  done -> streaming     failed, lost -> releasing   refused -> gave_up
///   any but a final one                abort -> aborted
[[nodiscard]] std::optional<LinkState> next_state(LinkState state, LinkEvent event);

/// Returns whether no event changes the state.
[[nodiscard]] constexpr bool is_final(LinkState state) {
  return state == LinkState::gave_up || state == LinkState::aborted;
}

/// Returns the wait before attempt `attempt`, counted from 0: 0.1 s, doubled each time, at most 3 s. A camera releases
/// a vanished client after a heartbeat timeout of 3 s.
[[nodiscard]] std::chrono::milliseconds back_off(int attempt);

}  // namespace todbench
