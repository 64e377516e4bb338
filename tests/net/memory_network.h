#pragma once

#include "net/transfer/transport.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::net {

/// Simulated server and connection for one transfer of the memory: scheme.
struct MemoryAnswer {
  ResponseHead head;
  std::vector<std::byte> body;
  Milliseconds latency{0};                   // delay before the head
  std::uint64_t bytes_per_second = 0;        // rate of the body; 0 means all at once
  std::size_t block = 16384;                 // bytes delivered at a time
  std::optional<std::uint64_t> stall_after;  // no more bytes after this number of body bytes, until the time-out
  std::optional<std::uint64_t> break_after;  // the connection breaks after this number of bytes
  bool answers = true;                       // false means no response at all
  std::optional<LoadError> refused;          // connection refused
  Milliseconds stall_timeout{20'000};        // silence after which the transfer fails
};

/// Resource with a server that supports ranges, If-Range, 304 and 416.
struct MemoryResource {
  std::vector<std::byte> bytes;
  std::string content_type;
  Validator validator;
  CacheControl cache_control;
  bool ranges = true;
};

/// Returns the answer of a server that follows RFC 9110.
inline MemoryAnswer answer_well(const MemoryResource& resource, const TransferRequest& request) {
  MemoryAnswer answer;
  answer.head.content_type = resource.content_type;
  answer.head.validator = resource.validator;
  answer.head.cache_control = resource.cache_control;
  answer.head.accepts_ranges = resource.ranges;
  const Validator& version = resource.validator;
  const bool same = (!version.etag.empty() && request.if_none_match == version.etag) ||
                    (request.if_none_match.empty() && !version.last_modified.empty() &&
                     request.if_modified_since == version.last_modified);
  if (same) {
    answer.head.status = 304;
    return answer;
  }
  const std::uint64_t size = resource.bytes.size();
  ByteRange range{0, size};
  const bool may = request.if_range.empty() || request.if_range == version.strong();
  if (resource.ranges && request.range && may) {
    if (request.range->begin >= size) {
      answer.head.status = 416;
      answer.head.content_range = ContentRange{std::nullopt, std::nullopt, size};
      return answer;
    }
    range = {request.range->begin, std::min(request.range->end, size)};
    answer.head.status = 206;
    answer.head.content_range = ContentRange{range.begin, range.end, size};
  }
  answer.head.content_length = range.size();
  answer.body.assign(resource.bytes.begin() + static_cast<std::ptrdiff_t>(range.begin),
                     resource.bytes.begin() + static_cast<std::ptrdiff_t>(range.end));
  return answer;
}

/// Resources of memory: URLs, for tests: a function per URL answers the n-th transfer (from 0). Any thread.
class MemoryNetwork {
 public:
  using Answer = std::function<MemoryAnswer(const TransferRequest& request, unsigned transfer)>;

  /// Sets the function of a URL. The loader's thread calls it.
  void put(const std::string& url, Answer answer) {
    const std::lock_guard lock(mutex_);
    resources_[url] = {std::move(answer), 0};
  }
  void put(const std::string& url, MemoryResource resource) {
    put(url, [resource = std::move(resource)](const TransferRequest& request, unsigned) {
      return answer_well(resource, request);
    });
  }
  /// Returns the transfers so far, in the order of their start.
  [[nodiscard]] std::vector<TransferRequest> transfers() const {
    const std::lock_guard lock(mutex_);
    return transfers_;
  }
  [[nodiscard]] MemoryAnswer answer(const TransferRequest& request) {
    Answer answer;
    unsigned transfer = 0;
    {
      const std::lock_guard lock(mutex_);
      transfers_.push_back(request);
      const auto found = resources_.find(request.url);
      if (found == resources_.end()) {
        MemoryAnswer none;
        none.head.status = 404;
        return none;
      }
      answer = found->second.first;
      transfer = found->second.second++;
    }
    return answer(request, transfer);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::pair<Answer, unsigned>> resources_;
  std::vector<TransferRequest> transfers_;
};

/// Transport for memory: URLs. start() and step() get the time, so that tests do not wait.
class MemoryTransport final : public Transport {
 public:
  explicit MemoryTransport(std::shared_ptr<MemoryNetwork> network) : network_(std::move(network)) {}

