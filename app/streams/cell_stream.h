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

/// How a stream of cells is asked for.
struct CellStreamOptions {
  std::uint64_t rate = 0;  // bits a second; 0: as many as the server grants
  double loss = 0;         // this share of its datagrams is dropped as they come, as if they had never come
  std::uint64_t loss_seed = 1;
  std::uint64_t budget = 0;                              // bytes; 0: no limit
  bool repair = false;                                   // what was lost is asked for again once all was sent
  net::AddressSpace reach = net::AddressSpace::special;  // the most private space in which the server may be
};

/// A stream that a server sends as cells: its base, then chunks in any order, of which some never come. Whoever looks
/// at it says through its feed where, and what is there comes first. Belongs to the reading thread.
class CellStream {
 public:
  /// What takes the bytes.
  struct Sink {
    std::function<void()> granted;                                 // the server has it, and sends
    std::function<void(std::vector<std::byte>)> base;              // the start of the file
    std::function<void(const net::CellEvent&)> piece;              // a chunk, or some of its records
    std::function<void(const std::optional<std::string>&)> ended;  // all was sent; or why no more comes
  };
  /// `url`: cells://host:port/path. `wake`: something has come; called on another thread.
  CellStream(const net::Url& url, const CellStreamOptions& options, Sink sink, std::function<void()> wake);

  /// Takes in what has come. True when there was something.
  bool step();
  /// From now on the views of this feed say what comes first.
  void follow(std::shared_ptr<StreamFeed> feed) { feed_ = std::move(feed); }
  /// How many bits a second the server is asked for from now on; 0: as many as it grants.
  void set_rate(std::uint64_t rate);
  /// The server has said anything.
  [[nodiscard]] bool answered() const { return answered_; }
  [[nodiscard]] bool over() const { return over_; }
  /// Datagrams, and those that were lost.
  [[nodiscard]] net::CellClientStatistics statistics() const;

 private:
  void take(net::CellEvent& event);
  void follow_weight();
  void end(const std::optional<std::string>& problem);

  std::string name_;  // for messages
  Sink sink_;
  std::unique_ptr<net::CellClientDriver> driver_;
  net::CellClientStatistics last_;  // when the driver had ended
  std::shared_ptr<StreamFeed> feed_;
  std::string problem_;     // of the start
  std::uint64_t rate_ = 0;  // bits a second: wanted, or, where nobody says, what the server granted first
  double weight_ = 1;       // of the feed, as the server was told last
  std::optional<std::uint32_t> version_;
  std::vector<net::CellEvent> early_;  // pieces that came before the base
  std::size_t early_bytes_ = 0;
  bool granted_ = false, base_ = false, answered_ = false, over_ = false;
};

}  // namespace gs::app
