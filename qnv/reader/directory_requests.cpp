#include "qnv/reader/directory_requests.h"

#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/payloads.h"
#include "qnv/codecs/values/chunk_places.h"
#include "qnv/reader/step_order.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gs::qnv {
namespace {

StreamHeader without_base(StreamHeader header) {
  header.base = {};
  return header;
}

// Shorter streams of values keep their order, in which each prefix states its error.
constexpr std::uint64_t kLongValues = std::uint64_t{8} << 20;

bool depends_on_views(const StreamHeader& header) {
  if (header.payload == Payload::values && header.directory < kLongValues) return false;
  return row_of(header).requests == RequestOrder::visible_first;
}

std::vector<DirectoryEntry> entries_of(std::span<const std::byte> chunks, const StreamHeader& header) {
  if (header.payload != Payload::values) return directory_of(chunks, header);
  const auto places = values::places_of(chunks, header);
  if (!places) return directory_of(chunks, header);
  const values::PlaceEntries entry_of(header.grid, !header.steps.times.empty());
  std::vector<DirectoryEntry> entries;
  entries.reserve(places->size());
  for (const values::ChunkPlace& place : *places) entries.push_back(entry_of(place));
  return entries;
}

}  // namespace

DirectoryRequests::DirectoryRequests(const StreamHeader& header, std::optional<std::uint32_t> only_step)
    : header_(without_base(header)), by_view_(depends_on_views(header)), only_step_(only_step) {}

bool DirectoryRequests::set_directory(std::span<const std::byte> chunks) {
  std::vector<DirectoryEntry> entries = entries_of(chunks, header_);
  if (entries.empty()) return false;
  const std::lock_guard lock(mutex_);
  entries_ = std::move(entries);
  return true;
}

void DirectoryRequests::note(const LodView& view) {
  const std::lock_guard lock(mutex_);
  const auto same = std::ranges::find(views_, view.viewport, [](const Viewed& viewed) { return viewed.view.viewport; });
  if (same != views_.end()) {
    const std::uint32_t before = same->view.volume.step, step = view.volume.step;
    if (step != before) same->backwards = plays_backwards(before, step, header_.steps.times.size());
    same->view = view;
    return;
  }
  if (views_.size() == kViews) views_.erase(views_.begin());
  views_.push_back({view});
}

void DirectoryRequests::forget(std::uint32_t viewport) {
  const std::lock_guard lock(mutex_);
  std::erase_if(views_, [&](const Viewed& viewed) { return viewed.view.viewport == viewport; });
}

std::vector<LodView> DirectoryRequests::views() const {
  const std::lock_guard lock(mutex_);
  std::vector<LodView> views;
  for (const Viewed& viewed : views_) views.push_back(viewed.view);
  return views;
}

// Reports whether a chunk changes the picture of a view.
bool DirectoryRequests::is_first(const DirectoryEntry& entry, const LodView& view) const {
  if (outside(entry.box, view)) return false;
  if (header_.payload != Payload::values || entry.level == 0) return true;
  // A block of level n makes the distance of samples half of that of level n.
  const float distance = glm::length(view.eye - glm::clamp(view.eye, entry.box.lower, entry.box.upper));
  const double step = std::ldexp(static_cast<double>(header_.description.spacing), entry.level);
  return step * view.pixels > static_cast<double>(view.error_pixels) * static_cast<double>(distance);
}

// Remainders of a step are applied once all chunks of its chain up to it are received.
std::vector<ChunkRange> DirectoryRequests::of_one_step() const {
  const PlayedStep played{*only_step_};
  const StepOrder steps(header_.steps.times.size(), {&played, 1});
  std::vector<ChunkRange> ranges;
  for (const DirectoryEntry& entry : entries_)
    if (steps.rank(entry.parent, true) == 0) ranges.push_back({entry.offset, entry.bytes});
  return ranges;
}

std::vector<ChunkRange> DirectoryRequests::wanted() const {
  const std::lock_guard lock(mutex_);
  if (only_step_) return of_one_step();
  const bool all_first = !by_view_ || views_.empty(), series = !all_first && !header_.steps.times.empty();
  std::vector<PlayedStep> played;
  for (const Viewed& viewed : views_) played.push_back({viewed.view.volume.step, viewed.backwards});
  const StepOrder steps(series ? header_.steps.times.size() : 0, played);
  // Visible chunks of needed steps come first, then the hidden ones of these steps, then the other steps.
  constexpr std::uint32_t kHidden = StepOrder::kOther, kOthers = 2 * StepOrder::kOther;
  std::array<std::vector<ChunkRange>, kOthers + 2> parts;
  for (const DirectoryEntry& entry : entries_) {
    const bool visible =
        all_first || std::ranges::any_of(views_, [&](const Viewed& viewed) { return is_first(entry, viewed.view); });
    // Blocks have a level of at least 1, gaps and remainders have none.
    const std::uint32_t rank = series ? steps.rank(entry.parent, header_.grid.labels || entry.level > 0) : 0;
    const std::uint32_t part = rank == StepOrder::kOther ? kOthers + (visible ? 0 : 1) : rank + (visible ? 0 : kHidden);
    parts[part].push_back({entry.offset, entry.bytes});
  }
  std::vector<ChunkRange> ranges;
  ranges.reserve(entries_.size());
  for (const std::vector<ChunkRange>& part : parts) ranges.insert(ranges.end(), part.begin(), part.end());
  return ranges;
}

}  // namespace gs::qnv
