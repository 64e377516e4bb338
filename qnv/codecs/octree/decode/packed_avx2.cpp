#include "qnv/codecs/octree/decode/packed_kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <array>
#include <bit>
#include <cstring>

namespace gs::qnv {
namespace {

#define GS_AVX2 __attribute__((target("avx2,popcnt")))
#define GS_AVX2_INLINE __attribute__((target("avx2,popcnt"), always_inline)) inline

/// Tables indexed by a mask of lanes. `spread` is the index of the next word for each lane; `squeeze` lists the chosen
/// lanes in order.
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

/// Eight decoder states in one register.
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
  /// Advances the states by one symbol. `distance` is the slot minus the start of the symbol.
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

/// Loads table[index] in eight lanes. Uses plain loads: many processors have a slow gather instruction because of the
/// microcode fix for CVE-2022-40982.
GS_AVX2_INLINE __m256i look_up(const std::uint32_t* table, __m256i index) {
  const __m128i low = _mm256_castsi256_si128(index), high = _mm256_extracti128_si256(index, 1);
  const auto at = [table](int i) __attribute__((always_inline)) {
    return static_cast<int>(table[static_cast<std::uint32_t>(i)]);
  };
  return _mm256_setr_epi32(at(_mm_cvtsi128_si32(low)), at(_mm_extract_epi32(low, 1)), at(_mm_extract_epi32(low, 2)),
                           at(_mm_extract_epi32(low, 3)), at(_mm_cvtsi128_si32(high)), at(_mm_extract_epi32(high, 1)),
                           at(_mm_extract_epi32(high, 2)), at(_mm_extract_epi32(high, 3)));
}

/// Computes along() for all eight children of a voxel.
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

/// Stores the cells of the chosen children without gaps. A child's coordinate is twice the parent's, plus the child's
/// bit.
GS_AVX2_INLINE void store_cells(std::uint16_t* to, std::uint16_t from, __m128i bits, __m128i squeeze) {
  const __m128i cells =
      _mm_add_epi16(_mm_set1_epi16(static_cast<short>(from * 2)), _mm_cvtepu8_epi16(_mm_shuffle_epi8(bits, squeeze)));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to), cells);
}

/// Stores the values that children inherit from the parent alone: cells, parent index, context.
GS_AVX2_INLINE void inherit_cells(const PackedVoxels& from, std::size_t p, std::size_t next, __m128i squeeze,
                                  const PackedKernels::Inherited& to) {
  const __m128i bits_x = _mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0);
  const __m128i bits_y = _mm_setr_epi8(0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0);
  const __m128i bits_z = _mm_setr_epi8(0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0);
  store_cells(to.x + next, from.x[p], bits_x, squeeze);
  store_cells(to.y + next, from.y[p], bits_y, squeeze);
  store_cells(to.z + next, from.z[p], bits_z, squeeze);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to.parent + next), _mm_set1_epi16(static_cast<short>(p)));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(to.context + next),
                   _mm_set1_epi8(static_cast<char>(residual_context(from.state[p]))));
}

GS_AVX2_INLINE void store_offsets(std::int8_t* to, __m256i offset, __m128i squeeze) {
  const __m256i most = _mm256_set1_epi32(kOffsetUnits / 2);
  offset = _mm256_min_epi32(_mm256_max_epi32(offset, _mm256_sub_epi32(_mm256_setzero_si256(), most)), most);
  const __m128i narrow = _mm_packs_epi32(_mm256_castsi256_si128(offset), _mm256_extracti128_si256(offset, 1));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(to), _mm_shuffle_epi8(_mm_packs_epi16(narrow, narrow), squeeze));
}

/// Computes predicted_offset() for all eight children from their along() values, without clamping.
GS_AVX2_INLINE __m256i offsets8(__m256i distance, int offset) {
  const __m256i half = _mm256_set1_epi32(kOctahedral / 2);
  return _mm256_sub_epi32(_mm256_set1_epi32(2 * offset),
                          _mm256_srai_epi32(_mm256_add_epi32(_mm256_slli_epi32(distance, 5), half), 10));
}

GS_AVX2 void inherit(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                     const PackedKernels::Inherited& to) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t p = first + i;
    const __m128i squeeze = load8(kLanes.squeeze[masks[i]].data());
    inherit_cells(from, p, next, squeeze, to);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to.u + next), _mm_set1_epi16(from.u[p]));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to.v + next), _mm_set1_epi16(from.v[p]));
    store_offsets(to.offset + next, offsets8(along8(octahedral_normal(from.u[p], from.v[p])), from.offset[p]), squeeze);
    next += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(masks[i])));
  }
}

