// What happens between losing a camera and measuring with it again: the states, and what leads from one to the next.
// A pure function; reconnecting_source.h acts on it.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string_view>

namespace todbench {

enum class LinkState {
  streaming,    ///< frames come
  releasing,    ///< lost: everything that belongs to the old connection is destroyed
  waiting,      ///< back-off before the next attempt
  opening,      ///< the camera with the same serial number is being opened
  restoring,    ///< every setting is applied again and read back; the stream is started
  registering,  ///< the plate is looked for where it was
  gave_up,      ///< final: too long away, or not the same camera, settings or place any more
  aborted,      ///< final: stopped on request
};

enum class LinkEvent {
  done,         ///< what the state is about has succeeded
  lost,         ///< no frames, no answer
  failed,       ///< the attempt did not succeed; the next one may
  refused,      ///< the camera is there and is not what it was
  out_of_time,  ///< longer away than is waited for
  abort,        ///< stopped on request
};

inline constexpr std::array all_link_states{LinkState::streaming, LinkState::releasing, LinkState::waiting,
                                            LinkState::opening,   LinkState::restoring, LinkState::registering,
                                            LinkState::gave_up,   LinkState::aborted};
inline constexpr std::array all_link_events{LinkEvent::done,    LinkEvent::lost,        LinkEvent::failed,
                                            LinkEvent::refused, LinkEvent::out_of_time, LinkEvent::abort};

[[nodiscard]] std::string_view to_string(LinkState state);

/// The state after an event; nothing where the event cannot happen in that state.
///
///   streaming    lost -> releasing
///   releasing    done -> waiting
///   waiting      done -> opening       out_of_time -> gave_up
///   opening      done -> restoring     failed -> waiting
///   restoring    done -> registering   failed, lost -> releasing   refused -> gave_up
///   registering  done -> streaming     failed, lost -> releasing   refused -> gave_up
///   any but a final one                abort -> aborted
[[nodiscard]] std::optional<LinkState> next_state(LinkState state, LinkEvent event);

[[nodiscard]] constexpr bool is_final(LinkState state) {
  return state == LinkState::gave_up || state == LinkState::aborted;
}

/// How long attempt number `attempt`, from 0, waits: 0.1 s, doubled every time, 3 s at most: the heartbeat after which
/// a camera lets a vanished client go.
[[nodiscard]] std::chrono::milliseconds back_off(int attempt);

}  // namespace todbench
