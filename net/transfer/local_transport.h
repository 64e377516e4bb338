#pragma once

#include "net/transfer/transport.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace gs::net {

/// Transfer of a resource on this machine. The bytes from `next` to before `end` are not delivered yet.
struct LocalTransfer {
  TransferRequest request;
  std::uint64_t next = 0, end = 0;
  bool paused = false, over = false;
};

/// Transport of resources on this machine. Each step() advances all transfers that are not paused. `Transfer` derives
/// from LocalTransfer.
template <class Transfer>
class LocalTransport : public Transport {
 public:
  void start(TransferId id, const TransferRequest& request, TimePoint) override { transfers_[id].request = request; }
  void cancel(TransferId id) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.over = true;
  }
  void pause(TransferId id, bool paused) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.paused = paused;
  }
  void step(TransferSink& sink, TimePoint) override {
    for (auto& [id, transfer] : transfers_) {
      if (transfer.over || transfer.paused) continue;
      const auto end = advance(id, transfer, sink);
      if (!end || transfer.over) continue;
      transfer.over = true;
      sink.on_end(id, *end);
    }
    std::erase_if(transfers_, [](const auto& entry) { return entry.second.over; });
  }
  [[nodiscard]] std::optional<TimePoint> deadline(TimePoint now) const override {
    for (const auto& [id, transfer] : transfers_)
      if (transfer.over || !transfer.paused) return now;
    return std::nullopt;
  }

 protected:
  static TransferEnd failure(LoadErrorKind kind, std::string message) {
    return {LoadError{kind, std::move(message)}, false};
  }
  /// Selects the requested range of a resource with `size` bytes and delivers the head. Returns the end of the transfer
  /// if the range is invalid or empty.
  static std::optional<TransferEnd> deliver_head(TransferId id, Transfer& transfer, ResponseHead head,
                                                 std::uint64_t size, TransferSink& sink) {
    const auto& range = transfer.request.range;
    const bool unchanged = transfer.request.if_range.empty() || transfer.request.if_range == head.validator.etag;
    head.accepts_ranges = true;
    transfer.end = size;
    if (range && unchanged && (range->begin > 0 || range->end < size)) {
      if (range->begin >= size)
        return failure(LoadErrorKind::bad_request,
                       "byte " + std::to_string(range->begin) + " was requested; it has " + std::to_string(size));
      head.status = 206;
      transfer.next = range->begin;
      transfer.end = std::min(range->end, size);
      head.content_range = ContentRange{transfer.next, transfer.end, size};
    }
    head.content_length = transfer.end - transfer.next;
    transfer.over = sink.on_head(id, head) != HeadVerdict::take;
    if (transfer.over || transfer.next < transfer.end) return std::nullopt;
    return TransferEnd{};
  }
  /// Delivers the next bytes of a transfer. Returns the end of the transfer if these were the last bytes.
  static std::optional<TransferEnd> deliver(TransferId id, Transfer& transfer, std::span<const std::byte> bytes,
                                            TransferSink& sink) {
    transfer.next += bytes.size();
    const DataVerdict verdict = sink.on_data(id, bytes);
    transfer.over = verdict == DataVerdict::stop;
    transfer.paused |= verdict == DataVerdict::pause;
    if (transfer.over || transfer.next < transfer.end) return std::nullopt;
    return TransferEnd{};
  }

 private:
  /// Starts or continues a transfer. Returns its end, or nullopt if it must continue.
  virtual std::optional<TransferEnd> advance(TransferId id, Transfer& transfer, TransferSink& sink) = 0;

  std::map<TransferId, Transfer> transfers_;
};

}  // namespace gs::net
