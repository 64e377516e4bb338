#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/ranks.h"
#include "qnv/mesh/survey.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Ranks of an encoding and their common store. Without ranks, this process is the only rank.
class EncodeRanks {
 public:
  explicit EncodeRanks(const EncodeOptions& options)
      : ranks_(options.ranks ? *options.ranks : alone_), store_(options.spill ? *options.spill : memory_) {}
  EncodeRanks(const EncodeRanks&) = delete;
  EncodeRanks& operator=(const EncodeRanks&) = delete;

  [[nodiscard]] Ranks& ranks() { return ranks_; }
  [[nodiscard]] SpillStore& store() { return store_; }
  [[nodiscard]] std::uint32_t rank() const { return ranks_.rank(); }
  [[nodiscard]] std::uint32_t count() const { return ranks_.count(); }
  [[nodiscard]] std::optional<EncodeError> agree(const std::optional<EncodeError>& own) {
    return qnv::agree(ranks_, own);
  }

 private:
  Ranks alone_;
  MemoryStore memory_;
  Ranks& ranks_;
  SpillStore& store_;
};

/// Message of a source that cannot be read.
inline constexpr const char* kUnreadable = "the surface cannot be read";

/// Passes the triangles of this rank's runs to a sink. Returns the first error of all ranks: a source that cannot be
/// read, or a cancellation. A sink that returns false ends the reading of its rank without an error. Collective.
[[nodiscard]] std::optional<EncodeError> read_share(EncodeRanks& shared, const TriangleSource& source,
                                                    const TriangleSink& sink, Progress* progress);

/// Returns the statistics of all runs of a source. Each rank reads its share. The sums do not depend on the number of
/// ranks, because they are added in the order of the runs. Collective.
[[nodiscard]] std::variant<SurfaceSurvey, EncodeError> survey_of(EncodeRanks& shared, const TriangleSource& source,
                                                                 Progress* progress);

/// Returns `own` on rank 0. Other ranks return the error of rank 0, or an empty stream. Collective.
[[nodiscard]] std::variant<EncodedStream, EncodeError> result_of_first(EncodeRanks& shared,
                                                                       std::variant<EncodedStream, EncodeError> own);

/// Returns a result that an earlier run recorded with record_result(). Returns nullopt if a rank cannot read it. Equal
/// on all ranks. Collective.
[[nodiscard]] std::optional<std::vector<std::byte>> earlier_result(EncodeRanks& shared, std::string_view work);
/// Records a result that all ranks have, for later runs. Omits results above 512 MB. Returns an error if rank 0 cannot
/// store it. Equal on all ranks. Collective.
[[nodiscard]] std::optional<EncodeError> record_result(EncodeRanks& shared, std::string_view work,
                                                       std::span<const std::byte> result);

/// Function that returns memory for a number of bytes.
using RoomFor = std::function<std::span<std::byte>(std::uint64_t bytes)>;

/// Passes bytes between ranks through their store. `own` has one part for each rank; `ends` has the ends of the
/// parts. Fills `room` with the parts that all ranks have for this rank, in the order of the ranks. Collective.
[[nodiscard]] std::optional<EncodeError> pass_parts(EncodeRanks& shared, std::span<const std::byte> own,
                                                    std::span<const std::uint64_t> ends, const RoomFor& room);
/// Fills `room` with the bytes of all ranks, in the order of the ranks. Unless `all` is true, only rank 0 does so.
/// Collective.
[[nodiscard]] std::optional<EncodeError> collect_bytes(EncodeRanks& shared, std::span<const std::byte> own, bool all,
                                                       const RoomFor& room);

/// Sorts records by key, and merges records with equal keys by Record::add().
template <class Record>
void sort_and_add(std::vector<Record>& records) {
  std::sort(records.begin(), records.end(), [](const Record& a, const Record& b) { return a.key < b.key; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < records.size(); ++i)
    if (kept > 0 && records[kept - 1].key == records[i].key)
      records[kept - 1].add(records[i]);
    else
      records[kept++] = records[i];
  records.resize(kept);
}

/// Returns the records of all ranks in the order of their keys. Merges records with equal keys by Record::add(), in any
/// order. Record::hash() selects the rank that merges the records of a key. Unless `all` is true, only rank 0 gets the
/// records. Collective.
template <class Record>
[[nodiscard]] std::variant<std::vector<Record>, EncodeError> merged_records(EncodeRanks& shared,
                                                                            std::vector<Record> own, bool all) {
  static_assert(std::is_trivially_copyable_v<Record>);
  sort_and_add(own);
  const std::size_t count = shared.count();
  if (count == 1) return own;
  const auto room_in = [](std::vector<Record>& records) {
    return [&records](std::uint64_t bytes) {
      records.resize(static_cast<std::size_t>(bytes / sizeof(Record)));
      return std::as_writable_bytes(std::span(records));
    };
  };
  const auto rank_of = [count](const Record& record) { return record.hash() % count; };
  std::sort(own.begin(), own.end(), [&](const Record& a, const Record& b) {
    const auto first = rank_of(a), second = rank_of(b);
    return first != second ? first < second : a.key < b.key;
  });
  std::vector<std::uint64_t> ends(count, 0);
  for (const Record& record : own) ends[rank_of(record)] += sizeof(Record);
  for (std::size_t i = 1; i < count; ++i) ends[i] += ends[i - 1];
  std::vector<Record> here;
  auto problem = pass_parts(shared, std::as_bytes(std::span(own)), ends, room_in(here));
  if (problem) return std::move(*problem);
  own = {};
  sort_and_add(here);
  problem = collect_bytes(shared, std::as_bytes(std::span(here)), all, room_in(own));
  if (problem) return std::move(*problem);
  sort_and_add(own);
  return own;
}

}  // namespace gs::qnv
