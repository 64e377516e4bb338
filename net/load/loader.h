#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "net/load/load_types.h"

namespace gs::net {

/// Gets bytes by URL, off the calling thread. All calls from one thread; what comes is handed out by poll() only.
///
/// Two threads of its own: one for networks, one for disks. Bytes on their way are bounded: who does not poll is not
/// sent more. Destruction stops everything at once, whatever servers do; only a read from a disk that hangs is waited
/// for.
class Loader {
 public:
  [[nodiscard]] static std::unique_ptr<Loader> create(LoaderOptions options = {});
  ~Loader();
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// Never blocks, never fails: what is wrong comes as event.
  RequestId request(Request request);
  /// From now on nothing comes of this request. What did come stays in the cache. Ids that have ended are passed over.
  void cancel(RequestId id);
  /// Also while it runs: less urgent transfers are held back where more urgent ones wait.
  void set_priority(RequestId id, int priority);
  /// From now on, in place of LoaderOptions::bytes_per_second; 0: any.
  void set_rate(std::uint64_t bytes_per_second);

  /// What has happened since: by priority, in order within a request, with at most `max_bytes` bytes of data. What is
  /// left over does not wake again: poll once more while queued_bytes() is not 0.
  [[nodiscard]] std::vector<LoadEvent> poll(std::size_t max_bytes = std::size_t{4} << 20);

  /// Nothing for what has ended and been polled, or was cancelled.
  [[nodiscard]] std::optional<LoadProgress> progress(RequestId id) const;
  /// Over all open requests.
  [[nodiscard]] LoadProgress progress() const;
  /// Bytes that wait for poll().
  [[nodiscard]] std::size_t queued_bytes() const;
  /// Why there is no cache although a folder was named; empty: there is, or it is still being opened.
  [[nodiscard]] std::string cache_problem() const;

 private:
  struct Parts;
  explicit Loader(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace gs::net
