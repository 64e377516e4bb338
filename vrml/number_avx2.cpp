#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "vrml/number_paths.h"

#if defined(__x86_64__)

#include <immintrin.h>

// The instructions are switched on function by function, so that the program runs on every x86-64.
#define GHOSTSPACE_AVX2 __attribute__((target("avx2,bmi,bmi2,popcnt")))
#define GHOSTSPACE_AVX2_INLINE __attribute__((target("avx2,bmi,bmi2,popcnt"), always_inline)) inline

namespace gs::vrml::number_paths {
namespace {

// A round looks at the 64 bytes behind the last number read: vector compares turn them into bit masks, and
// a few operations on those give where each number starts, has its point and ends. So no number waits for
// the one before it. Up to kRound numbers that the window holds whole are then worked out at once, each in
// its own lane of bytes, its last digit in the last byte. Whatever is unusual in a window, real or
// possible, makes read_plain do the round instead.
constexpr std::ptrdiff_t kWindow = 64;
constexpr std::size_t kRound = 8;
constexpr std::ptrdiff_t kLane = 16;  // so far a lane may reach in front of the window

// keep + n: a lane that keeps its last n bytes, for n up to 64; the eight-byte lanes begin 8 bytes later.
constexpr std::array<std::uint8_t, 80> kKeep = [] {
  std::array<std::uint8_t, 80> table{};
  for (std::size_t i = 16; i < table.size(); ++i) table[i] = 0xff;
  return table;
}();

// By how many bytes a number goes on from its point, that one included; 0 for no point.
struct alignas(32) Point {
  std::uint8_t shuffle[16];  // closes the gap that the point leaves
  double power;              // what the digits, read as one integer, must be divided by
};
constexpr std::array<Point, 17> kPoints = [] {
  std::array<Point, 17> table{};
  double power = 1;
  for (unsigned n = 0; n < table.size(); ++n) {
    if (n > 1) power *= 10;
    table[n].power = power;
    for (unsigned i = 0; i < 16; ++i) {
      const bool moves = n > 0 && i <= 16 - n;
      table[n].shuffle[i] = static_cast<std::uint8_t>(!moves ? i : i > 0 ? i - 1 : 0x80);
    }
  }
  return table;
}();

struct Window {
  std::uint64_t starts;   // first bytes of numbers
  std::uint64_t points;   // first bytes behind the whole parts of numbers: a point or the end
  std::uint64_t ends;     // separators behind numbers
  std::uint64_t others;   // no digit, sign, point or separator
  std::uint64_t bodies;   // all that is no separator
  std::uint64_t faults;   // where a number is none
  std::uint64_t feeds;    // line feeds
};

GHOSTSPACE_AVX2_INLINE std::uint64_t mask_of(__m256i low, __m256i high) {
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(low)) |
         std::uint64_t{static_cast<std::uint32_t>(_mm256_movemask_epi8(high))} << 32;
}

// Bytes that are the entry for their own low nibble.
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
  const std::uint64_t points = kFloats ? equal_mask(low, high, '.') : 0;
  const std::uint64_t digits = mask_of(is_digit(low), is_digit(high));
  const std::uint64_t known = mask_of(in_table(marks, low), in_table(marks, high));
  w.feeds = equal_mask(low, high, '\n');
  const std::uint64_t signs = known & ~blanks & ~points;
  w.others = ~(digits | known);
  if (w.others) {  // a carriage return in front of its line feed is a separator
    const std::uint64_t returns = equal_mask(low, high, '\r') & (w.feeds >> 1);
    blanks |= returns;
    w.others &= ~returns;
  }
  w.bodies = ~blanks;
  w.starts = w.bodies & ~(w.bodies << 1);
  w.ends = blanks & (w.bodies << 1);
  // A carry runs from each start through the digits to the first byte behind them.
  const std::uint64_t runs = w.bodies & ~points;
  w.points = kFloats ? (runs + w.starts) & ~runs : w.ends;
  w.faults = w.others | (signs & ~w.starts) | ((signs << 1) & blanks);
  if (kFloats) w.faults |= (points & ~w.points) | (points & (blanks >> 1) & (w.starts | signs << 1));
  return w;
}

