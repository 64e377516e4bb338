#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "net/http/http_cache.h"
#include "net/load/load_queue.h"
#include "net/load/transport.h"

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
};

/// Part of a request. At most one transfer at a time loads it.
struct Fetch {
  ByteRange range;
  std::uint64_t position = 0;  // offset of the next byte to receive
  TransferId transfer = 0;  // 0 means that no transfer runs
  TimePoint not_before{};
  unsigned failures = 0;  // failures after the last progress
  unsigned attempts = 0;
  bool conditional = false;  // only asks the server whether the cached version is still valid
  bool finished = false;
  bool paused = false;
  bool preempted = false;  // paused so that a more urgent transfer can run

  /// State of the current response of a fetch.
  struct Answer {
    std::string redirect;
    AddressSpace space = AddressSpace::global;  // space of the responding host
    std::optional<LoadError> error;
    bool transient = false;
    std::optional<std::int64_t> retry_after;
    std::optional<ResponseHead> not_modified;
    bool whole = false;
    std::optional<std::uint64_t> end;  // end of the body, as an offset in the resource
    std::vector<std::byte> held;  // body bytes delivered after the cached bytes
    std::optional<TransferEnd> held_end;
  } answer;
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
  [[nodiscard]] int priority() const { return request_.priority; }
  void set_priority(int priority) { request_.priority = priority; }
  [[nodiscard]] const Scheme* scheme() const { return scheme_; }
  /// Returns the host that counts for max_transfers_per_host. Returns an empty string if there is no limit.
  [[nodiscard]] const std::string& host() const { return host_; }
  [[nodiscard]] std::vector<std::unique_ptr<Fetch>>& fetches() { return fetches_; }
  /// Reports whether a fetch may start. Ignores `not_before`.
  [[nodiscard]] bool ready(const Fetch& fetch) const;
  [[nodiscard]] TransferRequest describe(const Fetch& fetch) const;
  void fail(LoadErrorKind kind, const std::string& what, int http_status = 0);

  HeadVerdict on_head(Fetch& fetch, const ResponseHead& head);
  DataVerdict on_data(Fetch& fetch, std::span<const std::byte> bytes);
  void on_end(Fetch& fetch, const TransferEnd& end, TimePoint now);
  /// Delivers cached bytes while the queue has room. Returns true if more can be delivered in another call.
  bool pump(TimePoint now);
  [[nodiscard]] bool must_wait(const Fetch& fetch) {
    return !fetch.answer.held.empty() || context_.queue.room(id_) == 0;
  }
  [[nodiscard]] bool has_cached_bytes() const { return trusted_ && !cached_pending().empty(); }

 private:
  [[nodiscard]] bool whole() const { return request_.ranges.empty(); }
  [[nodiscard]] std::string key() const;
  [[nodiscard]] bool may_cache() const;
  [[nodiscard]] std::optional<std::string> refusal() const;
  void set_url(std::string url);

  // Functions for the current version.
  void open_version();
  void look_up();
  void plan(const RangeSet& missing);
  void plan_what_is_missing();
  void emit_head(LoadHead head);
  /// Discards all delivered data and counts this as a restart. Returns false if the request fails.
  bool void_version(LoadErrorKind kind, const std::string& why);
  void restart(LoadErrorKind kind, const std::string& why, TimePoint not_before);
  bool clamp();  // limits ranges to the total size; returns false if the request fails
  [[nodiscard]] RangeSet cached_pending() const;

  // Functions for responses.
  HeadVerdict accept(Fetch& fetch, const ResponseHead& head);
  bool check_answer(Fetch& fetch, const ResponseHead& head);
  HeadVerdict accept_empty(Fetch& fetch, const ResponseHead& head);
  void settle_cached(const ResponseHead& head, bool proven);
  void adopt(const ResponseHead& head, std::optional<std::uint64_t> total);
  void open_writer(const ResponseHead& head);
  DataVerdict deliver(Fetch& fetch, std::span<const std::byte> bytes);
  void end_body(Fetch& fetch, TimePoint now);
  void follow(const std::string& location, AddressSpace space);
  void use_confirmed(Fetch& fetch);
  void retry(Fetch& fetch, const LoadError& error, bool transient, std::optional<std::int64_t> retry_after,
             TimePoint now);
  void stop(Fetch& fetch);
  void stop_all();
  void check_done();
  void finish(std::variant<LoadDone, LoadError> how);

  JobContext& context_;
  const RequestId id_;
  Request request_;
  const std::string first_url_;
  std::string url_, host_;
  const Scheme* scheme_ = nullptr;
  std::vector<std::unique_ptr<Fetch>> fetches_;
  RangeSet needed_;  // bytes that are not delivered yet
  std::uint64_t received_ = 0;
  unsigned redirects_ = 0, restarts_ = 0;
  AddressSpace reach_;  // most private space from which later responses are accepted
  bool over_ = false, use_cache_ = true;

  // Properties of the version that is being delivered: from the emitted head or the cache.
  bool head_sent_ = false;
  Validator version_;
  std::optional<std::uint64_t> total_;
  bool encoded_ = false, accepts_ranges_ = false;
  AddressSpace space_ = AddressSpace::global;
  std::optional<CachedResource> cached_;
  ByteRange cached_part_;  // part of `cached_` that is delivered
  bool trusted_ = false;  // `cached_` is fresh, or the server has confirmed it
  std::unique_ptr<CacheWriter> writer_;
};

}  // namespace gs::net
