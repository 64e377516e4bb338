#pragma once

#include "base/parallel.h"
#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/codecs/values/encode/sample_batch.h"
#include "qnv/codecs/values/encode/stored_clusters.h"
#include "qnv/container/value_grid.h"

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace gs::qnv::values {

/// Limits at which a stream ends: an error or a size.
struct ValuesLimit {
  std::uint32_t most_error = 0;  // maximum for every sample; 0 means lossless. Without effect if `max_bytes` is given
  std::size_t max_bytes = 0;     // of all chunks with their directory entries; 0 means unlimited
};

/// Run of cubes, packed in a SpillStore.
struct StoredRun {
  std::uint64_t offset = 0, first = 0;  // `first` cube
  std::uint32_t count = 0, bytes = 0;   // of cubes, of the packed form
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

/// Encodes a volume that is read slice by slice, several times. Memory: about 60 slices of 4 bytes per voxel, and 24
/// bytes per cluster. Returns an error if `read` or the store fails, or if cancelled. The clusters do not depend on the
/// number of threads, nor on the store. Blocks.
[[nodiscard]] std::variant<EncodedValues, EncodeError> encode_values(const ReadSamples& read, Extent extent,
                                                                     const ValuesLimit& limit, SpillStore& store,
                                                                     unsigned threads = 0,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv::values
