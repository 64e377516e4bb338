#pragma once

#include "app/insitu/arrays/ranks.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace gs::app::insitu {

/// Appends the records of all ranks to those of rank 0, in messages of about 1 MiB. If all records together
/// exceed `most_bytes`, removes them on all ranks instead, and sets `fits` to false. Collective. Returns false if the
/// communication failed.
template <class Record>
[[nodiscard]] bool gather_records(Ranks& ranks, std::vector<Record>& records, std::uint64_t most_bytes, bool& fits) {
  static_assert(std::is_trivially_copyable_v<Record>);
  constexpr std::size_t kPiece = (std::size_t{1} << 20) / sizeof(Record);
  const std::uint64_t own = records.size();
  std::vector<std::uint64_t> counts(ranks.is_first() ? static_cast<std::size_t>(ranks.count()) : 0);
  if (!ranks.gather(&own, sizeof own, counts.data())) return false;
  std::uint64_t left = most_bytes / sizeof(Record);
  std::uint32_t enough = 1;
  for (const std::uint64_t count : counts) {
    if (count > left) enough = 0;
    left -= std::min(count, left);
  }
  if (!ranks.broadcast(enough)) return false;
  fits = enough != 0;
  if (!fits) {
    records = {};
    return true;
  }
  if (!ranks.is_first()) {
    for (std::size_t at = 0; at < records.size(); at += kPiece)
      if (!ranks.send(&records[at], std::min(kPiece, records.size() - at) * sizeof(Record))) return false;
    return true;
  }
  for (int from = 1; from < ranks.count(); ++from) {
    const std::uint64_t count = counts[static_cast<std::size_t>(from)];
    std::size_t at = records.size();
    records.resize(at + count);
    for (; at < records.size(); at += kPiece)
      if (!ranks.receive(&records[at], std::min(kPiece, records.size() - at) * sizeof(Record), from)) return false;
  }
  return true;
}

}  // namespace gs::app::insitu
