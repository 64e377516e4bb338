#pragma once

#include "base/array.h"
#include "base/budget.h"
#include "base/noncopyable.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs {

/// Returns true for the first bytes of a gzip member (RFC 1952).
[[nodiscard]] bool is_gzip(std::span<const std::byte> bytes);

/// Incremental decompressor of gzip members, for pieces of any size. Safe for untrusted input; constant memory. One
/// thread.
class Gunzip : NonCopyable {
 public:
  /// Receiver of the decompressed bytes; returns false to stop.
  using Sink = std::function<bool(std::string_view)>;

  /// Creates a decompressor. All decompressed bytes count against `budget`, even discarded ones. Stops at members that
  /// expand too much (Limits::unpack_ratio), and when `budget` reports a stop.
  explicit Gunzip(WorldBudget budget);
  ~Gunzip();

  /// Decompresses the next bytes. Returns false if it needs no more input: after an error (see `finish`), at the end,
  /// or if the sink returned false.
  bool push(std::span<const std::byte> bytes, const Sink& sink);
  /// Ends the input. Returns the error of the data (truncated, bad checksum, larger than the limit), or nullopt.
  [[nodiscard]] std::optional<std::string> finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Decompresses complete data. Returns the error, or nullopt. Passes all output before the error to `sink`.
[[nodiscard]] std::optional<std::string> gunzip(std::span<const std::byte> bytes, const WorldBudget& budget,
                                                const Gunzip::Sink& sink);

/// Decompressed bytes with their share of a budget.
struct UnpackedBytes {
  Array<std::byte> bytes;
  Share share;
  std::optional<std::string> problem;  // error after which the rest is missing; nullopt if complete
};
/// Decompresses gzip members up to the end, or up to the limit of `budget` for `resource`.
[[nodiscard]] UnpackedBytes unpack_gzip(std::span<const std::byte> bytes, const WorldBudget& budget, Resource resource);

/// Compresses bytes to one gzip member.
[[nodiscard]] std::vector<std::byte> gzip(std::span<const std::byte> bytes);

}  // namespace gs
