#include "qnv/reader/directory_requests.h"

#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/payloads.h"

#include <algorithm>
#include <utility>

namespace gs::qnv {
namespace {

StreamHeader without_base(StreamHeader header) {
  header.base = {};
  return header;
}

}  // namespace

DirectoryRequests::DirectoryRequests(const StreamHeader& header)
    : header_(without_base(header)), by_view_(row_of(header).requests == RequestOrder::visible_first) {}

bool DirectoryRequests::set_directory(std::span<const std::byte> chunks) {
  std::vector<DirectoryEntry> entries = directory_of(chunks, header_);
  if (entries.empty()) return false;
  const std::lock_guard lock(mutex_);
  entries_ = std::move(entries);
  return true;
}

void DirectoryRequests::note(const LodView& view) {
  const std::lock_guard lock(mutex_);
  const auto same = std::ranges::find(views_, view.viewport, &LodView::viewport);
  if (same != views_.end()) {
    *same = view;
    return;
  }
  if (views_.size() == kViews) views_.erase(views_.begin());
  views_.push_back(view);
}

void DirectoryRequests::forget(std::uint32_t viewport) {
  const std::lock_guard lock(mutex_);
  std::erase_if(views_, [&](const LodView& view) { return view.viewport == viewport; });
}

std::vector<LodView> DirectoryRequests::views() const {
  const std::lock_guard lock(mutex_);
  return views_;
}

std::vector<ChunkRange> DirectoryRequests::wanted() const {
  const std::lock_guard lock(mutex_);
  std::vector<ChunkRange> first, last;
  first.reserve(entries_.size());
  for (const DirectoryEntry& entry : entries_) {
    const bool visible = !by_view_ || views_.empty() ||
                         std::ranges::any_of(views_, [&](const LodView& view) { return !outside(entry.box, view); });
    (visible ? first : last).push_back({entry.offset, entry.bytes});
  }
  first.insert(first.end(), last.begin(), last.end());
  return first;
}

}  // namespace gs::qnv
