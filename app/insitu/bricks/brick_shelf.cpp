#include "app/insitu/bricks/brick_shelf.h"

#include "base/thread_time.h"

#include <algorithm>
#include <utility>

namespace gs::app::insitu {
namespace {

constexpr std::size_t kMaxWanted = 256;
constexpr std::chrono::milliseconds kPauseOfViewers{500};
constexpr std::chrono::seconds kMaxRefinement{2};

net::HeldContent held_json(std::string text) {
  return {net::HeldContent::State::ready, "application/json", std::move(text)};
}

}  // namespace

void BrickShelf::put(ServedGrid grid) {
  Slot slot;
  slot.grid = std::move(grid);
  slot.begun = Clock::now();
  std::deque<Slot> dropped;  // freed after the lock
  const std::lock_guard lock(mutex_);
  slots_.push_back(std::move(slot));
  while (slots_.size() > kMaxSteps) dropped.push_back(take_oldest());
}

void BrickShelf::drop_older() {
  std::deque<Slot> dropped;
  const std::lock_guard lock(mutex_);
  while (slots_.size() > 1) dropped.push_back(take_oldest());
}

BrickShelf::Slot BrickShelf::take_oldest() {
  Slot oldest = std::move(slots_.front());
  slots_.pop_front();
  for (const auto& [chunk, bytes] : oldest.encoded) encoded_bytes_ -= bytes.size();
  for (auto* const list : {&order_, &received_})
    std::erase_if(*list, [&](const WantedChunk& one) { return one.serial == oldest.grid.serial; });
  return oldest;
}

BrickShelf::Slot* BrickShelf::find(std::uint64_t serial) {
  for (Slot& slot : slots_)
    if (slot.grid.serial == serial) return &slot;
  return nullptr;
}

net::HeldContent BrickShelf::content(const std::string& path) {
  const auto name = parse_zarr_name(path);
  if (!name) return {};
  std::unique_lock lock(mutex_);
  const auto slot = std::ranges::find(slots_, name->container, [](const Slot& one) { return one.grid.container; });
  if (slot == slots_.end())
    return {slots_.empty() ? net::HeldContent::State::none : net::HeldContent::State::gone, {}, {}};
  const ServedGrid& grid = slot->grid;
  if (!name->level) return held_json(zarr_group(grid.pyramid, grid.grid));
  if (*name->level >= grid.pyramid.levels()) return {};
  if (!name->chunk) return held_json(zarr_level(grid.pyramid, grid.grid, *name->level));
  if (!grid.pyramid.contains(*name->chunk)) return {};
  if (name->chunk->level == grid.pyramid.overview())
    slot->seen = true;
  else
    refined_ = Clock::now();
  return chunk_content(lock, name->container, *name->chunk);
}

// Encodes without the lock, so that the simulation's thread need not wait.
net::HeldContent BrickShelf::chunk_content(std::unique_lock<std::mutex>& lock, const std::string& container,
                                           const Chunk& chunk) {
  using State = net::HeldContent::State;
  constexpr const char* kChunkType = "application/octet-stream";
  const auto at = std::ranges::find(slots_, container, [](const Slot& one) { return one.grid.container; });
  const std::uint64_t serial = at->grid.serial;
  if (const auto found = at->encoded.find(chunk); found != at->encoded.end())
    return {State::ready, kChunkType, found->second};
  auto received = at->grid.received.find(chunk);
  const auto read = at->grid.read;
  const bool here = received != at->grid.received.end() || read;
  if (!here && at->wanted.size() < kMaxWanted && !at->sent.contains(chunk)) at->wanted.insert(chunk);
  const bool overview = chunk.level == at->grid.pyramid.overview();
  if (!here || (!overview && !share_.permits())) return {State::waiting, {}, {}};
  const ZarrGrid grid = at->grid.grid;
  const double begun = thread_seconds();
  const GridIndex shape = at->grid.pyramid.chunk_shape(chunk.level);
  std::vector<float> sent;
  if (received != at->grid.received.end()) {
    sent = std::move(received->second);
    at->grid.received.erase(received);
    std::erase_if(received_, [&](const WantedChunk& one) { return one.serial == serial && one.chunk == chunk; });
  }
  lock.unlock();
  const std::size_t layer = std::size_t{shape[0]} * shape[1];
  std::string bytes = encoder_.encode(
      shape,
      [&](std::uint32_t first, std::span<float> values) {
        if (sent.size() >= first * layer + values.size())
          std::copy_n(sent.begin() + static_cast<std::ptrdiff_t>(first * layer), values.size(), values.begin());
        else if (read)
          read(chunk, first, values);
      },
      grid);
  share_.charge(overview ? thread_seconds() - begun : 0, bytes.size());
  lock.lock();
  if (Slot* const slot = find(serial)) {
    encoded_bytes_ += bytes.size();
    slot->encoded[chunk] = bytes;
    order_.push_back({serial, chunk});
    drop_encoded();
  }
  return {State::ready, kChunkType, std::move(bytes)};
}

// Drops the oldest encoded chunks above the limit. Ranks send them again if viewers request them again.
void BrickShelf::drop_encoded() {
  while (encoded_bytes_ > kMaxEncodedBytes && order_.size() > 1) {
    const WantedChunk oldest = order_.front();
    order_.pop_front();
    Slot* const slot = find(oldest.serial);
    if (!slot) continue;
    const auto found = slot->encoded.find(oldest.chunk);
    if (found == slot->encoded.end()) continue;
    encoded_bytes_ -= found->second.size();
    slot->encoded.erase(found);
    slot->sent.erase(oldest.chunk);
  }
}

std::vector<WantedChunk> BrickShelf::take_wanted(std::size_t most) {
  std::vector<WantedChunk> all;
  all.reserve(most);  // no allocation may fail after a chunk counts as sent
  const std::lock_guard lock(mutex_);
  for (auto slot = slots_.rbegin(); slot != slots_.rend(); ++slot)
    while (all.size() < most && !slot->wanted.empty()) {
      // The coarsest chunks come first.
      const auto last = std::prev(slot->wanted.end());
      all.push_back({slot->grid.serial, *last});
      slot->sent.insert(slot->wanted.extract(last));
    }
  return all;
}

void BrickShelf::deliver(const WantedChunk& wanted, std::vector<float> values) {
  const std::lock_guard lock(mutex_);
  Slot* const slot = find(wanted.serial);
  if (!slot) return;
  if (values.empty()) {
    slot->sent.erase(wanted.chunk);
    return;
  }
  slot->grid.received[wanted.chunk] = std::move(values);
  received_.push_back(wanted);
  drop_received();
}

void BrickShelf::drop_received() {
  std::size_t bytes = 0;
  for (const WantedChunk& one : received_) bytes += find(one.serial)->grid.pyramid.chunk_points(one.chunk.level);
  for (bytes *= sizeof(float); bytes > kMaxReceivedBytes && received_.size() > 1; received_.pop_front()) {
    const WantedChunk& oldest = received_.front();
    Slot& slot = *find(oldest.serial);
    bytes -= slot.grid.pyramid.chunk_points(oldest.chunk.level) * sizeof(float);
    slot.grid.received.erase(oldest.chunk);
    slot.sent.erase(oldest.chunk);
  }
}

bool BrickShelf::is_seen() const {
  const std::lock_guard lock(mutex_);
  return slots_.empty() || slots_.back().seen;
}

bool BrickShelf::is_busy(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  if (slots_.empty() || now - slots_.back().begun > kMaxRefinement) return false;
  for (const Slot& slot : slots_)
    if (!slot.wanted.empty()) return true;
  return refined_ != Clock::time_point() && now - refined_ < kPauseOfViewers;
}

}  // namespace gs::app::insitu
