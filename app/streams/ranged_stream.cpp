#include "app/streams/ranged_stream.h"

#include "qnv/container/container.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

// Maximum gap in bytes between two ranges of one request. Reading a smaller gap costs less than another request.
constexpr std::uint64_t kJoin = 16384;
// Limits of a group of wanted chunks that one request reads together, in bytes: gap between two of them, and total.
constexpr std::uint64_t kNearChunk = 4096, kMostNear = std::uint64_t{64} << 10;
constexpr std::uint64_t kBatch = std::uint64_t{256} << 10;  // max bytes per request
constexpr std::size_t kMaxOpen = 3;  // max concurrent requests; several keep the connection busy
constexpr unsigned kMaxFailures = 5;
constexpr std::uint64_t kLongDirectory = std::uint64_t{128} << 10;
constexpr std::uint64_t kMaxDirectory = std::uint64_t{256} << 20;
constexpr int kDirectoryPriority = 1900, kChunkPriority = 1500;  // between Urgency::vectors and the next one

}  // namespace

RangedStream::RangedStream(net::LoadRequests& loader, std::shared_ptr<StreamFeed> feed, Place place, Sink sink)
    : loader_(loader), feed_(std::move(feed)), place_(std::move(place)), sink_(std::move(sink)) {
  if (!has_fetch()) place_.ledger->follow(place_.row, feed_.get(), true);
  if (place_.total - place_.directory > kMaxDirectory)
    give_up("its directory exceeds the limit");
  else
    directory_request_ = request({{place_.directory, place_.total}}, kDirectoryPriority);
  // Views cannot choose chunks before the directory is here. Meanwhile, read the chunks in the order of the file.
  // Read at most as many bytes as the directory has; more would delay the chunks that views choose.
  const std::uint64_t length = place_.total - place_.directory;
  if (!over_ && !has_fetch() && length > kLongDirectory)
    front_request_ = request({{place_.front, std::min(place_.directory, place_.front + length)}}, kDirectoryPriority);
}

net::RequestId RangedStream::request(std::vector<net::ByteRange> ranges, int priority) {
  net::Request wanted;
  wanted.url = place_.url;
  wanted.from = place_.from;
  wanted.ranges = std::move(ranges);
  wanted.priority = priority;
  wanted.validator = place_.validator;
  return loader_.request(std::move(wanted));
}

void RangedStream::sort_wanted() {
  by_offset_.resize(wanted_.size());
  place_of_.resize(wanted_.size());
  std::iota(by_offset_.begin(), by_offset_.end(), std::size_t{0});
  std::ranges::sort(by_offset_, {}, [&](std::size_t number) { return wanted_[number].offset; });
  for (std::size_t place = 0; place < by_offset_.size(); ++place) place_of_[by_offset_[place]] = place;
}

bool RangedStream::add_wanted(std::size_t number, Batch& batch) {
  const qnv::ChunkRange& chunk = wanted_[number];
  if (chunk.offset + chunk.bytes <= place_.front || chunk.offset + chunk.bytes > place_.directory) return false;
  // Chunks of a long stream may be received, dropped and wanted again.
  const bool again = chunk.again && taken_.contains(chunk.offset) && asked_again_.insert(chunk.offset).second;
  if (again) taken_.erase(chunk.offset);
  if (!asked_.insert(chunk.offset).second && !again) return false;
  batch.chunks.push_back(chunk);
  batch.bytes += chunk.bytes;
  return true;
}

bool RangedStream::ask_for_more() {
  if (over_ || directory_request_) return false;
  if (feed_->take_wanted(wanted_)) {
    asked_again_.clear();
    sort_wanted();
  }
  bool any = false;
  // A stream with a lower weight requests fewer bytes, so that it gets a smaller part of the connection.
  const std::uint64_t most = std::max(static_cast<std::uint64_t>(kBatch * feed_->weight()), kJoin);
  while (open_.size() < kMaxOpen) {
    Batch batch;
    for (std::size_t number = 0; number < wanted_.size() && batch.bytes < most; ++number) {
      const std::uint64_t limit = std::min(most, batch.bytes + kMostNear);
      if (!add_wanted(number, batch)) continue;
      // Adds nearby chunks, because a separate request for them would cost a round trip. Without cuts, all chunks are
      // wanted, and nearby ones may be hidden.
      if (has_fetch()) continue;
      for (const bool up : {true, false}) {
        std::size_t place = place_of_[number];
        while (batch.bytes < limit && (up ? place + 1 < by_offset_.size() : place > 0)) {
          const qnv::ChunkRange& last = wanted_[by_offset_[place]];
          place = up ? place + 1 : place - 1;
          const qnv::ChunkRange& next = wanted_[by_offset_[place]];
          const qnv::ChunkRange &lower = up ? last : next, &upper = up ? next : last;
          if (upper.offset > lower.offset + lower.bytes + kNearChunk) break;
          if (!add_wanted(by_offset_[place], batch)) break;
        }
      }
    }
    if (batch.chunks.empty()) break;
    net::RangeSet ranges;
    for (const qnv::ChunkRange& chunk : batch.chunks) ranges.add({chunk.offset, chunk.offset + chunk.bytes});
    const net::RequestId id = request(ranges.joined(kJoin), kChunkPriority);
    open_.emplace(id.value, std::move(batch));
    any = true;
  }
  end_if_complete();
  return any;
}