/// Negates the lanes in which `minus` has all bits set.
GS_AVX2_INLINE __m256i with_sign(__m256i value, __m256i minus) {
  return _mm256_sub_epi32(_mm256_xor_si256(value, minus), minus);
}
/// Computes for each face three times its value minus the value of the opposite face.
GS_AVX2_INLINE __m256i less_opposite(__m256i d) {
  return _mm256_sub_epi32(_mm256_add_epi32(_mm256_slli_epi32(d, 1), d), _mm256_shuffle_epi32(d, 0xb1));
}

/// Result of face_changes() for one voxel, with one lane per face.
struct Changes8 {
  __m256i u, v, offset;
};
GS_AVX2_INLINE __m256i nearer(__m256i a, __m256i b, __m256i& u, __m256i& v, __m256i least) {
  const __m256i size = _mm256_add_epi32(_mm256_abs_epi32(a), _mm256_abs_epi32(b));
  const __m256i better = _mm256_cmpgt_epi32(least, size);
  u = _mm256_blendv_epi8(u, a, better);
  v = _mm256_blendv_epi8(v, b, better);
  return _mm256_min_epi32(least, size);
}
GS_AVX2_INLINE Changes8 changes8(__m256i u, __m256i v, __m256i offset, const std::uint32_t* at) {
  constexpr auto kY = static_cast<std::ptrdiff_t>(PlaneBlock::kStrideY),
                 kZ = static_cast<std::ptrdiff_t>(PlaneBlock::kStrideZ);
  const auto plane = [at](std::ptrdiff_t i) __attribute__((always_inline)) { return static_cast<int>(at[i]); };
  const __m256i planes = _mm256_setr_epi32(plane(-1), plane(1), plane(-kY), plane(kY), plane(-kZ), plane(kZ), 0, 0);
  const __m256i unit = _mm256_set1_epi32(kOctahedral), zero = _mm256_setzero_si256();
  const __m256i low12 = _mm256_set1_epi32(0xfff), twice = _mm256_set1_epi32(2 * kOctahedral);
  const __m256i nu = _mm256_sub_epi32(_mm256_and_si256(planes, low12), unit);
  const __m256i nv = _mm256_sub_epi32(_mm256_and_si256(_mm256_srli_epi32(planes, 12), low12), unit);
  const __m256i no = _mm256_sub_epi32(_mm256_and_si256(_mm256_srli_epi32(planes, 24), _mm256_set1_epi32(0x7f)),
                                      _mm256_set1_epi32(kOffsetUnits / 2));
  // The sign of 0 counts as positive.
  const __m256i minus_u = _mm256_srai_epi32(nu, 31), minus_v = _mm256_srai_epi32(nv, 31);
  const __m256i su = _mm256_sub_epi32(with_sign(twice, minus_u), nu),
                sv = _mm256_sub_epi32(with_sign(twice, minus_v), nv);
  __m256i du = zero, dv = zero, least = _mm256_set1_epi32(kLargestTurn + 1);
  least = nearer(_mm256_sub_epi32(nu, u), _mm256_sub_epi32(nv, v), du, dv, least);
  least = nearer(_mm256_sub_epi32(su, u), _mm256_sub_epi32(_mm256_sub_epi32(zero, nv), v), du, dv, least);
  least = nearer(_mm256_sub_epi32(_mm256_sub_epi32(zero, nu), u), _mm256_sub_epi32(sv, v), du, dv, least);
  const __m256i counts = _mm256_and_si256(_mm256_srai_epi32(_mm256_and_si256(planes, _mm256_set1_epi32(plane(0))), 31),
                                          _mm256_cmpgt_epi32(_mm256_set1_epi32(kLargestTurn + 1), least));
  du = _mm256_and_si256(du, counts);
  dv = _mm256_and_si256(dv, counts);
  // Component of the neighbour's normal perpendicular to the face.
  const __m256i au = _mm256_abs_epi32(nu), av = _mm256_abs_epi32(nv);
  const __m256i w = _mm256_sub_epi32(_mm256_sub_epi32(unit, au), av), folded = _mm256_srai_epi32(w, 31);
  const __m256i nx = _mm256_blendv_epi8(nu, with_sign(_mm256_sub_epi32(unit, av), minus_u), folded);
  const __m256i ny = _mm256_blendv_epi8(nv, with_sign(_mm256_sub_epi32(unit, au), minus_v), folded);
  const __m256i across = _mm256_sign_epi32(_mm256_blend_epi32(_mm256_blend_epi32(nx, ny, 0x0c), w, 0xf0),
                                           _mm256_setr_epi32(-1, 1, -1, 1, -1, 1, -1, 1));
  const __m256i change =
      _mm256_add_epi32(_mm256_slli_epi32(_mm256_sub_epi32(no, offset), 1), _mm256_srai_epi32(across, 3));
  return {less_opposite(du), less_opposite(dv), _mm256_and_si256(change, counts)};
}

