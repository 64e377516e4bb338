#pragma once

#include "app/base/world_budget.h"
#include "vrml/scene/array.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// True for the first bytes of a gzip member (RFC 1952).
[[nodiscard]] bool is_gzip(std::span<const std::byte> bytes);

/// Unpacks gzip members as they come, in pieces of any size. Safe for untrusted input; memory is constant. One thread.
class Gunzip {
 public:
  /// Takes what has been unpacked; false ends it all.
  using Sink = std::function<bool(std::string_view)>;

  /// All that is unpacked is drawn from `budget`, also where it is not kept. A member that unpacks to far more than its
  /// size is stopped (Limits::unpack_ratio), and so is all when the budget says that it is time.
  explicit Gunzip(WorldBudget budget);
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
[[nodiscard]] std::optional<std::string> gunzip(std::span<const std::byte> bytes, const WorldBudget& budget,
                                                const Gunzip::Sink& sink);

/// Unpacked bytes, and the part of a budget that they take.
struct UnpackedBytes {
  vrml::Array<std::byte> bytes;
  vrml::Share share;
  std::optional<std::string> problem;  // why there are no more
};
/// Unpacks gzip members to the end, or as far as the budget for `resource` allows.
[[nodiscard]] UnpackedBytes unpack_gzip(std::span<const std::byte> bytes, const WorldBudget& budget,
                                        vrml::Resource resource);

/// One gzip member.
[[nodiscard]] std::vector<std::byte> gzip(std::span<const std::byte> bytes);

}  // namespace gs::app
