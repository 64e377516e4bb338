#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"
#include "app/loading/fetch/cell_transfers.h"
#include "app/loading/fetch/fetch.h"
#include "app/loading/fetch/listed_folder.h"
#include "app/loading/fetch/network_transfers.h"
#include "app/loading/fetch/read_resources.h"
#include "net/base/reference_policy.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

struct Loading;

/// Progress of reading a world.
struct LoadingState {
  std::uint64_t received = 0;          // received bytes of all files
  std::optional<std::uint64_t> total;  // size of all files in bytes; nullopt if unknown
  std::size_t files = 0;               // number of files that are read or being read
  std::size_t waiting = 0;             // number of files that are incomplete
  friend bool operator==(const LoadingState&, const LoadingState&) = default;
};

/// Returns the received fraction of all files, 0 to 1; nullopt if the size of a file is unknown.
[[nodiscard]] std::optional<double> received_part(std::span<const LoadingState> states);

/// Reader of resources for content handlers. It tries the candidate URLs of each, checks the reference policy, and
/// passes the received bytes on. Local files and data: URLs are read here, others by the transfers.
class Fetcher {
 public:
  explicit Fetcher(Loading& loading);
  Fetcher(const Fetcher&) = delete;
  Fetcher& operator=(const Fetcher&) = delete;

  void set_policy(net::ReferencePolicy policy) { policy_ = std::move(policy); }
  [[nodiscard]] const net::ReferencePolicy& policy() const { return policy_; }
  /// Begins a fetch. Ignores it if loading was stopped.
  void fetch(std::unique_ptr<Fetch> wanted, Urgency urgency);
  /// Returns a function that reads resources at once for a text from `origin`.
  [[nodiscard]] ReadFile reader_of(const net::Origin& origin);
  /// Returns a function that reads several files as reader_of() does.
  [[nodiscard]] ReadFiles files_of(const net::Origin& origin);
  /// Returns a function that reads several files for views, as long as they live and on any thread.
  [[nodiscard]] ReadFiles files_for_views(const net::Origin& origin);
  /// Returns a function that lists folders in buckets for a text from `origin`. With `by_view`, views may call it
  /// on any thread, as the function of files_for_views(). Returns null for origins without buckets.
  [[nodiscard]] ListFolder lister_of(const net::Origin& origin, bool by_view);
  /// Reads the other pages of a bucket's list. `first` is its first page, and `url` the URL of that page.
  [[nodiscard]] ListedFolder listed_folder(const net::Url& url, BucketPage first, const net::Origin& origin);
  /// Returns a function that reads the files of a listed folder for a text from `origin`.
  [[nodiscard]] ReadFile reader_of_listed(std::shared_ptr<const ListedFolder> folder, const net::Origin& origin);
  /// Returns a reader that receives files from servers for views.
  [[nodiscard]] std::shared_ptr<ServedFiles> served_files() const;
  /// Handles some received data, or waits for it for at most `wait`. Returns false if nothing is being read.
  bool step(std::chrono::milliseconds wait);
  // If no earlier fetch is running, the count of files starts again at 0.
  void restart();
  /// Cancels the fetches with unwanted handlers, because another url was set.
  void withdraw(const std::function<bool(const ContentHandler&)>& is_unwanted);
  /// Returns true if a fetch for `handler` continues.
  [[nodiscard]] bool reads_for(const ContentHandler& handler) const;
  /// Returns true if everything is read or reading was stopped. Streams may still grow.
  [[nodiscard]] bool is_done() const { return phase_ == Phase::done || phase_ == Phase::stopped; }
  /// Returns true while views request finer vectors of streams.
  [[nodiscard]] bool has_streams() const { return network_.has_streams() || cells_.has_streams(); }
  [[nodiscard]] LoadingState state() const;
  [[nodiscard]] NetworkTransfers& network() { return network_; }
  [[nodiscard]] const CellTransfers& cells() const { return cells_; }

  // For the transfers.
  void begin_next_candidate(Fetch& fetch);
  void fail_candidate(Fetch& fetch, const std::string& why, const std::string& folder = {});
  void begin_taking(Fetch& fetch, const Found& found);
  void deliver(Fetch& fetch, std::span<const std::byte> bytes);
  void finish(Fetch& fetch, const std::optional<std::string>& problem);
  /// Ends a fetch of a stream; views request the rest.
  void leave_to_views(Fetch& fetch);
  void count_received(std::uint64_t bytes) { received_ += bytes; }

 private:
  [[nodiscard]] bool has_ended(const Fetch& fetch) const;
  bool begin_local(Fetch& fetch, const net::Url& url);
  bool begin_together(Fetch& fetch, const net::Url& url, Found& found);
  void local_step();
  void refine_step();
  void count_parts(Fetch& fetch);
  void stop(const std::string& why);
  void drop_transfer(Fetch& fetch);
  void watch_change(const Fetch& fetch, const std::function<void()>& take);
  void cancel(Fetch& fetch);
  void cancel_rows();
  void follow_rate();

  Loading& loading_;
  [[nodiscard]] ReadWanted read_allowed(const net::Origin& origin, ReadWanted read) const;
  [[nodiscard]] ReadFiles files_by(const net::Origin& origin, ReadWanted read) const;

  net::ReferencePolicy policy_;
  std::shared_ptr<ServedFiles> ahead_;  // holds files that were read at once; the first views use it
  NetworkTransfers network_;
  CellTransfers cells_;
  std::vector<std::unique_ptr<Fetch>> fetches_;  // incomplete fetches
  std::deque<Fetch*> local_;                     // fetches of local files, read here in order
  std::deque<Fetch*> refining_;                  // fetches with handlers that have more to read, in order
  std::vector<Fetch*> ended_;
  std::size_t files_ = 0;
  std::uint64_t received_ = 0;
  enum class Phase : std::uint8_t {
    loading,
    too_many_files,  // too many references; the next step stops loading
    done,            // complete until further urls are set
    stopped,         // stopped before the end
  };
  Phase phase_ = Phase::loading;
};

}  // namespace gs::app
