#pragma once

#include "qnv/records/record.h"

#include <array>
#include <cstddef>
#include <cstdint>

/// The code paths behind unpack_records; for it, its tests and its benchmark. All give the same bits.
namespace gs::qnv::record_paths {

/// Where the vectors go.
struct Outputs {
  glm::vec3* positions;
  glm::vec3* normals;
  float* weights;
  std::uint8_t* colors;
};

/// A normal, and its z once more, as the AVX2 path likes it.
struct alignas(16) PaddedNormal {
  float x = 0, y = 0, z = 0, z_again = 0;
};
extern const std::array<PaddedNormal, kNormalCodes> kNormals;

/// How the results are stored: through the caches, for those that use them at once, or past them, which saves
/// the memory from being read before it is written.
enum class Store : std::uint8_t { cached, streamed };

/// For every processor.
void unpack_portable(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out);

/// Eight records at a time. Call only where has_avx2().
[[nodiscard]] bool has_avx2();
void unpack_avx2(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out,
                 Store store);

/// Sixteen records at a time. Call only where has_avx512().
[[nodiscard]] bool has_avx512();
void unpack_avx512(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out,
                   Store store);

}  // namespace gs::qnv::record_paths
