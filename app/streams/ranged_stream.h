#pragma once

#include "app/streams/load_ledger.h"
#include "app/streams/stream_feed.h"
#include "app/streams/viewed_transfer.h"
#include "net/load/loader.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

namespace gs::app {

/// Reader of a long stream from an HTTP server, with Range requests. First it reads the directory. If that is long and
/// the feed takes bytes, it also reads the bytes after `front` meanwhile. Then it reads the chunks that views want, in
/// the order of StreamFeed::take_wanted. Reader thread only.
class RangedStream final : public ViewedTransfer {
 public:
  struct Place {
    std::string url;
    net::Origin from;
    net::Validator validator;
    std::uint64_t front = 0;  // number of first bytes that the stream already has
    std::uint64_t directory = 0;  // byte offset of the directory
    std::uint64_t total = 0;
    std::shared_ptr<LoadLedger> ledger;  // ledger for the progress of `row`; never null
    std::uint64_t row = 0;
  };
  /// Receiver of the chunks if the feed takes no bytes. The stream then ends after its last chunk.
  struct Sink {
    std::function<void(std::vector<std::byte>)> chunk;
    std::function<void(const std::optional<std::string>& problem)> end;
    std::function<void()> read_on;  // the directory is unusable; the bytes after `front` must be read in order
  };
  RangedStream(net::LoadRequests& loader, std::shared_ptr<StreamFeed> feed, Place place, Sink sink = {});

  bool ask_for_more() override;
  bool take(net::LoadEvent& event) override;
  [[nodiscard]] bool has_fetch() const override { return !feed_->takes_bytes(); }
  /// Cancels all requests and ends the stream. Does not call the sink.
  void cancel() override;
  void cancel_row(std::uint64_t row) override {
    if (row == place_.row) cancel();
  }
  /// Returns true if the directory was received, so that views choose the chunks.
  [[nodiscard]] bool has_directory() const { return has_directory_; }
  [[nodiscard]] bool over() const override { return over_; }
  [[nodiscard]] bool rests() const override { return !directory_request_ && open_.empty(); }

 private:
  /// Request for several chunks, with the chunks that are still incomplete, by their end offsets.
  struct Batch {
    std::map<std::uint64_t, std::vector<std::byte>> runs;
    std::vector<qnv::ChunkRange> chunks;
    std::uint64_t bytes = 0;  // sum over `chunks`
  };
  net::RequestId request(std::vector<net::ByteRange> ranges, int priority);
  /// Marks a wanted chunk as requested, and adds it to a batch. Returns false if it needs no request.
  bool add_wanted(std::size_t number, Batch& batch);
  void sort_wanted();
  void take_directory();
  void take_data(Batch& batch, const net::LoadData& data);
  void take_chunk(std::uint64_t offset, std::span<const std::byte> chunk);
  void end_if_complete();
  void stop_front();
  void give_up(const std::string& why);
  void stop();

  net::LoadRequests& loader_;
  std::shared_ptr<StreamFeed> feed_;
  Place place_;
  Sink sink_;
  std::optional<net::RequestId> directory_request_, front_request_;
  std::vector<std::byte> directory_;
  std::vector<qnv::ChunkRange> wanted_;
  std::vector<std::size_t> by_offset_, place_of_;  // indices in wanted_, sorted by offset; inverse of by_offset_
  std::unordered_set<std::uint64_t> asked_;  // offsets of all requested chunks
  std::unordered_set<std::uint64_t> taken_;  // offsets of all received chunks
  std::unordered_set<std::uint64_t> asked_again_;  // of those chunks, since the last change of `wanted_`
  std::map<std::uint64_t, Batch> open_;  // open requests, by request number
  unsigned failures_ = 0;  // number of consecutive failed requests
  bool has_directory_ = false, over_ = false;
};

}  // namespace gs::app
