#pragma once

// Windows and lanes of the AVX2 path in number_paths.h. Only number_avx2.cpp includes this file.

#include <immintrin.h>

#include <array>
#include <cstddef>
#include <cstdint>

// Enables the instructions per function, so that the program runs on every x86-64.
#define GHOSTSPACE_AVX2 __attribute__((target("avx2,bmi,bmi2,popcnt")))
#define GHOSTSPACE_AVX2_INLINE __attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) inline

namespace gs::vrml::number_paths {

// Mask bytes for lanes: the 16 bytes from kKeep + n on keep the last n bytes of a lane, n <= 64. For eight-byte lanes,
// start 8 bytes later.
inline constexpr std::array<std::uint8_t, 80> kKeep = [] {
  std::array<std::uint8_t, 80> table{};
  for (std::size_t i = 16; i < table.size(); ++i) table[i] = 0xff;
  return table;
}();

// Operations for a number with a decimal point a given number of bytes before its end. The index is this number, which
// counts the point; 0 means that there is no point.
struct alignas(32) Point {
  std::uint8_t shuffle[16];  // closes the gap of the decimal point
  double power;  // divisor of the digits, which are read as one integer
};
inline constexpr std::array<Point, 17> kPoints = [] {
  std::array<Point, 17> table{};
  double power = 1;
  for (unsigned n = 0; n < table.size(); ++n) {
    if (n > 1) power *= 10;
    table[n].power = power;
    for (unsigned i = 0; i < 16; ++i) {
      const bool moves = n > 0 && n + i <= 16;
      table[n].shuffle[i] = static_cast<std::uint8_t>(!moves ? i : i > 0 ? i - 1 : 0x80);
    }
  }
  return table;
}();

// Window of 64 bytes, as masks with one bit per byte. A body is a run of bytes that are not separators.
struct Window {
  std::uint64_t bodies;
  std::uint64_t starts;  // first bytes of bodies
  std::uint64_t ends;    // separators after bodies
  std::uint64_t wholes;  // first bytes after integer parts: a decimal point or the end
  std::uint64_t dots;  // all decimal points
  std::uint64_t signs;
  std::uint64_t others;  // bytes other than digits, signs, decimal points and separators
  std::uint64_t faults;  // bytes that make a body something else than a plain number
  std::uint64_t feeds;   // line feeds
};

GHOSTSPACE_AVX2_INLINE std::uint64_t mask_of(__m256i low, __m256i high) {
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(low)) |
         std::uint64_t{static_cast<std::uint32_t>(_mm256_movemask_epi8(high))} << 32;
}

// Marks the bytes that equal the table entry for their lowest four bits.
GHOSTSPACE_AVX2_INLINE __m256i in_table(__m256i table, __m256i bytes) {
  return _mm256_cmpeq_epi8(bytes, _mm256_shuffle_epi8(table, bytes));
}
GHOSTSPACE_AVX2_INLINE std::uint64_t equal_mask(__m256i low, __m256i high, char c) {
  const __m256i wanted = _mm256_set1_epi8(c);
  return mask_of(_mm256_cmpeq_epi8(low, wanted), _mm256_cmpeq_epi8(high, wanted));
}
GHOSTSPACE_AVX2_INLINE __m256i is_digit(__m256i bytes) {
  return _mm256_cmpeq_epi8(_mm256_max_epu8(_mm256_sub_epi8(bytes, _mm256_set1_epi8('0')), _mm256_set1_epi8(9)),
                           _mm256_set1_epi8(9));
}

// Returns for each bit of `from` the first byte at or after it that is outside of `runs`. The carry of an addition
// finds these bytes.
GHOSTSPACE_AVX2_INLINE std::uint64_t first_behind(std::uint64_t runs, std::uint64_t from) {
  return (runs + from) & ~runs;
}

// Returns the faulty bytes: signs that are not at a start or that nothing follows, second decimal points, and decimal
// points without a digit.
GHOSTSPACE_AVX2_INLINE std::uint64_t faults_of(std::uint64_t signs, std::uint64_t dots, std::uint64_t starts,
                                               std::uint64_t wholes, std::uint64_t blanks) {
  const std::uint64_t before_blanks = blanks >> 1;
  return (signs & (~starts | before_blanks)) | (dots & (~wholes | (before_blanks & (starts | signs << 1))));
}

