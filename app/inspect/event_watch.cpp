#include "app/inspect/event_watch.h"

#include <utility>

namespace gs::app {

EventWatch::~EventWatch() { watch(nullptr); }

void EventWatch::watch(vrml::Execution* world) {
  if (world == world_) return;
  if (world_) world_->cascade().observe({}, this);
  world_ = world;
  seen_ = {};
  news_ = false;
  if (!world_) return;
  second_ = world_->now();
  world_->cascade().observe(
      [this](const vrml::SentEvent& event) {
        const WatchedEvent key{event.node, event.event};
        auto found = seen_.find(key);
        if (found == seen_.end()) {
          if (seen_.size() >= kMax) return;
          found = seen_.emplace(key, Seen{}).first;
        }
        found->second.time = event.time;
        ++found->second.count;
        news_ = true;
      },
      this);
}

bool EventWatch::take_news() {
  if (!world_) return false;
  const double now = world_->now(), seconds = now - second_;
  if (seconds >= 1) {
    second_ = now;
    for (auto& [key, one] : seen_) {
      one.a_second = static_cast<double>(one.count - one.counted) / seconds;
      news_ = news_ || one.count != one.counted;
      one.counted = one.count;
    }
  }
  return std::exchange(news_, false);
}

const EventWatch::Seen* EventWatch::find(const NodeAt& node, const vrml::InterfaceDeclaration& event) const {
  const auto found = seen_.find({node.id, &event});
  return found == seen_.end() ? nullptr : &found->second;
}

}  // namespace gs::app
