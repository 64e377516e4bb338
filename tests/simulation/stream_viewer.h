#pragma once

#include "app/streams/load_ledger.h"
#include "app/streams/ranged_stream.h"
#include "app/streams/stream_feed.h"
#include "net/cells/cell_assembly.h"
#include "net/load/loader.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/simulation/random.h"
#include "tests/simulation/served_files.h"
#include "tests/simulation/trace.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::simulation {

/// Viewer of one stream, as a window has it: feeds the received bytes to the decoder of the stream, and changes its
/// view. Checks every picture.
class StreamPicture {
 public:
  StreamPicture(std::string name, Random random) : name_(std::move(name)), random_(random) {}

  /// Begins with the first bytes of the stream. Returns false if they do not contain the whole header.
  bool begin(std::span<const std::byte> front);
  /// Adds the next bytes in order.
  void push(std::span<const std::byte> bytes);
  /// Adds a whole chunk.
  void add_chunk(std::span<const std::byte> chunk);
  /// Adds a chunk, or some of its records, that came as cells.
  void add_piece(const net::CellEvent& event);
  /// Draws a picture from a new or the same view. `all` requests the whole stream in full detail.
  void draw(bool all);
  /// Checks that everything was received.
  void check_whole(const Bytes& content);
  /// Reports whether a view of everything in full detail lacks nothing.
  [[nodiscard]] bool complete() const { return stream_ && stream_->complete(); }
  [[nodiscard]] const std::shared_ptr<app::StreamFeed>& feed() const { return feed_; }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }

 private:
  void check(const qnv::VectorArrays& vectors, const Box& box) const;

  std::string name_;
  Random random_;
  std::shared_ptr<app::StreamFeed> feed_;
  std::shared_ptr<qnv::LodStream> stream_;
  std::unique_ptr<qnv::StreamDecoder> decoder_;
  qnv::LodView view_;
  std::size_t pictures_ = 0, most_vectors_ = 0;
};

/// Client of one stream over HTTP: its first bytes, then what views want.
class StreamClient {
 public:
  StreamClient(net::LoadRequests& loader, const Content& content, Random random, Trace& trace);

  /// Handles an event of the loader. Returns false if it belongs to another client.
  bool take(net::LoadEvent& event, std::int64_t now);
  void draw(std::int64_t now);
  [[nodiscard]] const Content& content() const { return content_; }
  [[nodiscard]] bool over() const { return over_; }
  /// Returns the reason why the stream is incomplete; empty if it is complete.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] std::uint64_t received() const { return received_; }
  [[nodiscard]] std::size_t pictures() const { return picture_.pictures(); }

 private:
  void take_front(net::LoadEvent& event);
  void begin_ranges();
  void end(std::string problem, std::int64_t now);

  net::LoadRequests& loader_;
  const Content& content_;
  Random random_;
  Trace& trace_;
  std::string url_;
  StreamPicture picture_;
  std::optional<net::RequestId> request_;
  std::vector<std::byte> front_;
  bool begun_ = false, whole_ = false, over_ = false, sunk_ = false;
  net::LoadHead head_;
  std::shared_ptr<app::LoadLedger> ledger_ = std::make_shared<app::LoadLedger>();
  std::uint64_t row_ = 0;
  std::unique_ptr<app::RangedStream> ranges_;
  std::size_t views_ = 0;  // that remain before the view of everything
  std::uint64_t received_ = 0;
  std::optional<std::string> ended_;  // set by the sink
  std::string problem_;
};

}  // namespace gs::simulation
