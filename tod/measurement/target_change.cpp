// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measurement/target_change.h"

#include <atomic>
#include <thread>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

struct TakenChange {
  TargetChange change;
  std::int64_t calls = 0;  ///< number of frame requests
};

TakenChange present_and_take(Target& target, FrameTaker& taker, const TargetState& state, const std::stop_token& stop) {
  TakenChange out;
  TargetChange& change = out.change;
  std::atomic<bool> there = false;
  {
    std::stop_source give_up;
    const std::stop_callback stopped(stop, [&give_up] { give_up.request_stop(); });
    const std::jthread frames([&] {
      change.frames = taker.take_while_presenting([&](std::int64_t asked) {
        out.calls = asked;
        return there.load();
      });
      if (!change.frames) give_up.request_stop();
    });
    change.presented = target.present(state, give_up.get_token());
    there = true;
  }
  // The call that failed counts too.
  if (!change.frames) ++out.calls;
  return out;
}

}  // namespace

Result<TargetChange> change_target(Target& target, FrameTaker& taker, RunController& host, const TargetState& state,
                                   std::stop_token stop) {
  TargetChange change;
  switch (host.frames_while_presenting()) {
    case FramesWhilePresenting::leave:
      change.presented = target.present(state, stop);
      break;
    case FramesWhilePresenting::take: {
      TakenChange taken = present_and_take(target, taker, state, stop);
      TODBENCH_TRY_VOID(host.asked_while_presenting(taken.calls));
      change = std::move(taken.change);
      break;
    }
    case FramesWhilePresenting::repeat: {
      change.presented = target.present(state, stop);
      const auto calls = host.asked_while_presenting(0);
      if (!calls) return tl::unexpected(calls.error());
      change.frames = taker.take_while_presenting([calls = *calls](std::int64_t asked) { return asked >= calls; });
      break;
    }
  }
  change.given_up = !change.frames && !change.presented && change.presented.error().code == ErrorCode::interrupted &&
                    !stop.stop_requested();
  return change;
}

}  // namespace todbench
