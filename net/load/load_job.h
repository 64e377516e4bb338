#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "net/load/delivery.h"
#include "net/load/fetch_plan.h"
#include "net/load/job_cache.h"
#include "net/load/job_location.h"

namespace gs::net {

/// State that all jobs of an engine share. One thread, except for the queue.
struct JobContext {
  const LoaderOptions& options;
  LoadQueue& queue;
  HttpCache* cache = nullptr;  // null disables caching
  std::function<std::uint64_t()> random;
  std::function<std::int64_t()> unix_seconds;
  std::function<void(TransferId)> cancel;
  /// URLs of servers that support ranges. Several ranges of such a resource are requested at the same time. Bounded.
  std::map<std::string, bool> ranges_known;
  /// Hosts that have accepted a connection; true if they have answered. They may be restarting if they cannot be reached
  /// later. Bounded.
  std::map<std::string, bool> servers;
};

/// State machine of one request: cache, redirects, ranges, versions, retries. The engine starts the fetches that are
/// ready and passes their results to the job. No threads, no clock.
class LoadJob {
 public:
  LoadJob(JobContext& context, RequestId id, Request request);
  ~LoadJob();
  LoadJob(const LoadJob&) = delete;
  LoadJob& operator=(const LoadJob&) = delete;

  /// Searches the cache and plans the first fetches. May fail the request.
  void begin();
  [[nodiscard]] bool over() const { return over_; }
  [[nodiscard]] RequestId id() const { return id_; }
  [[nodiscard]] const Request& request() const { return request_; }
  void set_priority(int priority) { request_.priority = priority; }
  [[nodiscard]] const JobLocation& location() const { return location_; }
  [[nodiscard]] std::span<const std::unique_ptr<Fetch>> fetches() const { return plan_.all(); }
  /// Reports whether a fetch may start. Ignores `not_before`.
  [[nodiscard]] bool ready(const Fetch& fetch) const;
  [[nodiscard]] TransferRequest describe(const Fetch& fetch) const;
  void fail(LoadErrorKind kind, const std::string& what, int http_status = 0);

  HeadVerdict on_head(Fetch& fetch, const ResponseHead& head);
  DataVerdict on_data(Fetch& fetch, std::span<const std::byte> bytes);
  void on_end(Fetch& fetch, const TransferEnd& end, TimePoint now);
  /// Delivers cached bytes while the queue has room. Returns true if more can be delivered in another call.
  bool pump(TimePoint now);
  [[nodiscard]] bool must_wait(const Fetch& fetch) const { return !fetch.answer.held.empty() || delivery_.room() == 0; }

 private:
  // Functions for the current version.
  void open_version();
  void emit_head(const std::string& content_type);
  /// Sets the size of the resource. Returns false if the request fails.
  bool set_total(std::uint64_t total);
  /// Discards all delivered data and counts this as a restart. Returns false if the request fails.
  bool void_version(LoadErrorKind kind, const std::string& why);
  void restart(LoadErrorKind kind, const std::string& why, TimePoint not_before);
  /// Delivers cached bytes. Returns true if all were delivered.
  bool pump_cached(TimePoint now);

  // Functions for responses.
  HeadVerdict accept(Fetch& fetch, const ResponseHead& head);
  HeadVerdict accept_empty(Fetch& fetch, const ResponseHead& head);
  void adopt(const ResponseHead& head, std::optional<std::uint64_t> total);
  DataVerdict deliver(Fetch& fetch, std::span<const std::byte> bytes);
  void end_body(Fetch& fetch, TimePoint now);
  void follow(const std::string& location, AddressSpace space);
  void note_server(bool answered);
  void retry(Fetch& fetch, const LoadError& error, bool transient, std::optional<std::int64_t> retry_after,
             TimePoint now);
  void check_done();
  void finish(std::variant<LoadDone, LoadError> how);

  JobContext& context_;
  const RequestId id_;
  Request request_;
  JobLocation location_;
  Delivery delivery_;
  JobCache cache_;
  FetchPlan plan_;
  LoadVersion version_;
  unsigned restarts_ = 0;
  bool over_ = false;
  bool head_sent_ = false;  // the head of `version_` was emitted
};

}  // namespace gs::net
