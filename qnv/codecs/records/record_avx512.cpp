#include "qnv/codecs/records/record_paths.h"

#if defined(__x86_64__)

#include "qnv/codecs/records/record_tail.h"

#include <immintrin.h>

// GCC 12 wrongly warns about undefined registers in its own intrinsics (GCC bug 105593).
#if !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif

#define QNV_AVX512 __attribute__((target("avx512f,avx512bw,avx512vl,avx512dq")))
#define QNV_AVX512_INLINE __attribute__((target("avx512f,avx512bw,avx512vl,avx512dq"), always_inline)) inline

namespace gs::qnv::record_paths {
namespace {

constexpr std::size_t kLanes = 16;

// One axis of the frame, broadcast to sixteen lanes.
struct Axis {
  __m512 lower, half_cell;
};
struct WideFrame {
  Axis x, y, z;
  __m512 weight_step;
};
QNV_AVX512_INLINE WideFrame widen(const RecordFrame& f) {
  return {{_mm512_set1_ps(f.lower.x), _mm512_set1_ps(f.cell.x * 0.5f)},
          {_mm512_set1_ps(f.lower.y), _mm512_set1_ps(f.cell.y * 0.5f)},
          {_mm512_set1_ps(f.lower.z), _mm512_set1_ps(f.cell.z * 0.5f)},
          _mm512_set1_ps(f.weight_step)};
}

// Stores consecutive vectors through the caches.
struct CachedSink {
  float* p;
  QNV_AVX512_INLINE void put(__m512 v) {
    _mm512_storeu_ps(p, v);
    p += kLanes;
  }
};

// Stores consecutive vectors past the caches, as in record_avx2.cpp.
struct StreamedSink {
  QNV_AVX512_INLINE explicit StreamedSink(float* target) {
    const auto off = static_cast<unsigned>(reinterpret_cast<std::uintptr_t>(target) / sizeof(float) % kLanes);
    const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    p = target - off;
    turn = _mm512_sub_epi32(lanes, _mm512_set1_epi32(static_cast<int>(off)));  // only the low four bits are used
    before = static_cast<__mmask16>((1u << off) - 1);
    rest = _mm512_load_ps(p);
  }
  QNV_AVX512_INLINE void put(__m512 v) {
    const __m512 turned = _mm512_permutexvar_ps(turn, v);
    _mm512_stream_ps(p, _mm512_mask_blend_ps(before, turned, rest));
    rest = turned;
    p += kLanes;
  }
  float* p;
  __m512i turn;
  __mmask16 before;
  __m512 rest;
};

// The product is exact (RecordFrame), so fusing it with the sum changes nothing.
QNV_AVX512_INLINE __m512 coordinates(__m512i codes, const Axis& axis) {
  const __m512i odd =
      _mm512_or_si512(_mm512_slli_epi32(_mm512_and_si512(codes, _mm512_set1_epi32(1023)), 1), _mm512_set1_epi32(1));
  return _mm512_add_ps(axis.lower, _mm512_mul_ps(_mm512_cvtepi32_ps(odd), axis.half_cell));
}

// Sources of the 48 interleaved numbers x0 y0 z0 x1 ...: an index into x0..x15 y0..y15, then a mask and an index for
// the z values.
struct Interleaving {
  alignas(64) std::int32_t from_xy[3][16];
  alignas(64) std::int32_t from_z[16 * 3];
  std::uint16_t is_z[3];
};
constexpr Interleaving kInterleaving = [] {
  Interleaving table{};
  for (int i = 0; i < 48; ++i) {
    const int part = i / 16, lane = i % 16, axis = i % 3, vector = i / 3;
    table.from_xy[part][lane] = axis == 1 ? 16 + vector : vector;
    table.from_z[i] = vector;
    if (axis == 2) table.is_z[part] = static_cast<std::uint16_t>(table.is_z[part] | 1u << lane);
  }
  return table;
}();

template <class Sink>
QNV_AVX512_INLINE void put_interleaved(Sink& sink, __m512 x, __m512 y, __m512 z) {
  for (int part = 0; part < 3; ++part) {
    const __m512 xy = _mm512_permutex2var_ps(x, _mm512_load_si512(kInterleaving.from_xy[part]), y);
    sink.put(_mm512_mask_permutexvar_ps(xy, kInterleaving.is_z[part],
                                        _mm512_load_si512(kInterleaving.from_z + 16 * part), z));
  }
}

// Returns the normals of four 16-bit codes; the fourth lane of each is unused.
QNV_AVX512_INLINE __m512 normals_of(std::uint64_t codes) {
  const __m512 first = _mm512_castps128_ps512(_mm_load_ps(&kNormals[codes & 0xffff].x));
  const __m512 second = _mm512_mask_broadcast_f32x4(first, 0x00f0, _mm_load_ps(&kNormals[codes >> 16 & 0xffff].x));
  const __m512 third = _mm512_mask_broadcast_f32x4(second, 0x0f00, _mm_load_ps(&kNormals[codes >> 32 & 0xffff].x));
  return _mm512_mask_broadcast_f32x4(third, 0xf000, _mm_load_ps(&kNormals[codes >> 48].x));
}

template <class Sink>
QNV_AVX512_INLINE void put_normals(Sink& sink, __m512i codes) {
  const __m256i codes16 = _mm512_cvtepi32_epi16(codes);
  const __m128i low = _mm256_castsi256_si128(codes16), high = _mm256_extracti128_si256(codes16, 1);
  const __m512 a = normals_of(static_cast<std::uint64_t>(_mm_cvtsi128_si64(low)));
  const __m512 b = normals_of(static_cast<std::uint64_t>(_mm_extract_epi64(low, 1)));
  const __m512 c = normals_of(static_cast<std::uint64_t>(_mm_cvtsi128_si64(high)));
  const __m512 d = normals_of(static_cast<std::uint64_t>(_mm_extract_epi64(high, 1)));
  // Twelve lanes of a and four of b; eight of b and eight of c; four of c and twelve of d.
  sink.put(_mm512_permutex2var_ps(a, _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 16, 17, 18, 20), b));
  sink.put(_mm512_permutex2var_ps(b, _mm512_setr_epi32(5, 6, 8, 9, 10, 12, 13, 14, 16, 17, 18, 20, 21, 22, 24, 25), c));
  sink.put(
      _mm512_permutex2var_ps(c, _mm512_setr_epi32(10, 12, 13, 14, 16, 17, 18, 20, 21, 22, 24, 25, 26, 28, 29, 30), d));
}

template <class Sink>
QNV_AVX512_INLINE void unpack_sixteen(const std::byte* records, const WideFrame& frame, Sink& positions, Sink& normals,
                                      Sink& weights, std::uint8_t* colors) {
  const __m512i evens = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i odds = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
  const __m512i first = _mm512_loadu_si512(records), second = _mm512_loadu_si512(records + 64);
  const __m512i low = _mm512_permutex2var_epi32(first, evens, second);
  const __m512i high = _mm512_permutex2var_epi32(first, odds, second);
  put_interleaved(positions, coordinates(low, frame.x), coordinates(_mm512_srli_epi32(low, 10), frame.y),
                  coordinates(_mm512_srli_epi32(low, 20), frame.z));
  put_normals(normals, _mm512_or_si512(_mm512_srli_epi32(low, 30),
                                       _mm512_slli_epi32(_mm512_and_si512(high, _mm512_set1_epi32(0x1ff)), 2)));
  const __m512i areas =
      _mm512_max_epi32(_mm512_and_si512(_mm512_srli_epi32(high, 9), _mm512_set1_epi32(0x7fff)), _mm512_set1_epi32(1));
  weights.put(_mm512_mul_ps(_mm512_cvtepi32_ps(areas), frame.weight_step));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(colors), _mm512_cvtepi32_epi8(_mm512_srli_epi32(high, 24)));
}

