#include "app/streams/stream_feed.h"

#include <utility>

namespace gs::app {

StreamFeed::StreamFeed(std::shared_ptr<qnv::ChunkRequests> requests, std::function<void()> wake)
    : requests_(std::move(requests)),
      stream_(std::dynamic_pointer_cast<qnv::ViewedStream>(requests_)),
      wake_(std::move(wake)) {}

void StreamFeed::push(std::span<const std::byte> bytes) {
  const std::lock_guard lock(mutex_);
  front_.insert(front_.end(), bytes.begin(), bytes.end());
}

bool StreamFeed::set_directory(std::vector<std::byte> chunks) {
  if (!stream_ && !requests_->set_directory(chunks)) return false;
  const std::lock_guard lock(mutex_);
  if (stream_) {
    directory_ = std::move(chunks);
  } else {
    // Nothing may be drawn yet, so do not wait for a view.
    wanted_ = requests_->wanted();
    wanted_is_new_ = true;
  }
  return true;
}

void StreamFeed::add(std::uint64_t offset, std::vector<std::byte> chunk) {
  const std::lock_guard lock(mutex_);
  chunks_.push_back({offset, std::move(chunk)});
}

void StreamFeed::add_loose(std::uint32_t number, std::vector<std::byte> chunk) {
  // Offset beyond the end of any stream. A chunk without a known offset gets a unique offset from here on.
  constexpr std::uint64_t kNowhere = std::uint64_t{1} << 62;
  add(kNowhere + number, std::move(chunk));
}

void StreamFeed::finish() {
  over_ = true;
  const std::lock_guard lock(mutex_);
  finished_ = true;
}

void StreamFeed::fail(std::string why) {
  over_ = true;
  const std::lock_guard lock(mutex_);
  problem_ = std::move(why);
}

std::string StreamFeed::take_problem() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problem_, {});
}

bool StreamFeed::take_wanted(std::vector<qnv::ChunkRange>& ranges) {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(wanted_is_new_, false)) return false;
  ranges = wanted_;
  return true;
}

bool StreamFeed::take_views(std::vector<qnv::LodView>& views) {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(views_are_new_, false)) return false;
  views = views_;
  return true;
}

bool StreamFeed::apply() {
  if (!stream_) return false;
  std::vector<std::byte> front, directory;
  std::vector<Chunk> chunks;
  bool finished = false;
  {
    const std::lock_guard lock(mutex_);
    front.swap(front_);
    directory.swap(directory_);
    chunks.swap(chunks_);
    finished = std::exchange(finished_, false);
  }
  if (!front.empty()) stream_->push(front);
  if (finished) stream_->finish();
  if (!directory.empty()) (void)stream_->set_directory(directory);
  for (const Chunk& chunk : chunks) (void)stream_->add(chunk.offset, chunk.bytes);
  const bool any = !front.empty() || !directory.empty() || !chunks.empty() || finished;
  if (any) ++applied_;
  return any;
}

void StreamFeed::ask() {
  std::vector<qnv::LodView> views = requests_->views();
  // The order of a stream that the reader thread decodes depends only on the views.
  if (!stream_ && (over_ || views == told_)) return;
  std::vector<qnv::ChunkRange> wanted;
  {
    const std::lock_guard lock(mutex_);
    wanted = requests_->wanted();
    if (wanted == asked_ && views == told_) return;
    wanted_is_new_ = wanted_is_new_ || wanted != asked_;
    views_are_new_ = views_are_new_ || views != told_;
    wanted_ = wanted;
    views_ = views;
  }
  asked_ = std::move(wanted);
  told_ = std::move(views);
  if (wake_) wake_();
}

}  // namespace gs::app
