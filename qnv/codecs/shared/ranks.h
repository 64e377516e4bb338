#pragma once

#include "qnv/codecs/shared/encode_options.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace gs::qnv {

/// Interface of a process to the ranks, which encode one stream together. All ranks call the same functions in the same
/// order. This class has a single rank.
class Ranks {
 public:
  virtual ~Ranks() = default;

  [[nodiscard]] virtual std::uint32_t rank() const { return 0; }
  [[nodiscard]] virtual std::uint32_t count() const { return 1; }
  /// Returns the bytes of all ranks, in the order of the ranks. Waits for all ranks.
  [[nodiscard]] virtual std::vector<std::byte> gather(std::span<const std::byte> own) {
    return {own.begin(), own.end()};
  }
};

/// Range of the items that one rank works on.
struct RankShare {
  std::uint64_t first = 0, end = 0;
  [[nodiscard]] std::uint64_t size() const { return end - first; }
};

/// Divides `items` into consecutive parts of about equal size, one for each rank.
[[nodiscard]] inline RankShare share_of(const Ranks& ranks, std::uint64_t items) {
  const std::uint64_t rank = ranks.rank(), count = ranks.count();
  return {items * rank / count, items * (rank + 1) / count};
}

/// Returns the records of all ranks, in the order of the ranks.
template <class Record>
[[nodiscard]] std::vector<Record> gather_records(Ranks& ranks, std::span<const Record> own) {
  static_assert(std::is_trivially_copyable_v<Record>);
  if (ranks.count() == 1) return {own.begin(), own.end()};
  const std::vector<std::byte> bytes = ranks.gather(std::as_bytes(own));
  std::vector<Record> all(bytes.size() / sizeof(Record));
  if (!all.empty()) std::memcpy(static_cast<void*>(all.data()), bytes.data(), all.size() * sizeof(Record));
  return all;
}

/// Returns the error of the first rank with an error; nullopt if no rank has one. Equal on all ranks.
[[nodiscard]] std::optional<EncodeError> agree(Ranks& ranks, const std::optional<EncodeError>& own);

}  // namespace gs::qnv