// Where `mask` has kLength bits in a row.
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

// What takes the numbers out of a window one after another.
struct Cutter {
  const char* p;
  std::uint64_t points;
  std::uint64_t ends;
  unsigned last_end = 0;
};

struct Cut {
  unsigned end;
  unsigned gap;    // from the end of the number before
  unsigned point;  // as in kPoints
};
GHOSTSPACE_AVX2_INLINE Cut cut(Cutter& cutter) {
  const unsigned end = pop(cutter.ends);
  const Cut result{end, end - cutter.last_end, end - pop(cutter.points)};
  cutter.last_end = end;
  return result;
}

// The digits of two numbers, and where their lanes hold a minus.
struct Pair {
  __m256i digits;
  __m256i minus;
};
GHOSTSPACE_AVX2_INLINE Pair pair(const char* p, const Cut& a, const Cut& b) {
  const __m256i text = load16x2(p + a.end - 16, p + b.end - 16);
  const __m256i keep = load16x2(kKeep.data() + a.gap, kKeep.data() + b.gap);
  const __m256i shuffle = load16x2(kPoints[a.point].shuffle, kPoints[b.point].shuffle);
  // Signs, points and separators all come before '0', and become zeros in front of the digits.
  const __m256i digits = _mm256_and_si256(_mm256_subs_epu8(text, _mm256_set1_epi8('0')), keep);
  const __m256i minus = _mm256_and_si256(_mm256_cmpeq_epi8(text, _mm256_set1_epi8('-')), keep);
  return {_mm256_shuffle_epi8(digits, shuffle), minus};
}

// Lanes of 16 digits to four numbers below 10^4 each.
GHOSTSPACE_AVX2_INLINE __m256i join_to_four(__m256i digits) {
  const __m256i twos = _mm256_maddubs_epi16(digits, _mm256_set1_epi16(0x010a));
  return _mm256_madd_epi16(twos, _mm256_set1_epi32(0x00010064));
}

// Four floats. Bits of `doubtful`: those whose rounding, or even mantissa, is not certain.
GHOSTSPACE_AVX2_INLINE __m128 four_floats(Cutter& cutter, unsigned& doubtful) {
  const Cut c0 = cut(cutter), c1 = cut(cutter), c2 = cut(cutter), c3 = cut(cutter);
  const Pair even = pair(cutter.p, c0, c2);
  const Pair odd = pair(cutter.p, c1, c3);
  const __m256i fours = _mm256_packus_epi32(join_to_four(even.digits), join_to_four(odd.digits));
  const __m256i eights = _mm256_madd_epi16(fours, _mm256_set1_epi32(0x00012710));
  const __m256i mantissas = _mm256_add_epi64(_mm256_mul_epu32(eights, _mm256_set1_epi64x(100000000)),
                                             _mm256_srli_epi64(eights, 32));
  // Below 2^52 the bits of an integer are those of the double 2^52 + integer.
  const __m256i large = _mm256_cmpgt_epi64(mantissas, _mm256_set1_epi64x((std::int64_t{1} << 52) - 1));
  const __m256i magic = _mm256_set1_epi64x(0x4330000000000000);
  const __m256d integers = _mm256_sub_pd(_mm256_castsi256_pd(_mm256_or_si256(mantissas, magic)),
                                         _mm256_castsi256_pd(magic));
  const __m256d powers = _mm256_setr_pd(kPoints[c0.point].power, kPoints[c1.point].power, kPoints[c2.point].power,
                                        kPoints[c3.point].power);
  const __m256d quotients = _mm256_div_pd(integers, powers);
  // Integer and power are exact and the quotient is correctly rounded, so that rounding it again can only
  // go wrong when it lies exactly between two floats. None is so small that the floats are denormal.
  const __m256i rest = _mm256_and_si256(_mm256_castpd_si256(quotients), _mm256_set1_epi64x(0x1fffffff));
  const __m256i middle = _mm256_cmpeq_epi64(rest, _mm256_set1_epi64x(0x10000000));
  doubtful = static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(_mm256_or_si256(middle, large))));
  const __m256i minus = _mm256_or_si256(_mm256_unpacklo_epi64(even.minus, odd.minus),
                                        _mm256_unpackhi_epi64(even.minus, odd.minus));
  const __m256i positive = _mm256_cmpeq_epi64(minus, _mm256_setzero_si256());
  const __m256d sign = _mm256_andnot_pd(_mm256_castsi256_pd(positive), _mm256_set1_pd(-0.0));
  return _mm256_cvtpd_ps(_mm256_xor_pd(quotients, sign));
}

