#include "app/commands/common/streamed_parts.h"

#include "app/base/console.h"
#include "app/streams/stream_feed.h"
#include "net/base/url_signature.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

namespace gs::app {

void receive_for_picture(WorldLoading& loading, const LoadedWorld& world, double seconds,
                         const std::function<void()>& draw,
                         const std::function<void(ResourceUpdates updates)>& arrive) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kWait{100};
  constexpr double kMostSeconds = 1e6;
  const Clock::time_point until =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(std::clamp(seconds, 0.0, kMostSeconds)));
  const auto apply = [&] {
    bool any = false;
    for (const auto& feed : world.feeds) {
      any = feed->apply() || any;
      if (const std::string problem = feed->take_problem(); !problem.empty())
        complain("%s: warning: %s", net::without_signature(world.path).c_str(), problem.c_str());
    }
    if (!arrive) return any;
    ResourceUpdates updates = loading.take_updates();
    if (updates.empty()) return any;
    any = any || !updates.geometries.empty();
    arrive(std::move(updates));
    return any;
  };
  while (loading.streaming()) {
    draw();
    for (const auto& feed : world.feeds) feed->ask();
    bool any = false;
    do {
      (void)loading.step(kWait);
      any = apply() || any;
    } while (loading.streaming() && !loading.streams_rest() && Clock::now() < until);
    if (!any) return;
    if (Clock::now() >= until) {
      complain("%s: warning: the time limit for loading was reached; the received part is shown",
               net::without_signature(world.path).c_str());
      return;
    }
  }
}

}  // namespace gs::app
