#pragma once

#include "qnv/codecs/records/record.h"

#include <array>
#include <cstddef>
#include <cstdint>

/// Code paths of unpack_records(), public only for its tests and its benchmark. All give the same bits.
namespace gs::qnv::record_paths {

/// Output arrays of unpack_records().
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

/// Unpacks records on any processor.
void unpack_portable(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out);

/// Reports whether the processor has AVX2. unpack_avx2() requires AVX2, and unpacks eight records at a time.
[[nodiscard]] bool has_avx2();
void unpack_avx2(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out);

}  // namespace gs::qnv::record_paths
