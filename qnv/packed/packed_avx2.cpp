#include "qnv/packed/packed_kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <array>
#include <bit>
#include <cstring>

namespace gs::qnv {
namespace {

#define GS_AVX2 __attribute__((target("avx2,popcnt")))
#define GS_AVX2_INLINE __attribute__((target("avx2,popcnt"), always_inline)) inline

/// For every mask of lanes: which of the next words each lane gets (`spread`), and the chosen lanes in order
/// (`squeeze`).
struct LaneTables {
  alignas(64) std::array<std::array<std::uint8_t, 8>, 256> spread{}, squeeze{};
};

constexpr LaneTables make_lane_tables() {
  LaneTables t;
  for (unsigned mask = 0; mask < 256; ++mask) {
    std::uint8_t next = 0;
    for (unsigned lane = 0; lane < 8; ++lane) {
      if ((mask >> lane & 1) == 0) continue;
      t.spread[mask][lane] = next;
      t.squeeze[mask][next++] = static_cast<std::uint8_t>(lane);
    }
  }
  return t;
}
constexpr LaneTables kLanes = make_lane_tables();

GS_AVX2_INLINE __m128i load8(const void* from) { return _mm_loadl_epi64(static_cast<const __m128i*>(from)); }

}  // namespace

/// The eight states of a decoder in one register.
struct RansVector {
  RansDecoder* decoder;
  __m256i states;
  std::size_t next, size;
  const std::byte* bytes;

  GS_AVX2_INLINE explicit RansVector(RansDecoder& d)
      : decoder(&d),
        states(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(d.states_))),
        next(d.next_),
        size(d.size_),
        bytes(d.bytes_) {}
  GS_AVX2_INLINE void store() const {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(decoder->states_), states);
    decoder->next_ = next;
  }
  [[nodiscard]] GS_AVX2_INLINE __m256i slots() const {
    return _mm256_and_si256(states, _mm256_set1_epi32(static_cast<int>(kRansTotal - 1)));
  }
  /// `distance` is the slot less the start of its symbol.
  GS_AVX2_INLINE void advance(__m256i frequency, __m256i distance) {
    const __m256i x = _mm256_add_epi32(_mm256_mullo_epi32(frequency, _mm256_srli_epi32(states, kRansBits)), distance);
    const __m256i low = _mm256_cmpeq_epi32(_mm256_srli_epi32(x, 16), _mm256_setzero_si256());
    const auto mask = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(low)));
    const __m128i coming = _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes + (next < size ? next : size)));
    const __m256i words = _mm256_permutevar8x32_epi32(_mm256_cvtepu16_epi32(coming),
                                                      _mm256_cvtepu8_epi32(load8(kLanes.spread[mask].data())));
    states = _mm256_blendv_epi8(x, _mm256_or_si256(_mm256_slli_epi32(x, 16), words), low);
    next += 2 * static_cast<std::size_t>(std::popcount(mask));
  }
};

namespace {

/// table[index] of eight lanes. Eight plain loads: the gather instruction of many processors is slower since its
/// microcode was mended (CVE-2022-40982).
GS_AVX2_INLINE __m256i look_up(const std::uint32_t* table, __m256i index) {
  const __m128i low = _mm256_castsi256_si128(index), high = _mm256_extracti128_si256(index, 1);
  const auto at = [table](int i) __attribute__((always_inline)) {
    return static_cast<int>(table[static_cast<std::uint32_t>(i)]);
  };
  return _mm256_setr_epi32(at(_mm_cvtsi128_si32(low)), at(_mm_extract_epi32(low, 1)), at(_mm_extract_epi32(low, 2)),
                           at(_mm_extract_epi32(low, 3)), at(_mm_cvtsi128_si32(high)), at(_mm_extract_epi32(high, 1)),
                           at(_mm_extract_epi32(high, 2)), at(_mm_extract_epi32(high, 3)));
}

/// along() of all eight children.
GS_AVX2_INLINE __m256i along8(const std::array<int, 3>& normal) {
  const __m256i x = _mm256_set1_epi32(normal[0]), y = _mm256_set1_epi32(normal[1]), z = _mm256_set1_epi32(normal[2]);
  const __m256i sx = _mm256_sign_epi32(x, _mm256_setr_epi32(-1, 1, -1, 1, -1, 1, -1, 1));
  const __m256i sy = _mm256_sign_epi32(y, _mm256_setr_epi32(-1, -1, 1, 1, -1, -1, 1, 1));
  const __m256i sz = _mm256_sign_epi32(z, _mm256_setr_epi32(-1, -1, -1, -1, 1, 1, 1, 1));
  return _mm256_add_epi32(sx, _mm256_add_epi32(sy, sz));
}

GS_AVX2 void occupancy(RansDecoder& decoder, const std::uint32_t* probabilities, const PackedVoxels& from,
                       std::size_t first, std::size_t count, std::uint8_t* masks) {
  RansVector rans(decoder);
  const __m256i total = _mm256_set1_epi32(static_cast<int>(kRansTotal));
  for (std::size_t i = 0; i < count; ++i) {
    const __m256i distance = along8(octahedral_normal(from.u[first + i], from.v[first + i]));
    const __m256i away = _mm256_abs_epi32(
        _mm256_sub_epi32(distance, _mm256_set1_epi32((2 * 2 * kOctahedral / kOffsetUnits) * from.offset[first + i])));
    __m256i bin = _mm256_srai_epi32(_mm256_sub_epi32(_mm256_set1_epi32(3 * kOctahedral), away), 7);
    bin = _mm256_min_epi32(_mm256_max_epi32(bin, _mm256_setzero_si256()),
                           _mm256_set1_epi32(static_cast<int>(kOccupancyBins) - 1));
    const __m256i probability = look_up(probabilities, bin);
    const __m256i slots = rans.slots(), there = _mm256_cmpgt_epi32(probability, slots);
    masks[i] = static_cast<std::uint8_t>(_mm256_movemask_ps(_mm256_castsi256_ps(there)));
    rans.advance(_mm256_blendv_epi8(_mm256_sub_epi32(total, probability), probability, there),
                 _mm256_sub_epi32(slots, _mm256_andnot_si256(there, probability)));
  }
  rans.store();
}

/// Twice a coordinate plus the child's bit of it, for the chosen children, first ones first.
GS_AVX2_INLINE void store_cells(std::uint16_t* to, std::uint16_t from, __m128i bits, __m128i squeeze) {
  const __m128i cells =
      _mm_add_epi16(_mm_set1_epi16(static_cast<short>(from * 2)), _mm_cvtepu8_epi16(_mm_shuffle_epi8(bits, squeeze)));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to), cells);
}

