#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "net/load/transport.h"

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
[[nodiscard]] MemoryAnswer answer_well(const MemoryResource& resource, const TransferRequest& request);

/// Resources of memory: URLs, for tests: a function per URL answers the n-th transfer (from 0). Any thread.
class MemoryNetwork {
 public:
  using Answer = std::function<MemoryAnswer(const TransferRequest& request, unsigned transfer)>;

  /// Sets the function of a URL. The loader's thread calls it.
  void put(const std::string& url, Answer answer);
  void put(const std::string& url, MemoryResource resource);
  /// Returns the transfers so far, in the order of their start.
  [[nodiscard]] std::vector<TransferRequest> transfers() const;
  [[nodiscard]] MemoryAnswer answer(const TransferRequest& request);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::pair<Answer, unsigned>> resources_;
  std::vector<TransferRequest> transfers_;
};

/// Makes a transport for memory: URLs. start() and step() get the time, so that tests do not wait.
[[nodiscard]] std::unique_ptr<Transport> make_memory_transport(std::shared_ptr<MemoryNetwork> network);

}  // namespace gs::net
