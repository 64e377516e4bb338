#pragma once

#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/encode/encode_values.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

/// Encoding of samples in memory, for tests.
namespace gs::test {

/// Clusters of a volume, and what values::encode_values() says about them.
struct EncodedSamples {
  std::vector<qnv::values::Cluster> clusters;
  std::vector<qnv::ValueError> errors;
  std::vector<std::uint32_t> corrections;  // steps per sample; empty if there are none
};

/// Returns a function that reads samples in memory.
inline qnv::values::ReadSamples reader_of(std::span<const std::int32_t> samples, qnv::values::Extent extent) {
  const std::size_t slice = std::size_t{extent[0]} * extent[1];
  return [=](std::uint32_t first, std::uint32_t count, qnv::values::SampleBatch& batch) {
    const auto part = samples.subspan(first * slice, count * slice);
    batch = {first, count, {part.begin(), part.end()}, {}, {}};
    return std::optional<qnv::EncodeError>();
  };
}

inline std::optional<EncodedSamples> encode_samples(std::span<const std::int32_t> samples, qnv::values::Extent extent,
                                                    const qnv::values::ValuesLimit& limit, unsigned threads = 0) {
  qnv::MemoryStore store;
  auto made = qnv::values::encode_values(reader_of(samples, extent), extent, limit, store, threads);
  const auto* values = std::get_if<qnv::values::EncodedValues>(&made);
  if (!values) return std::nullopt;
  EncodedSamples encoded;
  encoded.errors = values->errors;
  std::vector<std::byte> bytes;
  for (const qnv::values::StoredCluster& one : values->clusters) {
    bytes.resize(one.bytes);
    if (!store.read(one.offset, bytes)) return std::nullopt;
    encoded.clusters.push_back(*qnv::values::parse_cluster(bytes));
  }
  if (!values->corrections.empty()) encoded.corrections.resize(samples.size());
  for (const qnv::values::StoredRun& one : values->corrections) {
    bytes.resize(one.bytes);
    if (!store.read(one.offset, bytes)) return std::nullopt;
    if (!qnv::values::decode_remainders(*qnv::values::parse_run(bytes), extent, encoded.corrections))
      return std::nullopt;
  }
  return encoded;
}

}  // namespace gs::test
