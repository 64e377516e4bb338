#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"
#include "app/loading/fetch/fetch.h"
#include "app/loading/fetch/load_notices.h"
#include "app/loading/fetch/read_resources.h"
#include "app/streams/ranged_stream.h"
#include "app/streams/viewed_transfer.h"
#include "net/load/loader.h"
#include "vrml/scene/scene_graph.h"

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::app {

struct Loading;

/// Transfers from the network, by the loader.
class NetworkTransfers {
 public:
  using Nodes = std::unordered_set<const vrml::Node*>;
  using Importance = std::unordered_map<const vrml::Node*, float>;

  explicit NetworkTransfers(Loading& loading) : loading_(loading) {}

  /// Returns the options of the loader.
  [[nodiscard]] net::LoaderOptions loader_options() const;
  /// Returns the loader; creates it at the first call.
  [[nodiscard]] net::Loader& loader();
  /// Requests the current candidate of a fetch.
  void begin(Fetch& fetch);
  void cancel(Fetch& fetch);
  void cancel_all();
  /// Handles what the loader has received. Returns true if there was anything.
  bool step();
  void set_rate();
  /// Returns the bytes of a resource. Blocks; events of other requests are queued meanwhile.
  [[nodiscard]] BytesResult read_now(const net::Url& url, const net::Origin& from);
  /// Returns the bytes of several resources, which are requested at once. Blocks as read_now().
  [[nodiscard]] std::vector<FileResult> read_all_now(std::span<const WantedPart> wanted, const net::Origin& from);

  /// Cancels the stream of this row in the ledger.
  void cancel_stream(std::uint64_t row);
  /// Adds a transfer of parts that views choose.
  void add_stream(std::shared_ptr<ViewedTransfer> stream) { streams_.push_back(std::move(stream)); }
  /// Requests what views want. Returns true if there was anything.
  bool step_streams();
  [[nodiscard]] bool has_streams() const { return !streams_.empty(); }
  /// Returns true if no stream awaits data that it has requested.
  [[nodiscard]] bool streams_rest() const;
  /// Returns true if streams have grown since the last call.
  [[nodiscard]] bool take_growth() { return std::exchange(streams_grew_, false); }
  void note_growth() { streams_grew_ = true; }

  /// Returns the nodes that wait for data.
  [[nodiscard]] Nodes wanted() const;
  /// Computes priorities by `importance`, a function of the waiting nodes.
  void set_importance(std::function<Importance(const Nodes&)> importance) { importance_ = std::move(importance); }
  void set_priorities();

 private:
  void ask(Fetch& fetch, std::vector<net::ByteRange> ranges);
  void take(Fetch& fetch, net::LoadEvent& event);
  bool take_front(Fetch& fetch, const net::LoadHead& head);
  bool read_parts(Fetch& fetch);
  void take_rest(Fetch& fetch);
  void end_request(Fetch& fetch);

  Loading& loading_;
  std::shared_ptr<LoadNotices> notices_ = std::make_shared<LoadNotices>();
  std::unique_ptr<net::Loader> loader_;  // created for the first network resource
  std::unordered_map<std::uint64_t, Fetch*> by_request_;
  std::deque<net::LoadEvent> events_;  // received events that are not handled yet
  std::vector<std::shared_ptr<ViewedTransfer>> streams_;
  bool streams_grew_ = false;
  std::function<Importance(const Nodes&)> importance_;
  std::chrono::steady_clock::time_point next_priorities_;
};

}  // namespace gs::app
