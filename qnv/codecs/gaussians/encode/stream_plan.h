#pragma once

#include "qnv/codecs/gaussians/encode/chunk_store.h"
#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/gaussian_source.h"

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

namespace gs::qnv::gaussians {

/// Header of a stream and the numbers that all its trees share.
struct StreamPlan {
  StreamHeader header;
  Precision precision;
  float detail = 0;  // as MergeTree::detail()
};
/// Makes the plan of a stream. `sample` has all splats or a representative part of them. `box` bounds the positions of
/// all splats.
[[nodiscard]] StreamPlan plan_of(const GaussianSource& source, const Gaussians& sample, const Box& box,
                                 const EncodeOptions& options);

/// Returns an error if splats cannot be encoded. `first` is the number of the first one.
[[nodiscard]] std::optional<EncodeError> problem_of(const Gaussians& splats, std::size_t first = 0);

/// Encodes the clusters of a tree and their harmonics (encode_clusters). Returns false if it is cancelled or the store
/// is full.
bool encode_chunks(ClusterWork& work, std::vector<OpenRange> ranges, const MeanHarmonics& harmonics,
                   const EncodeOptions& options, ChunkRecords& records, std::vector<OpenCluster>* given,
                   Progress* progress);

/// Writes the chunks to the sink of the options, or to memory.
[[nodiscard]] std::variant<EncodedStream, EncodeError> write_chunks(StreamHeader header,
                                                                    std::vector<ChunkRecord> records,
                                                                    const SharedStore& store,
                                                                    const EncodeOptions& options);

}  // namespace gs::qnv::gaussians
