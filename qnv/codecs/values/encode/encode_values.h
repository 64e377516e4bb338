#pragma once

#include "base/parallel.h"
#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/values/chunk_places.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/sample_batch.h"
#include "qnv/codecs/values/encode/step_coefficients.h"
#include "qnv/codecs/values/encode/stored_clusters.h"
#include "qnv/container/container.h"
#include "qnv/container/value_grid.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Number of bytes of a chunk with a cluster in addition to its payload.
inline constexpr std::size_t kClusterChunkCost = kChunkHeaderBytes + kMostPlaceBytes;

/// Limits at which a stream ends: an error or a size.
struct ValuesLimit {
  std::uint32_t most_error = 0;  // maximum for every sample; 0 means lossless. Without effect if `max_bytes` is given
  std::size_t max_bytes = 0;     // of all chunks with their directory entries; 0 means unlimited
  bool alone = true;             // no other components or steps; otherwise clusters must be in order of rank
};

/// Step of a time series, and the decoded steps before it.
struct EncodedStep {
  StepCoefficients& decoded;  // gets the step
  bool first = true;          // of a chain
};

/// Run of cubes, packed in a SpillStore.
struct StoredRun {
  std::uint64_t offset = 0, first = 0;  // `first` cube
  std::uint32_t count = 0, bytes = 0;   // of cubes, of the packed form
};

/// Processes that encode a volume together, and the prefix of the names of their work in the store.
struct SharedWork {
  Ranks* ranks = nullptr;  // null means this process alone
  std::string name;
};

/// Encoded volume, with its bytes in a SpillStore.
struct EncodedValues {
  std::vector<StoredCluster> clusters;  // the most useful per byte first
  std::vector<ValueError> errors;       // of samples, in steps: after some sizes, and at the end
  std::vector<StoredRun> corrections;   // of samples, in correction steps
};

/// Returns the size of a correction step for a permitted error.
[[nodiscard]] constexpr std::uint32_t correction_step(std::uint32_t most_error) { return 2 * most_error + 1; }

/// Appends a run to a store. Sets `problem` on failure.
void store_run(const CubeRun& run, SpillStore& store, std::vector<StoredRun>& runs,
               std::optional<EncodeError>& problem);

/// Replaces `runs` by the consecutive runs of all ranks. Returns the first problem of any rank. Collective.
[[nodiscard]] std::optional<EncodeError> share_runs(Ranks& ranks, SpillStore& store,
                                                    const std::optional<EncodeError>& problem,
                                                    std::vector<StoredRun>& runs);

/// Encodes a volume that is read slice by slice, several times. Memory: about 60 slices of 4 bytes per voxel, and 24
/// bytes per cluster. Returns an error if `read` or the store fails, or if cancelled. The clusters do not depend on the
/// number of threads, nor on the store. With `step`, encodes a step of a time series, and measures only the error at
/// its end. With ranks, each one encodes some rows of blocks of each level, and all return the same. Blocks.
[[nodiscard]] std::variant<EncodedValues, EncodeError> encode_values(const ReadSamples& read, Extent extent,
                                                                     const ValuesLimit& limit, SpillStore& store,
                                                                     unsigned threads = 0, Progress* progress = nullptr,
                                                                     const EncodedStep* step = nullptr,
                                                                     const SharedWork& work = {});

/// Returns the lengths, in clusters, of the prefixes to measure. The first prefix has about 4 kB. Each further prefix
/// is larger by a factor, up to an eighth of the bytes. Large volumes have fewer prefixes, because each one is decoded.
[[nodiscard]] std::vector<std::size_t> measured_prefixes(std::span<const StoredCluster> order, std::uint64_t samples);

}  // namespace gs::qnv::values
