#pragma once

#include "app/streams/stream_feed.h"
#include "net/base/url.h"
#include "net/cells/cell_driver.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Options of a cell stream.
struct CellStreamOptions {
  std::uint64_t rate = 0;  // bits per second; 0 means the server's limit
  double loss = 0;         // fraction of the received datagrams to drop, to simulate loss
  std::uint64_t loss_seed = 1;
  std::uint64_t budget = 0;                              // bytes; 0 means unlimited
  bool repair = false;                                   // requests lost data again after everything was sent
  net::AddressSpace reach = net::AddressSpace::special;  // most private address space that the server may be in
};

/// Stream that a server sends as cells: its protected base, then chunks in any order, some of which may be lost. The
/// views of its feed choose which chunks are sent first. Used by the reader thread.
class CellStream {
 public:
  /// Receiver of the stream.
  struct Sink {
    std::function<void()> granted;                     // the server accepts the request and sends
    std::function<void(std::vector<std::byte>)> base;  // start of the file
    std::function<void(const net::CellEvent&)> piece;  // a chunk, or some of its records
    /// Everything was sent, or the reason why no more follows.
    std::function<void(const std::optional<std::string>&)> ended;
  };
  /// Requests the stream at `url`, cells://host:port/path. `wake` is called on another thread when data was received.
  CellStream(const net::Url& url, const CellStreamOptions& options, Sink sink, std::function<void()> wake);

  /// Handles received data. Returns true if there was any.
  bool step();
  /// Lets the views of this feed set the priorities from now on.
  void follow(std::shared_ptr<StreamFeed> feed) { feed_ = std::move(feed); }
  /// Sets the requested rate in bits per second; 0 means the server's limit.
  void set_rate(std::uint64_t rate);
  /// Returns true if the server has sent anything.
  [[nodiscard]] bool answered() const { return answered_; }
  [[nodiscard]] bool over() const { return over_; }
  /// Returns the number of received and lost datagrams.
  [[nodiscard]] net::CellClientStatistics statistics() const;

 private:
  void take(net::CellEvent& event);
  void follow_weight();
  void end(const std::optional<std::string>& problem);

  std::string name_;  // for messages
  Sink sink_;
  std::unique_ptr<net::CellClientDriver> driver_;
  net::CellClientStatistics last_;  // statistics at the end of the driver
  std::shared_ptr<StreamFeed> feed_;
  std::string problem_;     // error at the start
  std::uint64_t rate_ = 0;  // bits per second: requested, or else the first grant of the server
  double weight_ = 1;       // weight of the feed, as last sent to the server
  std::optional<std::uint32_t> version_;
  std::vector<net::CellEvent> early_;  // pieces received before the base
  std::size_t early_bytes_ = 0;
  bool granted_ = false, base_ = false, answered_ = false, over_ = false;
};

}  // namespace gs::app