  void start(TransferId id, const TransferRequest& request, TimePoint now) override {
    Transfer transfer;
    transfer.answer = network_->answer(request);
    transfer.next_time = now + (transfer.answer.answers ? transfer.answer.latency : transfer.answer.stall_timeout);
    transfers_.insert_or_assign(id, std::move(transfer));
  }
  void cancel(TransferId id) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.over = true;
  }
  void pause(TransferId id, bool paused) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.paused = paused;
  }
  void step(TransferSink& sink, TimePoint now) override {
    for (auto& [id, transfer] : transfers_)
      while (!transfer.over && !transfer.paused && transfer.next_time <= now) advance(id, transfer, sink, now);
    std::erase_if(transfers_, [](const auto& entry) { return entry.second.over; });
  }
  [[nodiscard]] std::optional<TimePoint> deadline(TimePoint now) const override {
    std::optional<TimePoint> first;
    for (const auto& [id, transfer] : transfers_)
      if (transfer.over)
        return now;
      else if (!transfer.paused && (!first || transfer.next_time < *first))
        first = transfer.next_time;
    return first;
  }

 private:
  struct Transfer {
    MemoryAnswer answer;
    TimePoint next_time;
    std::size_t next = 0;  // byte of the body
    bool begun = false, discarding = false, stalled = false, paused = false, over = false;
  };

  static void end(TransferId id, Transfer& transfer, TransferSink& sink, const TransferEnd& how) {
    transfer.over = true;
    sink.on_end(id, how);
  }

  static void advance(TransferId id, Transfer& transfer, TransferSink& sink, TimePoint now) {
    MemoryAnswer& answer = transfer.answer;
    if (answer.refused) return end(id, transfer, sink, {answer.refused, false});
    if (!answer.answers || transfer.stalled)
      return end(id, transfer, sink,
                 {LoadError{LoadErrorKind::timed_out, "no more bytes were received in time"}, true});
    if (!transfer.begun) {
      transfer.begun = true;
      const HeadVerdict verdict = sink.on_head(id, answer.head);
      transfer.over = verdict == HeadVerdict::stop;
      transfer.discarding = verdict == HeadVerdict::discard;
      return;
    }
    std::size_t until = std::min(answer.body.size(), transfer.next + std::max<std::size_t>(1, answer.block));
    const auto limit = [&until](std::optional<std::uint64_t> bound) {
      if (bound && *bound < until) until = static_cast<std::size_t>(*bound);
    };
    limit(answer.stall_after);
    limit(answer.break_after);
    const auto bytes = std::span(answer.body).subspan(transfer.next, until - transfer.next);
    transfer.next = until;
    if (!bytes.empty()) {
      const DataVerdict verdict = transfer.discarding ? DataVerdict::more : sink.on_data(id, bytes);
      transfer.over |= verdict == DataVerdict::stop;
      transfer.paused |= verdict == DataVerdict::pause;
      if (answer.bytes_per_second > 0)
        transfer.next_time = std::max(transfer.next_time, now - Milliseconds(1)) +
                             std::chrono::nanoseconds(bytes.size() * 1'000'000'000 / answer.bytes_per_second);
      return;
    }
    if (answer.break_after && transfer.next >= *answer.break_after)
      return end(id, transfer, sink, {LoadError{LoadErrorKind::broken, "the connection was interrupted"}, true});
    if (answer.stall_after && transfer.next >= *answer.stall_after) {
      transfer.stalled = true;
      transfer.next_time = now + answer.stall_timeout;
      return;
    }
    end(id, transfer, sink, {});
  }

  std::shared_ptr<MemoryNetwork> network_;
  std::map<TransferId, Transfer> transfers_;
};

/// Maker of transports for memory: URLs, which all share one network.
struct MakeMemoryTransport {
  std::shared_ptr<MemoryNetwork> network = std::make_shared<MemoryNetwork>();
  std::unique_ptr<Transport> operator()() const { return std::make_unique<MemoryTransport>(network); }
};

/// Returns the network that a MakeMemoryTransport in the options uses.
[[nodiscard]] inline MemoryNetwork& network_of(const std::function<std::unique_ptr<Transport>()>& memory) {
  return *memory.target<MakeMemoryTransport>()->network;
}

}  // namespace gs::net