GS_AVX2 void inherit(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                     const PackedKernels::Inherited& to) {
  const __m128i bits_x = _mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0);
  const __m128i bits_y = _mm_setr_epi8(0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0);
  const __m128i bits_z = _mm_setr_epi8(0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0);
  const __m256i half = _mm256_set1_epi32(kOctahedral / 2), most = _mm256_set1_epi32(kOffsetUnits / 2);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t p = first + i;
    const __m128i squeeze = load8(kLanes.squeeze[masks[i]].data());
    store_cells(to.x + next, from.x[p], bits_x, squeeze);
    store_cells(to.y + next, from.y[p], bits_y, squeeze);
    store_cells(to.z + next, from.z[p], bits_z, squeeze);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to.u + next), _mm_set1_epi16(from.u[p]));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to.v + next), _mm_set1_epi16(from.v[p]));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to.parent + next), _mm_set1_epi16(static_cast<short>(p)));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to.context + next),
                     _mm_set1_epi8(static_cast<char>(residual_context(from.state[p]))));
    // predicted_offset() of all eight.
    const __m256i distance = along8(octahedral_normal(from.u[p], from.v[p]));
    __m256i offset = _mm256_srai_epi32(_mm256_add_epi32(_mm256_slli_epi32(distance, 5), half), 10);
    offset = _mm256_sub_epi32(_mm256_set1_epi32(2 * from.offset[p]), offset);
    offset = _mm256_min_epi32(_mm256_max_epi32(offset, _mm256_sub_epi32(_mm256_setzero_si256(), most)), most);
    const __m128i narrow = _mm_packs_epi32(_mm256_castsi256_si128(offset), _mm256_extracti128_si256(offset, 1));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(to.offset + next),
                     _mm_shuffle_epi8(_mm_packs_epi16(narrow, narrow), squeeze));
    next += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(masks[i])));
  }
}

GS_AVX2 void residuals(RansDecoder& decoder, const std::uint32_t* models, const std::uint8_t* context, std::size_t n,
                       std::int16_t* out) {
  const std::uint32_t* const slots = residual_slots();
  const auto base = [models](std::size_t i) { return static_cast<int>(models[i] * kRansTotal); };
  const __m256i bases = _mm256_setr_epi32(base(0), base(1), base(2), 0, 0, 0, 0, 0);
  std::size_t i = 0;
  {
    RansVector rans(decoder);
    for (; i + kRansLanes <= n; i += kRansLanes) {
      const __m256i base8 = _mm256_permutevar8x32_epi32(bases, _mm256_cvtepu8_epi32(load8(context + i)));
      const __m256i entry = look_up(slots, _mm256_add_epi32(base8, rans.slots()));
      rans.advance(_mm256_and_si256(_mm256_srli_epi32(entry, 12), _mm256_set1_epi32(0x1fff)),
                   _mm256_and_si256(entry, _mm256_set1_epi32(0xfff)));
      const __m256i symbol = _mm256_srli_epi32(entry, 25);
      const __m256i value =
          _mm256_xor_si256(_mm256_srli_epi32(symbol, 1),
                           _mm256_sub_epi32(_mm256_setzero_si256(), _mm256_and_si256(symbol, _mm256_set1_epi32(1))));
      _mm_storeu_si128(reinterpret_cast<__m128i*>(out + i),
                       _mm_packs_epi32(_mm256_castsi256_si128(value), _mm256_extracti128_si256(value, 1)));
      const __m256i escaped = _mm256_cmpeq_epi32(symbol, _mm256_set1_epi32(static_cast<int>(kEscape)));
      auto mask = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(escaped)));
      if (mask == 0) [[likely]]
        continue;
      rans.store();
      for (; mask != 0; mask &= mask - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
        out[i + lane] = static_cast<std::int16_t>(unzigzag(decoder.get_bits(lane, kEscapeBits)));
      }
      rans = RansVector(decoder);
    }
    rans.store();
  }
  packed_kernels_scalar().residuals(decoder, models, context + i, n - i, out + i);
}

}  // namespace

const PackedKernels* packed_kernels_avx2() {
  static constexpr PackedKernels kKernels{occupancy, inherit, residuals};
  static const bool there = __builtin_cpu_supports("avx2") != 0;
  return there ? &kKernels : nullptr;
}

}  // namespace gs::qnv

#else

namespace gs::qnv {
const PackedKernels* packed_kernels_avx2() { return nullptr; }
}  // namespace gs::qnv

#endif