// Unpacks `count` records, a multiple of sixteen.
template <class Sink>
QNV_AVX512_INLINE void unpack_sixteens(const std::byte* records, std::size_t count, const RecordFrame& frame,
                                       const Outputs& out) {
  const WideFrame wide = widen(frame);
  Sink positions{&out.positions->x}, normals{&out.normals->x}, weights{out.weights};
  for (std::size_t i = 0; i < count; i += kLanes)
    unpack_sixteen(records + kRecordBytes * i, wide, positions, normals, weights, out.colors + i);
}

}  // namespace

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
}

QNV_AVX512 void unpack_avx512(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out,
                              Store store) {
  std::size_t done = 0;
  if (store == Store::streamed && count >= 4 * kLanes) {
    // Store the first and last records through the caches, because streams start and end inside a vector.
    unpack_sixteens<CachedSink>(records, kLanes, frame, out);
    done = count / kLanes * kLanes;
    unpack_sixteens<StreamedSink>(records + kRecordBytes * kLanes, done - kLanes, frame, behind(out, kLanes));
    _mm_sfence();
    done -= kLanes;
  }
  const std::size_t whole = (count - done) / kLanes * kLanes;
  if (whole > 0) unpack_sixteens<CachedSink>(records + kRecordBytes * done, whole, frame, behind(out, done));
  done += whole;
  unpack_tail<kLanes>(records + kRecordBytes * done, count - done, behind(out, done),
                      [&](const std::byte* p, float* positions, float* normals, float* weights, std::uint8_t* colors)
                          QNV_AVX512 {
                            CachedSink to[] = {{positions}, {normals}, {weights}};
                            unpack_sixteen(p, widen(frame), to[0], to[1], to[2], colors);
                          });
}

}  // namespace gs::qnv::record_paths

#else

namespace gs::qnv::record_paths {

bool has_avx512() { return false; }
void unpack_avx512(const std::byte* records, std::size_t count, const RecordFrame& frame, const Outputs& out, Store) {
  unpack_portable(records, count, frame, out);
}

}  // namespace gs::qnv::record_paths

#endif
