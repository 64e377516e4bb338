#pragma once

#include "app/streams/load_ledger.h"
#include "app/streams/stream_feed.h"
#include "net/load/loader.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

namespace gs::app {

/// Reads a long packed stream from a server that can seek: first its directory, and beside a long one what follows the
/// front; then chunk by chunk what views want, as long as anyone looks. Belongs to the reading thread.
class RangedStream {
 public:
  struct Place {
    std::string url;
    net::Origin from;
    net::Validator validator;
    std::uint64_t front = 0;      // bytes that the stream has already
    std::uint64_t directory = 0;  // its offset
    std::uint64_t total = 0;
    std::shared_ptr<LoadLedger> ledger;  // that is told how far it is, as this row; never null
    std::uint64_t row = 0;
  };
  RangedStream(net::Loader& loader, std::shared_ptr<StreamFeed> feed, Place place);

  /// Asks for what views want now. True when something was asked for.
  bool ask_for_more();
  /// Takes an event of one of its requests; false: it is of another's.
  bool take(net::LoadEvent& event);
  [[nodiscard]] std::uint64_t row() const { return place_.row; }
  /// Nobody wants more of it.
  void cancel();
  /// Nothing more can be read.
  [[nodiscard]] bool over() const { return over_; }

 private:
  /// Bytes of one request that are not whole chunks yet, by the offset behind them.
  struct Batch {
    std::map<std::uint64_t, std::vector<std::byte>> runs;
    std::vector<qnv::ChunkRange> chunks;
  };
  net::RequestId request(std::vector<net::ByteRange> ranges, int priority);
  void take_data(Batch& batch, const net::LoadData& data);
  void stop_front();
  void give_up(const std::string& why);
  void stop();

  net::Loader& loader_;
  std::shared_ptr<StreamFeed> feed_;
  Place place_;
  std::optional<net::RequestId> directory_request_, front_request_;
  std::vector<std::byte> directory_;
  std::vector<qnv::ChunkRange> wanted_;
  std::unordered_set<std::uint64_t> asked_;  // offsets of chunks
  std::map<std::uint64_t, Batch> open_;      // by request
  unsigned failures_ = 0;                    // without a success between
  bool over_ = false;
};

}  // namespace gs::app
