#include "qnv/codecs/records/record_paths.h"

#if defined(__x86_64__)

#include <immintrin.h>

#include <cstring>

// Enables the instructions per function, so that the program runs on every x86-64. Excludes FMA, so that the compiler
// does not fuse operations that are separate in other paths.
#define QNV_AVX2 __attribute__((target("avx2")))
#define QNV_AVX2_INLINE __attribute__((target("avx2"), always_inline)) inline

namespace gs::qnv::record_paths {
namespace {

constexpr std::size_t kLanes = 8;

// One axis of a RecordFrame, copied to eight lanes.
struct Axis {
  __m256 lower, half_cell;
};
struct WideFrame {
  Axis x, y, z;
  __m256 weight_step;
};
QNV_AVX2_INLINE WideFrame widen(const RecordFrame& f) {
  return {{_mm256_set1_ps(f.lower.x), _mm256_set1_ps(f.cell.x * 0.5f)},
          {_mm256_set1_ps(f.lower.y), _mm256_set1_ps(f.cell.y * 0.5f)},
          {_mm256_set1_ps(f.lower.z), _mm256_set1_ps(f.cell.z * 0.5f)},
          _mm256_set1_ps(f.weight_step)};
}

// Stores consecutive vectors.
struct Sink {
  float* p;
  QNV_AVX2_INLINE void put(__m256 v) {
    _mm256_storeu_ps(p, v);
    p += kLanes;
  }
};

QNV_AVX2_INLINE __m256 coordinates(__m256i codes, const Axis& axis) {
  const __m256i odd =
      _mm256_or_si256(_mm256_slli_epi32(_mm256_and_si256(codes, _mm256_set1_epi32(1023)), 1), _mm256_set1_epi32(1));
  return _mm256_add_ps(axis.lower, _mm256_mul_ps(_mm256_cvtepi32_ps(odd), axis.half_cell));
}

// Reorders x0..x7, y0..y7, z0..z7 to x0 y0 z0 x1 ...
QNV_AVX2_INLINE void put_interleaved(Sink& sink, __m256 x, __m256 y, __m256 z) {
  const __m256 xy = _mm256_shuffle_ps(x, y, _MM_SHUFFLE(2, 0, 2, 0));   // x0 x2 y0 y2
  const __m256 yz = _mm256_shuffle_ps(y, z, _MM_SHUFFLE(3, 1, 3, 1));   // y1 y3 z1 z3
  const __m256 zx = _mm256_shuffle_ps(z, x, _MM_SHUFFLE(3, 1, 2, 0));   // z0 z2 x1 x3
  const __m256 a = _mm256_shuffle_ps(xy, zx, _MM_SHUFFLE(2, 0, 2, 0));  // x0 y0 z0 x1
  const __m256 b = _mm256_shuffle_ps(yz, xy, _MM_SHUFFLE(3, 1, 2, 0));  // y1 z1 x2 y2
  const __m256 c = _mm256_shuffle_ps(zx, yz, _MM_SHUFFLE(3, 1, 3, 1));  // z2 x3 y3 z3
  sink.put(_mm256_permute2f128_ps(a, b, 0x20));
  sink.put(_mm256_permute2f128_ps(c, a, 0x30));
  sink.put(_mm256_permute2f128_ps(b, c, 0x31));
}

// Returns the normals of two codes. The fourth lane of each normal repeats z.
QNV_AVX2_INLINE __m256 normals_of(std::uint64_t low, std::uint64_t high) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(&kNormals[low & 0xffff].x)),
                              _mm_load_ps(&kNormals[high & 0xffff].x), 1);
}

QNV_AVX2_INLINE void put_normals(Sink& sink, __m256i codes) {
  const __m128i codes16 = _mm_packus_epi32(_mm256_castsi256_si128(codes), _mm256_extracti128_si256(codes, 1));
  const auto low = static_cast<std::uint64_t>(_mm_cvtsi128_si64(codes16));
  const auto high = static_cast<std::uint64_t>(_mm_extract_epi64(codes16, 1));
  const __m256 n0 = normals_of(low, high), n1 = normals_of(low >> 16, high >> 16);
  const __m256 n2 = normals_of(low >> 32, high >> 32), n3 = normals_of(low >> 48, high >> 48);
  const __m256 xs = _mm256_shuffle_ps(n0, n1, _MM_SHUFFLE(0, 0, 2, 2));  // z0 z0 x1 x1
  const __m256 a = _mm256_shuffle_ps(n0, xs, _MM_SHUFFLE(2, 0, 1, 0));   // x0 y0 z0 x1
  const __m256 b = _mm256_shuffle_ps(n1, n2, _MM_SHUFFLE(1, 0, 2, 1));   // y1 z1 x2 y2
  const __m256 c =
      _mm256_castsi256_ps(_mm256_alignr_epi8(_mm256_castps_si256(n3), _mm256_castps_si256(n2), 12));  // z2 x3 y3 z3
  sink.put(_mm256_permute2f128_ps(a, b, 0x20));
  sink.put(_mm256_permute2f128_ps(c, a, 0x30));
  sink.put(_mm256_permute2f128_ps(b, c, 0x31));
}

