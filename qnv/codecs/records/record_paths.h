#pragma once

#include "qnv/codecs/records/record.h"

#include <array>
#include <cstddef>
#include <cstdint>

/// Code paths of unpack_records(), exposed for its tests and benchmark. All give the same bits.
namespace gs::qnv::record_paths {

/// Output arrays.
struct Outputs {
  glm::vec3* positions;
  glm::vec3* normals;
  float* weights;
  std::uint8_t* colors;
};

/// Normal with z repeated, as the AVX2 path needs it.
struct alignas(16) PaddedNormal {
  float x = 0, y = 0, z = 0, z_again = 0;
};
extern const std::array<PaddedNormal, kNormalCodes> kNormals;

/// Unpacks on any processor.
void unpack_portable(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out);

/// Unpacks eight records at a time. Call only if has_avx2().
[[nodiscard]] bool has_avx2();
void unpack_avx2(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out);

}  // namespace gs::qnv::record_paths