// Where a round ends, once its numbers are written: moves `run` behind `count` numbers.
GHOSTSPACE_AVX2_INLINE void finish_round(NumberRun& run, const Window& w, std::size_t count, unsigned size) {
  const std::uint64_t feeds = _bzhi_u64(w.feeds, size);
  run.line_start = feeds ? run.next + 64 - __builtin_clzll(feeds) : run.line_start;
  run.lines += static_cast<std::size_t>(_mm_popcnt_u64(feeds));
  run.next += size;
  run.count += count;
}

// Up to and with the highest bit; `mask` is not 0.
GHOSTSPACE_AVX2_INLINE std::uint64_t up_to_last(std::uint64_t mask) {
  return ~std::uint64_t{0} >> static_cast<unsigned>(__builtin_clzll(mask));
}

// False, and nothing done, where the window needs read_plain.
GHOSTSPACE_AVX2_INLINE bool float_round(NumberRun& run, float* out) {
  const Window w = look<true>(run.next);
  if (w.ends == 0) return false;
  const std::uint64_t whole = up_to_last(w.ends);
  if ((w.faults | long_runs<17>(w.bodies)) & whole) return false;
  const auto count = std::min<std::size_t>(static_cast<std::size_t>(_mm_popcnt_u64(w.ends)), kRound);
  Cutter cutter{run.next, w.points & whole, w.ends};
  unsigned doubtful[2];
  const __m128 first = four_floats(cutter, doubtful[0]);
  const __m128 second = four_floats(cutter, doubtful[1]);
  if (_bzhi_u32(doubtful[0] | doubtful[1] << 4, static_cast<unsigned>(count))) return false;
  _mm_storeu_ps(out + run.count, first);
  _mm_storeu_ps(out + run.count + 4, second);
  const unsigned size = std::min(cutter.last_end, 63u - static_cast<unsigned>(__builtin_clzll(w.ends)));
  finish_round(run, w, count, size);
  return true;
}

// Four eight-byte lanes that end at a, b, c, d.
GHOSTSPACE_AVX2_INLINE __m256i load8x4(const void* a, const void* b, const void* c, const void* d) {
  const auto half = [](const void* low, const void* high) __attribute__((target("avx2"), always_inline)) {
    const __m128i first = _mm_loadl_epi64(static_cast<const __m128i*>(low));
    return _mm_castps_si128(_mm_loadh_pi(_mm_castsi128_ps(first), static_cast<const __m64*>(high)));
  };
  return _mm256_inserti128_si256(_mm256_castsi128_si256(half(a, b)), half(c, d), 1);
}

// The digits of four numbers in lanes of eight, and where the lanes hold a minus.
GHOSTSPACE_AVX2_INLINE Pair short_integers(const char* p, unsigned before, unsigned a, unsigned after_a, unsigned b,
                                           unsigned c_before, unsigned c, unsigned d) {
  (void)after_a;
  const __m256i text = load8x4(p + a - 8, p + b - 8, p + c - 8, p + d - 8);
  const std::uint8_t* const table = kKeep.data() + 8;
  const __m256i keep = load8x4(table + (a - before), table + (b - a), table + (c - c_before), table + (d - c));
  return {_mm256_and_si256(_mm256_subs_epu8(text, _mm256_set1_epi8('0')), keep),
          _mm256_and_si256(_mm256_cmpeq_epi8(text, _mm256_set1_epi8('-')), keep)};
}

