#include "net/load/load_queue.h"

#include <algorithm>

namespace gs::net {
namespace {

/// Maximum bytes of one data event that is joined from consecutive blocks.
constexpr std::size_t kJoinedBlock = std::size_t{64} << 10;

}  // namespace

LoadQueue::Box* LoadQueue::find(RequestId id) {
  const auto found = boxes_.find(id);
  return found == boxes_.end() || found->second.ended ? nullptr : &found->second;
}

void LoadQueue::open(RequestId id, int priority) {
  const std::lock_guard lock(mutex_);
  boxes_[id].priority = priority;
}

void LoadQueue::close(RequestId id) {
  const std::lock_guard lock(mutex_);
  const auto found = boxes_.find(id);
  if (found == boxes_.end()) return;
  forget_bytes(found->second);
  boxes_.erase(found);
}

void LoadQueue::set_priority(RequestId id, int priority) {
  const std::lock_guard lock(mutex_);
  if (const auto found = boxes_.find(id); found != boxes_.end()) found->second.priority = priority;
}

void LoadQueue::forget_bytes(Box& box) {
  queued_ -= box.bytes;
  box.bytes = 0;
  box.front_taken = 0;
  box.events.clear();
}

void LoadQueue::notify(std::unique_lock<std::mutex>& lock) {
  const bool call = wake_ && !woken_;
  woken_ = true;
  lock.unlock();
  if (call) wake_();
}

LoadEvent LoadQueue::take_data(Box& box, std::size_t budget) {
  LoadEvent& front = box.events.front();
  auto& data = std::get<LoadData>(front.what);
  const std::size_t left = data.bytes.size() - box.front_taken;
  if (box.front_taken == 0 && left <= budget) {
    LoadEvent event = std::move(front);
    box.events.pop_front();
    return event;
  }
  const std::size_t count = std::min(left, budget);
  const auto begin = data.bytes.begin() + static_cast<std::ptrdiff_t>(box.front_taken);
  LoadEvent event{front.id, LoadData{data.offset + box.front_taken,
                                     std::vector<std::byte>(begin, begin + static_cast<std::ptrdiff_t>(count))}};
  box.front_taken += count;
  if (count == left) {
    box.events.pop_front();
    box.front_taken = 0;
  }
  return event;
}

void LoadQueue::take_from(Box& box, std::size_t& budget, std::vector<LoadEvent>& result) {
  while (!box.events.empty()) {
    LoadEvent& front = box.events.front();
    if (!std::holds_alternative<LoadData>(front.what)) {
      if (std::holds_alternative<LoadHead>(front.what)) box.seen = true;
      if (std::holds_alternative<LoadRestarted>(front.what)) box.outdated = false;
      result.push_back(std::move(front));
      box.events.pop_front();
      continue;
    }
    if (budget == 0) return;
    result.push_back(take_data(box, budget));
    const std::size_t count = std::get<LoadData>(result.back().what).bytes.size();
    budget -= count;
    box.bytes -= count;
    queued_ -= count;
  }
}

std::vector<LoadEvent> LoadQueue::poll(std::size_t max_bytes) {
  std::vector<LoadEvent> result;
  const std::lock_guard lock(mutex_);
  woken_ = false;
  std::vector<std::pair<int, std::map<RequestId, Box>::iterator>> order;
  for (auto place = boxes_.begin(); place != boxes_.end(); ++place)
    if (!place->second.events.empty()) order.emplace_back(place->second.priority, place);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (auto& [priority, place] : order) {
    take_from(place->second, max_bytes, result);
    if (place->second.ended && place->second.events.empty()) boxes_.erase(place);
  }
  return result;
}

void LoadQueue::push_head(RequestId id, LoadHead head) {
  std::unique_lock lock(mutex_);
  Box* const box = find(id);
  if (!box) return;
  box->events.push_back({id, std::move(head)});
  notify(lock);
}

void LoadQueue::push_data(RequestId id, std::uint64_t offset, std::span<const std::byte> bytes) {
  std::unique_lock lock(mutex_);
  Box* const box = find(id);
  if (!box || bytes.empty()) return;
  box->bytes += bytes.size();
  queued_ += bytes.size();
  LoadData* const last = box->events.empty() ? nullptr : std::get_if<LoadData>(&box->events.back().what);
  const bool continues = last && last->offset + last->bytes.size() == offset;
  if (continues && last->bytes.size() + bytes.size() <= kJoinedBlock) {
    last->bytes.insert(last->bytes.end(), bytes.begin(), bytes.end());
  } else {
    LoadData data{offset, {}};
    // Reserve space for the next blocks, but not much more than the counted bytes.
    data.bytes.reserve(continues ? std::max(bytes.size(), kJoinedBlock) : bytes.size());
    data.bytes.assign(bytes.begin(), bytes.end());
    box->events.push_back({id, std::move(data)});
  }
  notify(lock);
}

void LoadQueue::push_end(RequestId id, std::variant<LoadDone, LoadError> how) {
  std::unique_lock lock(mutex_);
  Box* const box = find(id);
  if (!box) return;
  if (auto* const error = std::get_if<LoadError>(&how))
    box->events.push_back({id, std::move(*error)});
  else
    box->events.push_back({id, LoadDone{}});
  box->ended = true;
  notify(lock);
}

void LoadQueue::restart(RequestId id) {
  std::unique_lock lock(mutex_);
  Box* const box = find(id);
  if (!box) return;
  forget_bytes(*box);
  box->outdated |= box->seen;
  box->seen = false;
  if (!box->outdated) return;
  box->events.push_back({id, LoadRestarted{}});
  notify(lock);
}

std::size_t LoadQueue::room(RequestId id) {
  const std::lock_guard lock(mutex_);
  Box* const box = find(id);
  const std::size_t all = queued_.load(std::memory_order_relaxed);
  const std::size_t mine = box ? box->bytes : 0;
  const std::size_t room = all >= max_bytes_ || mine >= max_bytes_per_request_
                               ? 0
                               : std::min(max_bytes_ - all, max_bytes_per_request_ - mine);
  if (room == 0) starved_ = true;
  return room;
}

}  // namespace gs::net