// Ends a stream without cuts, which is complete when all of its chunks are received.
void RangedStream::end_if_complete() {
  if (!has_fetch() || !open_.empty()) return;
  stop();
  sink_.end(std::nullopt);
}

bool RangedStream::take(net::LoadEvent& event) {
  const bool of_this = (front_request_ && event.id == *front_request_) ||
                       (directory_request_ && event.id == *directory_request_) || open_.contains(event.id.value);
  if (const auto* data = std::get_if<net::LoadData>(&event.what); data && of_this)
    place_.ledger->receive(place_.row, data->bytes.size(), {});
  if (front_request_ && event.id == *front_request_) {
    if (const auto* data = std::get_if<net::LoadData>(&event.what)) feed_->push(data->bytes);
    if (!std::holds_alternative<net::LoadHead>(event.what) && !std::holds_alternative<net::LoadData>(event.what))
      stop_front();
    return true;
  }
  const bool of_directory = directory_request_ && event.id == *directory_request_;
  const auto batch = open_.find(event.id.value);
  if (!of_directory && batch == open_.end()) return false;
  if (const auto* data = std::get_if<net::LoadData>(&event.what)) {
    if (of_directory)
      directory_.insert(directory_.end(), data->bytes.begin(), data->bytes.end());
    else
      take_data(batch->second, *data);
  } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
    loader_.cancel(event.id);
    give_up("it changed on the server; reload to get the new version");
  } else if (std::holds_alternative<net::LoadDone>(event.what)) {
    failures_ = 0;
    if (of_directory) {
      take_directory();
    } else {
      open_.erase(batch);
    }
  } else if (const auto* error = std::get_if<net::LoadError>(&event.what)) {
    if (of_directory || ++failures_ >= kMaxFailures || error->kind == net::LoadErrorKind::changed) {
      give_up(error->message);
    } else {
      for (const qnv::ChunkRange& chunk : batch->second.chunks) asked_.erase(chunk.offset);
      open_.erase(batch);
    }
  }
  return true;
}

void RangedStream::take_directory() {
  directory_request_.reset();
  stop_front();
  has_directory_ = feed_->set_directory(std::exchange(directory_, {}));
  if (!has_directory_) give_up("its directory is invalid");
}

// Takes the chunks out of received data. A range begins at a chunk, and a gap consists of complete chunks.
void RangedStream::take_data(Batch& batch, const net::LoadData& data) {
  std::vector<std::byte> run;
  if (const auto before = batch.runs.find(data.offset); before != batch.runs.end()) {
    run = std::move(before->second);
    batch.runs.erase(before);
  }
  std::uint64_t at = data.offset - run.size();
  run.insert(run.end(), data.bytes.begin(), data.bytes.end());
  std::span<const std::byte> rest(run);
  for (auto head = qnv::chunk_head(rest); head && head->bytes <= rest.size(); head = qnv::chunk_head(rest)) {
    const std::size_t size = head->bytes;
    asked_.insert(at);
    take_chunk(at, rest.first(size));
    at += size;
    rest = rest.subspan(size);
  }
  if (!rest.empty()) batch.runs[at + rest.size()] = {rest.begin(), rest.end()};
}

// Passes a chunk on. The gaps of two requests may contain the same chunk.
void RangedStream::take_chunk(std::uint64_t offset, std::span<const std::byte> chunk) {
  if (!taken_.insert(offset).second) return;
  std::vector<std::byte> bytes(chunk.begin(), chunk.end());
  if (has_fetch())
    sink_.chunk(std::move(bytes));
  else
    feed_->add(offset, std::move(bytes));
}

void RangedStream::stop_front() {
  if (front_request_) loader_.cancel(*front_request_);
  front_request_.reset();
}

void RangedStream::give_up(const std::string& why) {
  stop();
  if (has_fetch()) return has_directory_ ? sink_.end(why) : sink_.read_on();
  place_.ledger->end(place_.row, LoadStage::failed, why);
  feed_->fail("finer vectors of " + place_.url + " cannot be read: " + why);
}

void RangedStream::cancel() {
  if (over_) return;
  stop();
  place_.ledger->end(place_.row, LoadStage::cancelled);
}

void RangedStream::stop() {
  over_ = true;
  for (const auto& [id, batch] : open_) loader_.cancel({id});
  if (directory_request_) loader_.cancel(*directory_request_);
  stop_front();
  open_.clear();
  directory_request_.reset();
}

}  // namespace gs::app
