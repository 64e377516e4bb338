#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Of one file: a hostile one can promise a thousand times its size.
inline constexpr std::size_t kMaxUnpacked = std::size_t{4} << 30;

/// True for the first bytes of a gzip member (RFC 1952).
[[nodiscard]] bool is_gzip(std::span<const std::byte> bytes);

/// Unpacks gzip members as they come, in pieces of any size. Safe for untrusted input; memory is constant. One thread.
class Gunzip {
 public:
  /// Takes what has been unpacked; false ends it all.
  using Sink = std::function<bool(std::string_view)>;

  /// `limit`: no more bytes than this are unpacked.
  explicit Gunzip(std::size_t limit);
  ~Gunzip();
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;

  /// The next packed bytes. False when no more are of use: damage (see `finish`), the end, or the sink's wish.
  bool push(std::span<const std::byte> bytes, const Sink& sink);
  /// There are no more: what is wrong with the data (truncated, bad checksum, larger than the limit), if anything.
  [[nodiscard]] std::optional<std::string> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Likewise, with all packed bytes at hand. All that could be unpacked has been delivered when an error comes back.
[[nodiscard]] std::optional<std::string> gunzip(std::span<const std::byte> bytes, std::size_t limit,
                                                const Gunzip::Sink& sink);

/// One gzip member.
[[nodiscard]] std::vector<std::byte> gzip(std::span<const std::byte> bytes);

}  // namespace gs::app