template <bool kFloats>
GHOSTSPACE_AVX2_INLINE Window look(const char* p) {
  const __m256i low = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
  const __m256i high = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p + 32));
  const __m256i separators = _mm256_setr_epi8(' ', 0, 0, 0, 0, 0, 0, 0, 0, '\t', '\n', 0, ',', 0, 0, 0,  //
                                              ' ', 0, 0, 0, 0, 0, 0, 0, 0, '\t', '\n', 0, ',', 0, 0, 0);
  const char point = kFloats ? '.' : 0;
  const __m256i marks = _mm256_setr_epi8(' ', 0, 0, 0, 0, 0, 0, 0, 0, '\t', '\n', '+', ',', '-', point, 0,  //
                                         ' ', 0, 0, 0, 0, 0, 0, 0, 0, '\t', '\n', '+', ',', '-', point, 0);
  Window w;
  std::uint64_t blanks = mask_of(in_table(separators, low), in_table(separators, high));
  const std::uint64_t digits = mask_of(is_digit(low), is_digit(high));
  const std::uint64_t known = mask_of(in_table(marks, low), in_table(marks, high));
  w.dots = kFloats ? equal_mask(low, high, '.') : 0;
  w.feeds = equal_mask(low, high, '\n');
  w.signs = known & ~blanks & ~w.dots;
  w.others = ~(digits | known);
  if (w.others) {  // a carriage return before a line feed counts as a separator
    const std::uint64_t returns = equal_mask(low, high, '\r') & (w.feeds >> 1);
    blanks |= returns;
    w.others &= ~returns;
  }
  w.bodies = ~blanks;
  w.starts = w.bodies & ~(w.bodies << 1);
  w.ends = blanks & (w.bodies << 1);
  w.wholes = kFloats ? first_behind(w.bodies & ~w.dots, w.starts) : w.ends;
  w.faults = w.others | faults_of(w.signs, w.dots, w.starts, w.wholes, blanks);
  return w;
}

// Returns the bits at which `mask` has kLength bits in a row.
template <unsigned kLength>
GHOSTSPACE_AVX2_INLINE std::uint64_t long_runs(std::uint64_t mask) {
  static_assert(kLength == 9 || kLength == 17);
  mask &= mask >> 1;
  mask &= mask >> 2;
  mask &= mask >> 4;
  if (kLength == 17) mask &= mask >> 8;
  return mask & mask >> 1;
}

GHOSTSPACE_AVX2_INLINE unsigned pop(std::uint64_t& mask) {
  const auto bit = static_cast<unsigned>(_tzcnt_u64(mask));
  mask = _blsr_u64(mask);
  return bit;
}

GHOSTSPACE_AVX2_INLINE __m128i load16(const void* p) { return _mm_loadu_si128(static_cast<const __m128i*>(p)); }
GHOSTSPACE_AVX2_INLINE __m256i load16x2(const void* low, const void* high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(load16(low)), load16(high), 1);
}

// Extent of a number in a window, for a lane.
struct Cut {
  unsigned end;
  unsigned keep;  // number of bytes before the end that the lane keeps
  unsigned point;  // index in kPoints
};

// Iterator over the plain numbers of a window. After the last number, positions are 64.
struct Cutter {
  const char* p;
  std::uint64_t wholes;
  std::uint64_t ends;
  unsigned last_end = 0;
};
GHOSTSPACE_AVX2_INLINE Cut cut(Cutter& cutter) {
  const unsigned end = pop(cutter.ends);
  const Cut result{end, end - cutter.last_end, end - pop(cutter.wholes)};
  cutter.last_end = end;
  return result;
}

// Digits of two numbers, and a mask of their minus signs.
struct Pair {
  __m256i digits;
  __m256i minus;
};
GHOSTSPACE_AVX2_INLINE Pair pair(const char* p, const Cut& a, const Cut& b) {
  const __m256i text = load16x2(p + a.end - 16, p + b.end - 16);
  const __m256i keep = load16x2(kKeep.data() + a.keep, kKeep.data() + b.keep);
  const __m256i shuffle = load16x2(kPoints[a.point].shuffle, kPoints[b.point].shuffle);
  // Signs, decimal points and separators have lower codes than '0'. They become zeros before the digits.
  const __m256i digits = _mm256_and_si256(_mm256_subs_epu8(text, _mm256_set1_epi8('0')), keep);
  const __m256i minus = _mm256_and_si256(_mm256_cmpeq_epi8(text, _mm256_set1_epi8('-')), keep);
  return {_mm256_shuffle_epi8(digits, shuffle), minus};
}