/// Computes for each of the eight children the sum of the changes at the three faces that it touches.
GS_AVX2_INLINE __m256i of_children(__m256i faces) {
  const __m256i x = _mm256_permutevar8x32_epi32(faces, _mm256_setr_epi32(0, 1, 0, 1, 0, 1, 0, 1));
  const __m256i y = _mm256_permutevar8x32_epi32(faces, _mm256_setr_epi32(2, 2, 3, 3, 2, 2, 3, 3));
  const __m256i z = _mm256_permutevar8x32_epi32(faces, _mm256_setr_epi32(4, 4, 4, 4, 5, 5, 5, 5));
  return _mm256_add_epi32(_mm256_add_epi32(x, y), z);
}

GS_AVX2_INLINE __m256i clamp8(__m256i value, int most) {
  const __m256i limit = _mm256_set1_epi32(most);
  return _mm256_max_epi32(_mm256_min_epi32(value, limit), _mm256_sub_epi32(_mm256_setzero_si256(), limit));
}

/// Folds the lanes in which `a` is outside the square.
GS_AVX2_INLINE void fold8(__m256i& a, __m256i& b) {
  const __m256i outside = _mm256_cmpgt_epi32(_mm256_abs_epi32(a), _mm256_set1_epi32(kOctahedral));
  const __m256i twice = _mm256_set1_epi32(2 * kOctahedral);
  a = _mm256_blendv_epi8(a, _mm256_sub_epi32(_mm256_sign_epi32(twice, a), a), outside);
  b = _mm256_blendv_epi8(b, _mm256_sub_epi32(_mm256_setzero_si256(), b), outside);
}

/// Computes wrap_octahedral() in eight lanes.
GS_AVX2_INLINE void wrap8(__m256i& u, __m256i& v) {
  fold8(u, v);
  fold8(v, u);
  u = clamp8(u, kOctahedral);
  v = clamp8(v, kOctahedral);
}

/// Computes along() of child c in lane c, with the normal in that lane.
GS_AVX2_INLINE __m256i along_own8(__m256i u, __m256i v) {
  const __m256i unit = _mm256_set1_epi32(kOctahedral), au = _mm256_abs_epi32(u), av = _mm256_abs_epi32(v);
  const __m256i w = _mm256_sub_epi32(_mm256_sub_epi32(unit, au), av), folded = _mm256_srai_epi32(w, 31);
  const __m256i minus_u = _mm256_srai_epi32(u, 31), minus_v = _mm256_srai_epi32(v, 31);
  const __m256i x = _mm256_blendv_epi8(u, with_sign(_mm256_sub_epi32(unit, av), minus_u), folded);
  const __m256i y = _mm256_blendv_epi8(v, with_sign(_mm256_sub_epi32(unit, au), minus_v), folded);
  const __m256i sx = _mm256_sign_epi32(x, _mm256_setr_epi32(-1, 1, -1, 1, -1, 1, -1, 1));
  const __m256i sy = _mm256_sign_epi32(y, _mm256_setr_epi32(-1, -1, 1, 1, -1, -1, 1, 1));
  const __m256i sz = _mm256_sign_epi32(w, _mm256_setr_epi32(-1, -1, -1, -1, 1, 1, 1, 1));
  return _mm256_add_epi32(sx, _mm256_add_epi32(sy, sz));
}

/// Stores the chosen lanes as 16 bits each, without gaps.
GS_AVX2_INLINE void store_squeezed16(std::int16_t* to, __m256i values, __m256i squeeze) {
  const __m256i chosen = _mm256_permutevar8x32_epi32(values, squeeze);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to),
                   _mm_packs_epi32(_mm256_castsi256_si128(chosen), _mm256_extracti128_si256(chosen, 1)));
}

