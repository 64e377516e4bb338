#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/noncopyable.h"
#include "net/load/load_job.h"

namespace gs::net {

/// Engine of one loader thread: advances the jobs and selects the transfers that run. Time is an argument, so tests
/// with the memory transport need neither threads nor waiting.
class LoadEngine final : private TransferSink, NonCopyable {
 public:
  /// Creates an engine without jobs. `options`, `queue` and `cache` must outlive it. A null `cache` disables caching.
  LoadEngine(const LoaderOptions& options, LoadQueue& queue, HttpCache* cache);
  ~LoadEngine();

  void add_transport(TransportKind kind, std::unique_ptr<Transport> transport);
  /// Makes all requests for this transport fail. `why` is the reason in the message.
  void refuse_transport(TransportKind kind, std::string why);

  // Starts a request. The request must be open in the queue.
  void request(RequestId id, Request request);
  void cancel(RequestId id);
  void set_priority(RequestId id, int priority);

  /// Advances all jobs. Returns the time before which `step` must be called again. Returns nullopt if only a new
  /// request or a ready socket makes another call necessary.
  std::optional<TimePoint> step(TimePoint now);
  [[nodiscard]] std::vector<int> readable() const;

 private:
  struct Running {
    LoadJob* job;
    Fetch* fetch;
    Transport* transport;
  };
  struct Candidate {
    LoadJob* job;
    Fetch* fetch;
  };
  struct Load {
    std::size_t all = 0, all_preempted = 0;
    std::map<std::string, std::size_t> host, host_preempted;
    std::map<std::uint32_t, std::size_t> viewport;
  };

  HeadVerdict on_head(TransferId id, const ResponseHead& head) override;
  DataVerdict on_data(TransferId id, std::span<const std::byte> bytes) override;
  void on_end(TransferId id, const TransferEnd& end) override;

  /// Removes a transfer from running_. Returns nullopt if it is not running.
  std::optional<Running> remove(TransferId id);
  void stop(TransferId id);
  void pump();
  void hold_back();
  void schedule();
  void schedule_equals(std::span<const Candidate> candidates, Load& load);
  [[nodiscard]] Load count_load() const;
  [[nodiscard]] bool fits(const LoadJob& job, const Load& load) const;
  bool make_room(const LoadJob& job, Load& load);
  void let_run(const Candidate& candidate, Load& load);
  [[nodiscard]] std::optional<TimePoint> next_deadline() const;

  const LoaderOptions& options_;
  LoadQueue& queue_;
  JobContext context_;
  std::map<TransportKind, std::unique_ptr<Transport>> transports_;
  std::map<TransportKind, std::string> refused_transports_;  // reason by transport
  std::map<RequestId, std::unique_ptr<LoadJob>> jobs_;
  std::unordered_map<TransferId, Running> running_;
  std::set<RequestId> touched_;  // jobs that may be over or may have new fetches
  std::set<RequestId> pumping_;  // jobs with cached bytes to deliver
  TransferId last_transfer_ = 0;
  TimePoint now_{};
  std::optional<TimePoint> next_ready_;
  bool schedule_needed_ = false;
};

}  // namespace gs::net
