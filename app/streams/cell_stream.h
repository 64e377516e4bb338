#pragma once

#include "app/streams/cell_wishes.h"
#include "app/streams/stream_feed.h"
#include "net/base/url.h"
#include "net/cells/cell_driver.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Options of a cell stream.
struct CellStreamOptions {
  std::uint64_t rate = 0;  // requested rate in bits per second; 0 means the server's limit
  double loss = 0;  // fraction of received datagrams to drop as simulated loss
  std::uint64_t loss_seed = 1;
  std::uint64_t budget = 0;  // max bytes to receive; 0 means unlimited
  bool repair = false;  // true requests lost data again after everything was sent
  net::AddressSpace reach = net::AddressSpace::special;  // most private address space in which the server may be
};

/// Stream that a server sends as cells. First comes its protected base, then its chunks in any order; some may be lost.
/// If a feed is set, its views choose which chunks the server sends first. Reader thread only.
class CellStream {
 public:
  /// Callbacks for the parts of the stream.
  struct Sink {
    std::function<void()> granted;  // the server has accepted the request
    std::function<void(std::vector<std::byte>)> base;  // bytes of the protected base, the start of the file
    std::function<void(const net::CellEvent&)> piece;  // chunk, or some records of a chunk
    /// End of the stream, with the error if it ended too early.
    std::function<void(const std::optional<std::string>&)> ended;
  };
  /// Requests the stream at `url` (cells://host:port/path). Another thread calls `wake` after it has received data.
  CellStream(const net::Url& url, const CellStreamOptions& options, Sink sink, std::function<void()> wake);
  /// Requests the stream over an existing connection.
  CellStream(const net::Url& url, const CellStreamOptions& options, Sink sink,
             std::unique_ptr<net::CellConnection> connection);

  /// Handles received data. Returns true if there were any.
  bool step();
  /// Sets the feed. From now on, its views choose which chunks the server sends first.
  void follow(std::shared_ptr<StreamFeed> feed) { feed_ = std::move(feed); }
  /// Sets a feed. From now on, the server sends only the directory and what views want; a feed that takes bytes gets
  /// it. Returns false if the server has no directory, or views cannot choose. Call it when the base is received.
  [[nodiscard]] bool follow_wishes(std::shared_ptr<StreamFeed> feed, std::span<const std::byte> base);
  /// Sets the requested rate in bits per second. 0 means the server's limit.
  void set_rate(std::uint64_t rate);
  /// Returns true if the server has sent anything so far.
  [[nodiscard]] bool answered() const { return answered_; }
  [[nodiscard]] bool over() const { return over_; }
  /// Returns true if only views choose what the server sends.
  [[nodiscard]] bool by_wishes() const { return wishes_.has_value(); }
  /// Returns true if nothing is awaited that views want.
  [[nodiscard]] bool rests() const { return over_ || (wishes_ && wishes_->rests()); }
  /// Returns true if the server has sent everything, but lost data are missing.
  [[nodiscard]] bool missing() const { return missing_; }
  /// Returns the statistics of received and lost datagrams.
  [[nodiscard]] net::CellClientStatistics statistics() const;

 private:
  void want(const net::Url& url, const CellStreamOptions& options);
  void prefer();
  void take(net::CellEvent& event);
  void take_piece(net::CellEvent& event);
  void follow_weight();
  void end(const std::optional<std::string>& problem);

  std::string name_;  // URL, for messages
  Sink sink_;
  std::unique_ptr<net::CellConnection> driver_;
  net::CellClientStatistics last_;  // final statistics, after the driver has ended
  std::shared_ptr<StreamFeed> feed_;
  std::string problem_;  // error before the first request
  net::CellWish wish_;   // the request
  std::uint32_t places_ = 0;  // chunks of the directory that the server offers
  std::optional<CellWishes> wishes_;
  std::uint64_t rate_ = 0;  // bits per second: as requested, else the server's first grant
  double weight_ = 1;  // weight of the feed that is in effect
  std::optional<std::uint32_t> version_;
  std::vector<net::CellEvent> early_;  // pieces that were received before the base
  std::size_t early_bytes_ = 0;
  bool granted_ = false, base_ = false, answered_ = false, over_ = false, missing_ = false;
};

}  // namespace gs::app
