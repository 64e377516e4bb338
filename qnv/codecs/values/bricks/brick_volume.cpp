#include "qnv/codecs/values/bricks/brick_volume.h"

#include "base/free_memory.h"
#include "qnv/codecs/values/decode/values_decoder.h"

#include <algorithm>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::size_t kMostViews = 16;
// Received bytes are decoded if they are this part of those before, or after this time.
constexpr std::uint64_t kGrowthPart = 4;
constexpr std::chrono::milliseconds kGrowthTime{1000};
constexpr std::uint64_t kMostWaiting = std::uint64_t{16} << 20;  // received bytes that were not decoded

}  // namespace

BrickVolume::BrickVolume(StreamHeader header, const BrickLimits& limits, std::shared_ptr<const ChunkSource> source,
                         std::uint32_t step)
    : header_(std::move(header)), decoder_(header_, limits, std::move(source), step) {
  return_large_pieces();
}

BrickVolume::~BrickVolume() {
  stop_ = true;
  if (running_.valid()) running_.wait();
}

bool BrickVolume::suits(const StreamHeader& header, std::size_t most_vectors) {
  return header.payload == Payload::values && !header.grid.labels && header.grid.components == 1 &&
         values::valid(header.grid.dimensions) && BrickDecoder::base_level(header.grid, most_vectors) > 0;
}

BrickVolume::Opened BrickVolume::open(std::shared_ptr<const ChunkSource> source, const BrickLimits& limits,
                                      const std::function<bool()>& stop, std::uint32_t step) {
  std::size_t header_bytes = 0;
  auto header = read_stream_header(*source, header_bytes);
  if (auto* const problem = std::get_if<StreamProblem>(&header)) return std::move(*problem);
  auto& known = std::get<StreamHeader>(header);
  if (known.payload != Payload::values || !values::valid(known.grid.dimensions))
    return StreamProblem{11, "has no values of a volume"};
  std::shared_ptr<BrickVolume> made(new BrickVolume(std::move(known), limits, std::move(source), step));
  if (!made->decoder_.read_source(stop)) return StreamProblem{0, "cannot be read"};
  std::unique_lock lock(made->mutex_);
  made->run(lock, false);
  return made;
}

BrickVolume::Opened BrickVolume::begin(std::span<const std::byte> front, const BrickLimits& limits) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  auto header = decode_header(front, header_bytes, need_more);
  if (auto* const problem = std::get_if<StreamProblem>(&header)) return std::move(*problem);
  auto& known = std::get<StreamHeader>(header);
  if (known.payload != Payload::values || !values::valid(known.grid.dimensions))
    return StreamProblem{11, "has no values of a volume"};
  std::shared_ptr<BrickVolume> made(new BrickVolume(std::move(known), limits, nullptr, 0));
  made->push(front);
  std::unique_lock lock(made->mutex_);
  made->run(lock, false);
  return made;
}

bool BrickVolume::push(std::span<const std::byte> bytes) {
  std::unique_lock lock(mutex_);
  inbox_.front.insert(inbox_.front.end(), bytes.begin(), bytes.end());
  inbox_.bytes += bytes.size();
  bound_inbox(lock);
  return true;
}

void BrickVolume::finish() {
  const std::lock_guard lock(mutex_);
  inbox_.finished = true;
}

bool BrickVolume::add(std::uint64_t offset, std::span<const std::byte> chunk) {
  std::unique_lock lock(mutex_);
  inbox_.chunks.push_back({offset, {chunk.begin(), chunk.end()}});
  inbox_.bytes += chunk.size();
  bound_inbox(lock);
  return true;
}

bool BrickVolume::set_directory(std::span<const std::byte> chunks) {
  const std::lock_guard lock(mutex_);
  inbox_.directory.assign(chunks.begin(), chunks.end());
  return true;
}

void BrickVolume::forget(std::uint32_t viewport) {
  const std::lock_guard lock(mutex_);
  views_changed_ =
      std::erase_if(views_, [&](const LodView& view) { return view.viewport == viewport; }) > 0 || views_changed_;
}

