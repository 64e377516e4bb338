#pragma once

#include "app/insitu/arrays/ranks.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace gs::app::insitu {

/// Appends the records of all ranks to those of rank 0, in messages of about 1 MiB. `whole` is false if this rank could
/// not make its records. Removes all records and sets `fits` to false if `whole` is false on a rank, if a rank
/// lacks memory, or if all records exceed `most_bytes`. Collective. Returns false if the communication failed.
template <class Record>
[[nodiscard]] bool gather_records(Ranks& ranks, std::vector<Record>& records, std::uint64_t most_bytes, bool whole,
                                  bool& fits) {
  static_assert(std::is_trivially_copyable_v<Record>);
  constexpr std::size_t kPiece = (std::size_t{1} << 20) / sizeof(Record);
  std::vector<std::uint64_t> counts;
  const bool ready = ranks.attempt("counts", [&] {
    if (ranks.is_first()) counts.resize(static_cast<std::size_t>(ranks.count()));
  });
  if (!ranks.agree(ready && whole, fits)) return false;
  if (fits) {
    const std::uint64_t own = records.size();
    if (!ranks.gather(&own, sizeof own, counts.data())) return false;
    std::uint64_t left = most_bytes / sizeof(Record), all = 0;
    bool enough = true;
    for (const std::uint64_t count : counts) {
      if (count > left) enough = false;
      left -= std::min(count, left);
      all += enough ? count : 0;
    }
    const bool reserved = enough && ranks.attempt("records", [&] {
      if (ranks.is_first()) records.reserve(static_cast<std::size_t>(all));
    });
    if (!ranks.agree(reserved, fits)) return false;
  }
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
