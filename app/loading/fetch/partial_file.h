#pragma once

#include "app/base/need_bytes.h"
#include "app/base/temporary_file.h"
#include "app/loading/fetch/read_resources.h"
#include "base/noncopyable.h"
#include "net/base/descriptor.h"
#include "net/base/range_set.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Version of a file on a server, and its size.
struct FilePlace {
  net::Url url;
  net::Origin from;
  net::Validator validator;
  std::uint64_t total = 0;
  net::CacheUse cache = net::Request{}.cache;
};
/// Offer to read a file by parts.
struct PartsOffer {
  FilePlace place;
  std::shared_ptr<ServedFiles> served;
  std::shared_ptr<std::atomic<std::uint64_t>> received{};  // counts the bytes of received parts; may be null
};

/// File on a server, received only in the needed parts. A sparse temporary file of the same size holds them. Single
/// small reads receive blocks, which grow while reads are consecutive. Any thread.
class PartialFile : NonCopyable {
 public:
  static constexpr std::uint64_t kLeastBlock = std::uint64_t{1} << 16, kMostBlock = std::uint64_t{4} << 20;
  /// Smaller files are received as a whole.
  static constexpr std::uint64_t kLeastFile = std::uint64_t{2} << 20;

  /// Creates the temporary file with the first bytes. `name` is the name of the file on the server.
  PartialFile(const std::string& name, PartsOffer offer, std::span<const std::byte> front);

  /// Returns the reason why the temporary file cannot be created; empty on success.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Returns the path of the temporary file.
  [[nodiscard]] const std::string& path() const { return file_.path(); }
  /// Receives the missing bytes of parts. Blocks. Returns false if a part cannot be received, or is outside of the
  /// file. After a change on the server or a failure of the disk, receives nothing more.
  [[nodiscard]] bool need(std::span<const ByteSpan> parts);
  /// Returns the first problem, with the URL; empty if there is none.
  [[nodiscard]] std::string trouble() const;
  /// Returns the number of bytes received so far.
  [[nodiscard]] std::uint64_t received() const;

 private:
  [[nodiscard]] net::ByteRange block_of(const ByteSpan& part);
  [[nodiscard]] bool write(std::uint64_t offset, std::span<const std::byte> bytes);
  void fail(std::string problem, bool for_good);
  /// Estimates latency and rate from a request for `ranges` ranges that received `bytes` bytes.
  void measure(std::size_t ranges, std::uint64_t bytes, std::chrono::steady_clock::duration time);

  const FilePlace place_;
  const std::shared_ptr<ServedFiles> served_;
  const std::shared_ptr<std::atomic<std::uint64_t>> counter_;
  const TemporaryFile file_;
  std::string problem_;
  mutable std::mutex mutex_;  // guards the rest
  net::Descriptor descriptor_;
  net::RangeSet there_;
  std::uint64_t next_ = 0;  // end of the last single read
  std::uint64_t ahead_ = kLeastBlock;
  std::uint64_t received_ = 0;
  double seconds_ = 0, bytes_per_second_ = 0;  // latency of a request; best rate so far
  std::uint64_t gap_ = 8192;                   // receiving a shorter gap is faster than another request
  std::string trouble_;
  bool failed_ = false;
};

}  // namespace gs::app
