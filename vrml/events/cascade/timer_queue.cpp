#include "vrml/events/timer_queue.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kCallsBetweenLooks = 64;  // number of calls between two calls of EventBudget::look()

}  // namespace

void TimerQueue::run(EventNode node, bool running) {
  EventMember& at = execution_.nodes()[node];
  at.running = running;
  if (!running || std::exchange(at.listed, true)) return;
  at.rank = ++last_rank_;
  running_.push_back(node);
}

// Returns woken nodes to their places among the running ones.
void TimerQueue::take_woken() {
  const auto earlier = [&](EventNode a, EventNode b) {
    return execution_.nodes()[a].rank < execution_.nodes()[b].rank;
  };
  std::vector<EventNode> woken = execution_.viewer().idle().take_woken();
  if (woken.empty()) return;
  std::sort(woken.begin(), woken.end(), earlier);
  const auto old = static_cast<std::ptrdiff_t>(running_.size());
  running_.insert(running_.end(), woken.begin(), woken.end());
  std::inplace_merge(running_.begin(), running_.begin() + old, running_.end(), earlier);
}

void TimerQueue::look_again(EventNode node) {
  execution_.viewer().idle().wake(node);
  if (!std::exchange(execution_.nodes()[node].looking, true)) looking_.push_back(node);
}

void TimerQueue::look_again_at_running() {
  execution_.viewer().idle().wake_all();
  take_woken();
  for (const EventNode node : running_)
    if (execution_.nodes()[node].running) look_again(node);
}

void TimerQueue::call_at(EventNode node, double time) {
  constexpr std::size_t kFewAlarms = 1024;
  if (std::isnan(time)) return;
  EventNodes& nodes = execution_.nodes();
  if (alarms_.size() > kFewAlarms && alarms_.size() > 2 * live_alarms_) {
    std::erase_if(alarms_, [&](const Alarm& alarm) { return nodes[alarm.node].alarm != alarm.number; });
    std::make_heap(alarms_.begin(), alarms_.end(), std::greater<>());
  }
  live_alarms_ += nodes[node].alarm == 0 ? 1 : 0;
  if (++alarm_number_ == 0) ++alarm_number_;
  nodes[node].alarm = alarm_number_;
  alarms_.push_back({time, node, alarm_number_});
  std::push_heap(alarms_.begin(), alarms_.end(), std::greater<>());
}

void TimerQueue::begin_step(double now) {
  EventNodes& nodes = execution_.nodes();
  while (!alarms_.empty() && alarms_.front().time <= now) {
    const Alarm alarm = alarms_.front();
    std::pop_heap(alarms_.begin(), alarms_.end(), std::greater<>());
    alarms_.pop_back();
    if (nodes[alarm.node].alarm != alarm.number) continue;
    nodes[alarm.node].alarm = 0;
    --live_alarms_;
    look_again(alarm.node);
  }
  execution_.viewer().idle().begin_step();
  take_woken();
  // Nodes that start running during these calls are appended to the list. They have been called already.
  const std::size_t count = running_.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const EventNode node = running_[i];
    if (i % kCallsBetweenLooks == 0) (void)execution_.budget().look();
    if (nodes[node].running && !execution_.budget().is_halted()) nodes.behaviour_of(node).on_time(execution_, node);
    nodes[node].listed = nodes[node].running;
    if (nodes[node].running && !execution_.viewer().idle().take(node)) running_[kept++] = node;
  }
  running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(kept),
                 running_.begin() + static_cast<std::ptrdiff_t>(count));
}

void TimerQueue::call_waiting() {
  EventNodes& nodes = execution_.nodes();
  for (std::size_t i = 0; i < looking_.size(); ++i) {
    const EventNode node = looking_[i];
    nodes[node].looking = false;
    if (i % kCallsBetweenLooks == 0) (void)execution_.budget().look();
    if (execution_.budget().is_halted()) continue;
    if (nodes.type_of(node).kind != NodeType::Kind::script) execution_.scripts().flush();
    nodes.behaviour_of(node).on_time(execution_, node);
  }
  looking_.clear();
}

bool TimerQueue::has_running() const {
  return !execution_.viewer().idle().empty() || std::any_of(running_.begin(), running_.end(), [&](EventNode node) {
    return execution_.nodes()[node].running;
  });
}

std::optional<double> TimerQueue::next_alarm() const {
  return alarms_.empty() ? std::nullopt : std::optional<double>(alarms_.front().time);
}

void TimerQueue::remove(EventNode node) {
  if (execution_.nodes()[node].alarm != 0) --live_alarms_;
  execution_.viewer().idle().remove(node);
}

void TimerQueue::forget_removed() {
  const auto is_removed = [&](EventNode node) { return execution_.nodes().is_removed(node); };
  std::erase_if(running_, is_removed);
  std::erase_if(looking_, is_removed);
  execution_.viewer().idle().forget_removed();
}

}  // namespace gs::vrml
