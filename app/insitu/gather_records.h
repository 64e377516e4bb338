#pragma once

#include "app/insitu/ranks.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace gs::app::insitu {

/// Appends the records of all ranks to those of rank 0, in messages of about 1 MiB. Collective. Returns false if the
/// communication failed.
template <class Record>
[[nodiscard]] bool gather_records(Ranks& ranks, std::vector<Record>& records) {
  static_assert(std::is_trivially_copyable_v<Record>);
  constexpr std::size_t kPiece = (std::size_t{1} << 20) / sizeof(Record);
  if (!ranks.is_first()) {
    const std::uint64_t count = records.size();
    if (!ranks.send(&count, sizeof count)) return false;
    for (std::size_t at = 0; at < records.size(); at += kPiece)
      if (!ranks.send(&records[at], std::min(kPiece, records.size() - at) * sizeof(Record))) return false;
    return true;
  }
  for (int from = 1; from < ranks.count(); ++from) {
    std::uint64_t count = 0;
    if (!ranks.receive(&count, sizeof count, from)) return false;
    std::size_t at = records.size();
    records.resize(at + count);
    for (; at < records.size(); at += kPiece)
      if (!ranks.receive(&records[at], std::min(kPiece, records.size() - at) * sizeof(Record), from)) return false;
  }
  return true;
}

}  // namespace gs::app::insitu