// Joins lanes of 16 digits to four numbers below 10^4 each.
GHOSTSPACE_AVX2_INLINE __m256i join_to_four(__m256i digits) {
  const __m256i twos = _mm256_maddubs_epi16(digits, _mm256_set1_epi16(0x010a));
  return _mm256_madd_epi16(twos, _mm256_set1_epi32(0x00010064));
}

// Returns the eight-digit numbers of two pairs, in the order a0, b0, a1, b1.
GHOSTSPACE_AVX2_INLINE __m256i join_to_eight(__m256i a, __m256i b) {
  const __m256i fours = _mm256_packus_epi32(join_to_four(a), join_to_four(b));
  return _mm256_madd_epi16(fours, _mm256_set1_epi32(0x00012710));
}

// Four numbers: their digits as integers, and masks with all bits set for numbers that are not negative.
struct Four {
  Cut cuts[4];
  __m256i mantissas;
  __m256i positive;
};
template <class AnyCutter>
GHOSTSPACE_AVX2_INLINE Four cut_four(AnyCutter& cutter) {
  const Cut c0 = cut(cutter), c1 = cut(cutter), c2 = cut(cutter), c3 = cut(cutter);
  const Pair even = pair(cutter.p, c0, c2);
  const Pair odd = pair(cutter.p, c1, c3);
  const __m256i eights = join_to_eight(even.digits, odd.digits);
  const __m256i upper = _mm256_mul_epu32(eights, _mm256_set1_epi64x(100000000));
  const __m256i minus =
      _mm256_or_si256(_mm256_unpacklo_epi64(even.minus, odd.minus), _mm256_unpackhi_epi64(even.minus, odd.minus));
  return {{c0, c1, c2, c3},
          _mm256_add_epi64(upper, _mm256_srli_epi64(eights, 32)),
          _mm256_cmpeq_epi64(minus, _mm256_setzero_si256())};
}

GHOSTSPACE_AVX2_INLINE unsigned bits_of(__m256i lanes) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(lanes)));
}

// Loads two eight-byte lanes.
GHOSTSPACE_AVX2_INLINE __m128i load8x2(const void* low, const void* high) {
  const __m128i first = _mm_loadl_epi64(static_cast<const __m128i*>(low));
  return _mm_castps_si128(_mm_loadh_pi(_mm_castsi128_ps(first), static_cast<const __m64*>(high)));
}

// Extent of an integer in a window: its end, and the number of bytes that its lane keeps.
struct ShortCut {
  unsigned end;
  unsigned keep;
};
GHOSTSPACE_AVX2_INLINE Pair short_pairs(const char* p, ShortCut a, ShortCut b, ShortCut c, ShortCut d) {
  const std::uint8_t* const table = kKeep.data() + 8;
  const __m256i text = _mm256_set_m128i(load8x2(p + c.end - 8, p + d.end - 8), load8x2(p + a.end - 8, p + b.end - 8));
  const __m256i keep =
      _mm256_set_m128i(load8x2(table + c.keep, table + d.keep), load8x2(table + a.keep, table + b.keep));
  return {_mm256_and_si256(_mm256_subs_epu8(text, _mm256_set1_epi8('0')), keep),
          _mm256_and_si256(_mm256_cmpeq_epi8(text, _mm256_set1_epi8('-')), keep)};
}

// Reads eight integers of up to eight characters.
GHOSTSPACE_AVX2_INLINE __m256i eight_integers(const char* p, const ShortCut (&cuts)[8]) {
  // With this order of the cuts, packing gives the original order.
  const Pair a = short_pairs(p, cuts[0], cuts[1], cuts[4], cuts[5]);
  const Pair b = short_pairs(p, cuts[2], cuts[3], cuts[6], cuts[7]);
  const __m256i eights = join_to_eight(a.digits, b.digits);
  const __m256i positive = _mm256_cmpeq_epi32(_mm256_packs_epi32(a.minus, b.minus), _mm256_setzero_si256());
  const __m256i negative = _mm256_xor_si256(positive, _mm256_set1_epi32(-1));
  return _mm256_sub_epi32(_mm256_xor_si256(eights, negative), negative);
}

}  // namespace gs::vrml::number_paths
