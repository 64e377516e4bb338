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

/// How one transfer of the memory: scheme goes: a server and a line to it in one.
struct MemoryAnswer {
  ResponseHead head;
  std::vector<std::byte> body;
  Milliseconds latency{0};                   // before the head
  std::uint64_t bytes_per_second = 0;        // of the body; 0: all at once
  std::size_t block = 16384;                 // bytes handed over at a time
  std::optional<std::uint64_t> stall_after;  // silence behind so many bytes of the body, until the time-out
  std::optional<std::uint64_t> break_after;  // the connection breaks behind so many bytes
  bool answers = true;                       // false: silence from the start
  std::optional<LoadError> refused;          // no connection at all
  Milliseconds stall_timeout{20'000};        // after so much silence the transfer fails
};

/// A resource that is served as a well-behaved server would: ranges, If-Range, 304, 416.
struct MemoryResource {
  std::vector<std::byte> bytes;
  std::string content_type;
  Validator validator;
  CacheControl cache_control;
  bool ranges = true;
};
[[nodiscard]] MemoryAnswer answer_well(const MemoryResource& resource, const TransferRequest& request);

/// What memory: URLs name, for tests: each URL has a function that answers the n-th transfer (from 0). Any thread.
class MemoryNetwork {
 public:
  using Answer = std::function<MemoryAnswer(const TransferRequest& request, unsigned transfer)>;

  /// The function is called from the loader's thread.
  void put(const std::string& url, Answer answer);
  void put(const std::string& url, MemoryResource resource);
  /// Transfers so far, in the order in which they began.
  [[nodiscard]] std::vector<TransferRequest> transfers() const;
  [[nodiscard]] MemoryAnswer answer(const TransferRequest& request);

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::pair<Answer, unsigned>> resources_;
  std::vector<TransferRequest> transfers_;
};

/// Time is what start() and step() are told, so that tests need not wait.
[[nodiscard]] std::unique_ptr<Transport> make_memory_transport(std::shared_ptr<MemoryNetwork> network);

}  // namespace gs::net