std::vector<LodView> BrickVolume::views() const {
  const std::lock_guard lock(mutex_);
  return views_;
}

std::vector<ChunkRange> BrickVolume::wanted() const {
  const std::lock_guard lock(mutex_);
  return wanted_;
}

std::shared_ptr<const Volume> BrickVolume::latest() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

std::uint64_t BrickVolume::revision() const {
  const std::lock_guard lock(mutex_);
  // Received bytes become due while nothing is drawn. The next picture then decodes them.
  return 2 * revision_ + (!working_ && is_due() ? 1 : 0);
}

BrickStatistics BrickVolume::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

// Reports whether there is something to decode. Growth of the stream waits until it is worth the work, but the last
// bytes that views wait for are decoded at once.
bool BrickVolume::is_due() const {
  if (views_changed_ || !inbox_.directory.empty() || inbox_.finished) return true;
  if (inbox_.bytes == 0) return false;
  std::uint64_t missing = 0;
  for (const ChunkRange& range : wanted_) missing += range.bytes;
  return inbox_.bytes * kGrowthPart >= taken_ || inbox_.bytes >= missing ||
         std::chrono::steady_clock::now() - last_work_ >= kGrowthTime;
}

void BrickVolume::work(Inbox inbox, const std::vector<LodView>& views) {
  if (!inbox.front.empty()) (void)decoder_.push(inbox.front);
  if (inbox.finished) decoder_.finish();
  if (!inbox.directory.empty()) (void)decoder_.set_directory(inbox.directory);
  for (const Chunk& chunk : inbox.chunks) (void)decoder_.add(chunk.offset, chunk.bytes);
  std::shared_ptr<const Volume> made = decoder_.decode(views, stop_);
  std::vector<ChunkRange> wanted = decoder_.wanted();
  const BrickStatistics statistics = decoder_.statistics();
  inbox = {};
  // Each growth of a stream replaces bricks and vectors.
  return_freed_memory();
  const std::lock_guard lock(mutex_);
  shown_ = std::move(made);
  wanted_ = std::move(wanted);
  statistics_ = statistics;
  last_work_ = std::chrono::steady_clock::now();
  working_ = false;
  ++revision_;
}

// Decodes on this thread, or on another one. No other work may run.
void BrickVolume::run(std::unique_lock<std::mutex>& lock, bool beside) {
  Inbox inbox = std::exchange(inbox_, {});
  taken_ += inbox.bytes;
  views_changed_ = false;
  working_ = true;
  if (beside) {
    running_ = std::async(std::launch::async, [this, inbox = std::move(inbox), views = views_]() mutable {
      work(std::move(inbox), views);
    });
    return;
  }
  lock.unlock();
  work(std::move(inbox), views());
  lock.lock();
}

void BrickVolume::await(std::unique_lock<std::mutex>& lock) {
  if (!working_) return;
  lock.unlock();
  running_.wait();
  lock.lock();
}

// Decodes now if too many bytes wait, for example because nothing draws the volume.
void BrickVolume::bound_inbox(std::unique_lock<std::mutex>& lock) {
  if (inbox_.bytes < kMostWaiting) return;
  await(lock);
  run(lock, false);
}

std::shared_ptr<const Volume> BrickVolume::cut(const LodView& view, bool& pending) {
  std::unique_lock lock(mutex_);
  const auto same = std::ranges::find(views_, view.viewport, &LodView::viewport);
  if (same == views_.end()) {
    if (views_.size() == kMostViews) views_.erase(views_.begin());
    views_.push_back(view);
    views_changed_ = true;
  } else if (*same != view) {
    *same = view;
    views_changed_ = true;
  }
  const bool waits = view.most_decoded == 0;
  if (waits) await(lock);
  if (!working_ && (is_due() || (waits && inbox_.bytes > 0))) {
    // The former volume is not drawn while this thread waits for the next one.
    if (waits) shown_.reset();
    run(lock, !waits);
  }
  pending = pending || working_ || is_due() || inbox_.bytes > 0;
  return shown_;
}

}  // namespace gs::qnv
