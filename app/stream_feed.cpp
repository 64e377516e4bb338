#include "app/stream_feed.h"

#include <utility>

namespace gs::app {

StreamFeed::StreamFeed(std::shared_ptr<qnv::LodStream> stream, std::function<void()> wake)
    : stream_(std::move(stream)), wake_(std::move(wake)) {}

void StreamFeed::push(std::span<const std::byte> bytes) {
  const std::lock_guard lock(mutex_);
  front_.insert(front_.end(), bytes.begin(), bytes.end());
}

void StreamFeed::set_directory(std::vector<std::byte> chunks) {
  const std::lock_guard lock(mutex_);
  directory_ = std::move(chunks);
}

void StreamFeed::add(std::uint64_t offset, std::vector<std::byte> chunk) {
  const std::lock_guard lock(mutex_);
  chunks_.push_back({offset, std::move(chunk)});
}

void StreamFeed::finish() {
  const std::lock_guard lock(mutex_);
  finished_ = true;
}

void StreamFeed::fail(std::string why) {
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

bool StreamFeed::apply() {
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
  return !front.empty() || !directory.empty() || !chunks.empty() || finished;
}

void StreamFeed::ask() {
  const std::vector<qnv::ChunkRange>& wanted = stream_->wanted();
  if (wanted == asked_) return;
  asked_ = wanted;
  {
    const std::lock_guard lock(mutex_);
    wanted_ = wanted;
    wanted_is_new_ = true;
  }
  if (wake_) wake_();
}

}  // namespace gs::app