GS_AVX2 void inherit_around(const PackedVoxels& from, std::size_t first, std::size_t count, const std::uint8_t* masks,
                            const PlaneBlock& block, bool normals, bool offsets, const PackedKernels::Inherited& to) {
  const __m256i two = _mm256_set1_epi32(2), eight = _mm256_set1_epi32(8);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t p = first + i;
    const __m128i squeeze = load8(kLanes.squeeze[masks[i]].data());
    const __m256i lanes = _mm256_cvtepu8_epi32(squeeze);
    inherit_cells(from, p, next, squeeze, to);
    const __m256i own_u = _mm256_set1_epi32(from.u[p]), own_v = _mm256_set1_epi32(from.v[p]);
    const Changes8 changes = changes8(own_u, own_v, _mm256_set1_epi32(from.offset[p]), block.planes + block.places[i]);
    __m256i u = own_u, v = own_v;
    if (normals) {
      u = _mm256_add_epi32(u, _mm256_srai_epi32(_mm256_add_epi32(of_children(changes.u), eight), 4));
      v = _mm256_add_epi32(v, _mm256_srai_epi32(_mm256_add_epi32(of_children(changes.v), eight), 4));
      wrap8(u, v);
    }
    store_squeezed16(to.u + next, u, lanes);
    store_squeezed16(to.v + next, v, lanes);
    __m256i offset = offsets8(offsets ? along_own8(u, v) : along_own8(own_u, own_v), from.offset[p]);
    if (offsets)
      offset = _mm256_add_epi32(offset, _mm256_srai_epi32(_mm256_add_epi32(of_children(changes.offset), two), 2));
    store_offsets(to.offset + next, offset, squeeze);
    next += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(masks[i])));
  }
}

GS_AVX2_INLINE __m256i load16(const std::int16_t* from) {
  return _mm256_cvtepi16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
}
GS_AVX2_INLINE void store16(std::int16_t* to, __m256i values) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to),
                   _mm_packs_epi32(_mm256_castsi256_si128(values), _mm256_extracti128_si256(values, 1)));
}

GS_AVX2 void turn(std::int16_t* u, std::int16_t* v, std::uint8_t* state, const std::int16_t* du, const std::int16_t* dv,
                  int step, std::size_t n) {
  const __m256i steps = _mm256_set1_epi32(step);
  const __m128i most = _mm_set1_epi16(kActivity);
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    __m256i a = _mm256_add_epi32(load16(u + i), _mm256_mullo_epi32(load16(du + i), steps));
    __m256i b = _mm256_add_epi32(load16(v + i), _mm256_mullo_epi32(load16(dv + i), steps));
    wrap8(a, b);
    store16(u + i, a);
    store16(v + i, b);
    const __m128i size =
        _mm_min_epi16(most, _mm_max_epi16(_mm_abs_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(du + i))),
                                          _mm_abs_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(dv + i)))));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(state + i),
                     _mm_or_si128(load8(state + i), _mm_packs_epi16(size, size)));
  }
  packed_kernels_scalar().turn(u + i, v + i, state + i, du + i, dv + i, step, n - i);
}

GS_AVX2 void move(std::int8_t* offset, const std::int16_t* residual, int step, std::size_t n) {
  // Clamps residuals that lead out of the range.
  const __m128i most = _mm_set1_epi16(kOffsetUnits / 2), far = _mm_set1_epi16(kOffsetUnits);
  const __m128i zero = _mm_setzero_si128(), steps = _mm_set1_epi16(static_cast<short>(step));
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    __m128i r = _mm_loadu_si128(reinterpret_cast<const __m128i*>(residual + i));
    r = _mm_max_epi16(_mm_min_epi16(r, far), _mm_sub_epi16(zero, far));
    r = _mm_add_epi16(_mm_cvtepi8_epi16(load8(offset + i)), _mm_mullo_epi16(r, steps));
    r = _mm_max_epi16(_mm_min_epi16(r, most), _mm_sub_epi16(zero, most));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(offset + i), _mm_packs_epi16(r, r));
  }
  packed_kernels_scalar().move(offset + i, residual + i, step, n - i);
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
  static constexpr PackedKernels kKernels{occupancy, inherit, inherit_around, turn, move, residuals};
  static const bool there = __builtin_cpu_supports("avx2") != 0;
  return there ? &kKernels : nullptr;
}

}  // namespace gs::qnv

#else

namespace gs::qnv {
const PackedKernels* packed_kernels_avx2() { return nullptr; }
}  // namespace gs::qnv

#endif
