#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "net/load/load_queue.h"

namespace gs::net {

/// Bytes that a request still needs, and their way to the queue. Each needed byte is pushed once. One thread.
class Delivery {
 public:
  /// `queue` and `request` must outlive the delivery.
  Delivery(LoadQueue& queue, RequestId id, const Request& request) : queue_(queue), id_(id), request_(request) {}

  /// Begins again with all requested bytes.
  void begin();
  /// Reports whether the whole resource is requested, not ranges.
  [[nodiscard]] bool whole() const { return request_.ranges.empty(); }
  /// Returns the requested bytes that were not pushed.
  [[nodiscard]] const RangeSet& needed() const { return needed_; }
  /// Returns the number of pushed bytes.
  [[nodiscard]] std::uint64_t received() const { return received_; }
  /// Drops needed bytes after the end of a resource of `total` bytes. Returns an error if a requested range begins
  /// there or if the size exceeds the limit of the request.
  [[nodiscard]] std::optional<LoadError> limit_to(std::uint64_t total);
  /// Reports whether the needed bytes in `range` would exceed the limit of the request.
  [[nodiscard]] bool exceeds_limit(ByteRange range) const;
  /// Reports whether bytes from `position` on can be pushed in order: no needed bytes directly before them are missing.
  [[nodiscard]] bool is_next(std::uint64_t position) const;
  /// Pushes the needed bytes among `bytes`, which begin at `begin`. Returns false if none was needed.
  bool push(std::uint64_t begin, std::span<const std::byte> bytes);
  [[nodiscard]] std::size_t room() const { return queue_.room(id_); }

 private:
  LoadQueue& queue_;
  const RequestId id_;
  const Request& request_;
  RangeSet needed_;
  std::uint64_t received_ = 0;
};

}  // namespace gs::net