QNV_AVX2_INLINE void unpack_eight(const std::byte* records, const WideFrame& frame, Sink& positions, Sink& normals,
                                  Sink& weights, std::uint8_t* colors) {
  const auto* p = reinterpret_cast<const __m256i*>(records);
  const __m256 first = _mm256_castsi256_ps(_mm256_loadu_si256(p));
  const __m256 second = _mm256_castsi256_ps(_mm256_loadu_si256(p + 1));
  const __m256 low_halves = _mm256_shuffle_ps(first, second, _MM_SHUFFLE(2, 0, 2, 0));
  const __m256 high_halves = _mm256_shuffle_ps(first, second, _MM_SHUFFLE(3, 1, 3, 1));
  const __m256i low = _mm256_permute4x64_epi64(_mm256_castps_si256(low_halves), _MM_SHUFFLE(3, 1, 2, 0));
  const __m256i high = _mm256_permute4x64_epi64(_mm256_castps_si256(high_halves), _MM_SHUFFLE(3, 1, 2, 0));
  put_interleaved(positions, coordinates(low, frame.x), coordinates(_mm256_srli_epi32(low, 10), frame.y),
                  coordinates(_mm256_srli_epi32(low, 20), frame.z));
  put_normals(normals, _mm256_or_si256(_mm256_srli_epi32(low, 30),
                                       _mm256_slli_epi32(_mm256_and_si256(high, _mm256_set1_epi32(0x1ff)), 2)));
  const __m256i areas =
      _mm256_max_epi32(_mm256_and_si256(_mm256_srli_epi32(high, 9), _mm256_set1_epi32(0x7fff)), _mm256_set1_epi32(1));
  weights.put(_mm256_mul_ps(_mm256_cvtepi32_ps(areas), frame.weight_step));
  const __m256i color = _mm256_srli_epi32(high, 24);
  const __m128i color16 = _mm_packus_epi32(_mm256_castsi256_si128(color), _mm256_extracti128_si256(color, 1));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(colors), _mm_packus_epi16(color16, color16));
}

}  // namespace

bool has_avx2() { return __builtin_cpu_supports("avx2"); }

QNV_AVX2 void unpack_avx2(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out) {
  const WideFrame wide = widen(frame);
  const std::size_t whole = count / kLanes * kLanes, rest = count - whole;
  Sink positions{&out.positions->x}, normals{&out.normals->x}, weights{out.weights};
#pragma GCC unroll 2
  for (std::size_t i = 0; i < whole; i += kLanes)
    unpack_eight(records + kRecordBytes * i, wide, positions, normals, weights, out.colors + i);
  if (rest == 0) return;
  std::byte padded[kLanes * kRecordBytes] = {};
  std::memcpy(padded, records + kRecordBytes * whole, rest * kRecordBytes);
  float last_positions[3 * kLanes], last_normals[3 * kLanes], last_weights[kLanes];
  std::uint8_t last_colors[kLanes];
  Sink last[] = {{last_positions}, {last_normals}, {last_weights}};
  unpack_eight(padded, wide, last[0], last[1], last[2], last_colors);
  std::memcpy(out.positions + whole, last_positions, rest * sizeof(glm::vec3));
  std::memcpy(out.normals + whole, last_normals, rest * sizeof(glm::vec3));
  std::memcpy(out.weights + whole, last_weights, rest * sizeof(float));
  std::memcpy(out.colors + whole, last_colors, rest);
}

}  // namespace gs::qnv::record_paths

#else

namespace gs::qnv::record_paths {

bool has_avx2() { return false; }
void unpack_avx2(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out) {
  unpack_portable(records, count, frame, out);
}

}  // namespace gs::qnv::record_paths

#endif