GHOSTSPACE_AVX2_INLINE bool integer_round(NumberRun& run, std::int32_t* out) {
  const Window w = look<false>(run.next);
  if (w.ends == 0) return false;
  const std::uint64_t whole = up_to_last(w.ends);
  if ((w.faults | long_runs<9>(w.bodies)) & whole) return false;
  std::uint64_t ends = w.ends;
  const unsigned e0 = pop(ends), e1 = pop(ends), e2 = pop(ends), e3 = pop(ends);
  const unsigned e4 = pop(ends), e5 = pop(ends), e6 = pop(ends), e7 = pop(ends);
  // In this order, packing brings the eight into theirs.
  const Pair a = short_integers(run.next, 0, e0, e0, e1, e3, e4, e5);
  const Pair b = short_integers(run.next, e1, e2, e2, e3, e5, e6, e7);
  const __m256i fours = _mm256_packus_epi32(join_to_four(a.digits), join_to_four(b.digits));
  const __m256i eights = _mm256_madd_epi16(fours, _mm256_set1_epi32(0x00012710));
  const __m256i minus = _mm256_packs_epi32(a.minus, b.minus);
  const __m256i positive = _mm256_cmpeq_epi32(minus, _mm256_setzero_si256());
  const __m256i negative = _mm256_xor_si256(positive, _mm256_set1_epi32(-1));
  const __m256i values = _mm256_sub_epi32(_mm256_xor_si256(eights, negative), negative);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + run.count), values);
  const auto count = std::min<std::size_t>(static_cast<std::size_t>(_mm_popcnt_u64(w.ends)), kRound);
  const unsigned size = std::min(e7, 63u - static_cast<unsigned>(__builtin_clzll(w.ends)));
  finish_round(run, w, count, size);
  return true;
}

GHOSTSPACE_AVX2_INLINE bool round_of(NumberRun& run, float* out) { return float_round(run, out); }
GHOSTSPACE_AVX2_INLINE bool round_of(NumberRun& run, std::int32_t* out) { return integer_round(run, out); }

template <class T>
GHOSTSPACE_AVX2_INLINE NumberRun read(const char* begin, const char* end, T* out, std::size_t capacity) {
  NumberRun run{begin, 0, 0, nullptr};
  const char* const guard = find_guard(begin, end);
  if (!guard) return run;
  while (end - run.next >= kWindow && capacity - run.count >= kRound) {
    if (run.next - begin >= kLane && round_of(run, out)) continue;
    const std::size_t target = run.count + kRound;
    read_plain(run, guard, out, target);
    if (run.count < target) return run;
  }
  read_plain(run, guard, out, capacity);
  return run;
}

}  // namespace

bool has_avx2() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
         __builtin_cpu_supports("popcnt");
}

GHOSTSPACE_AVX2 NumberRun floats_avx2(const char* begin, const char* end, float* out, std::size_t capacity) {
  return read(begin, end, out, capacity);
}
GHOSTSPACE_AVX2 NumberRun integers_avx2(const char* begin, const char* end, std::int32_t* out, std::size_t capacity) {
  return read(begin, end, out, capacity);
}

}  // namespace gs::vrml::number_paths

#else

namespace gs::vrml::number_paths {

bool has_avx2() { return false; }

NumberRun floats_avx2(const char* begin, const char* end, float* out, std::size_t capacity) {
  return floats_portable(begin, end, out, capacity);
}
NumberRun integers_avx2(const char* begin, const char* end, std::int32_t* out, std::size_t capacity) {
  return integers_portable(begin, end, out, capacity);
}

}  // namespace gs::vrml::number_paths

#endif
