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
// its own lane of bytes, its last digit in the last byte. The few that are too long for that, have an
// exponent, or are not certain to be rounded well, are then read again one by one. Where that will not do
// either, read_plain makes the round.
constexpr std::ptrdiff_t kWindow = 64;
constexpr std::size_t kRound = 8;
constexpr std::ptrdiff_t kLane = 16;  // so far a lane may reach in front of the window
// Processors fetch ahead only to the end of a page, and the loops are faster than the next one comes.
constexpr std::uintptr_t kAhead = 2048;

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
constexpr std::array<Point, 65> kPoints = [] {  // from 17 on for numbers that are read again
  std::array<Point, 65> table{};
  double power = 1;
  for (unsigned n = 0; n < table.size(); ++n) {
    if (n > 1 && n <= 16) power *= 10;
    table[n].power = power;
    for (unsigned i = 0; i < 16; ++i) {
      const bool moves = n > 0 && n + i <= 16;
      table[n].shuffle[i] = static_cast<std::uint8_t>(!moves ? i : i > 0 ? i - 1 : 0x80);
    }
  }
  return table;
}();

constexpr std::array<std::uint64_t, 17> kPowers = [] {
  std::array<std::uint64_t, 17> table{1};
  for (std::size_t i = 1; i < table.size(); ++i) table[i] = table[i - 1] * 10;
  return table;
}();

struct Window {
  std::uint64_t starts;  // first bytes of numbers
  std::uint64_t points;  // first bytes behind the whole parts of numbers: a point or the end
  std::uint64_t ends;    // separators behind numbers
  std::uint64_t digits;
  std::uint64_t bodies;  // all that is no separator
  std::uint64_t faults;  // where a number is none
  std::uint64_t feeds;   // line feeds
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
  w.digits = mask_of(is_digit(low), is_digit(high));
  const std::uint64_t known = mask_of(in_table(marks, low), in_table(marks, high));
  w.feeds = equal_mask(low, high, '\n');
  const std::uint64_t signs = known & ~blanks & ~points;
  std::uint64_t others = ~(w.digits | known);
  if (others) {  // a carriage return in front of its line feed is a separator
    const std::uint64_t returns = equal_mask(low, high, '\r') & (w.feeds >> 1);
    blanks |= returns;
    others &= ~returns;
  }
  w.bodies = ~blanks;
  w.starts = w.bodies & ~(w.bodies << 1);
  w.ends = blanks & (w.bodies << 1);
  // A carry runs from each start through the digits to the first byte behind them.
  const std::uint64_t runs = w.bodies & ~points;
  w.points = kFloats ? (runs + w.starts) & ~runs : w.ends;
  w.faults = others | (signs & ~w.starts) | ((signs << 1) & blanks);
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

// Four numbers: their digits read as integers, all ones for each that is not negative, and their powers.
struct Four {
  __m256i mantissas;
  __m256i positive;
  __m256d powers;
};
GHOSTSPACE_AVX2_INLINE Four take_four(Cutter& cutter) {
  const Cut c0 = cut(cutter), c1 = cut(cutter), c2 = cut(cutter), c3 = cut(cutter);
  const Pair even = pair(cutter.p, c0, c2);
  const Pair odd = pair(cutter.p, c1, c3);
  const __m256i fours = _mm256_packus_epi32(join_to_four(even.digits), join_to_four(odd.digits));
  const __m256i eights = _mm256_madd_epi16(fours, _mm256_set1_epi32(0x00012710));
  const __m256i upper = _mm256_mul_epu32(eights, _mm256_set1_epi64x(100000000));
  const __m256i minus =
      _mm256_or_si256(_mm256_unpacklo_epi64(even.minus, odd.minus), _mm256_unpackhi_epi64(even.minus, odd.minus));
  return {_mm256_add_epi64(upper, _mm256_srli_epi64(eights, 32)), _mm256_cmpeq_epi64(minus, _mm256_setzero_si256()),
          _mm256_setr_pd(kPoints[c0.point].power, kPoints[c1.point].power, kPoints[c2.point].power,
                         kPoints[c3.point].power)};
}

GHOSTSPACE_AVX2_INLINE unsigned bits_of(__m256i lanes) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(lanes)));
}

// Four floats. Bits of `doubtful`: those whose rounding, or even mantissa, is not certain.
GHOSTSPACE_AVX2_INLINE __m128 four_floats(Cutter& cutter, unsigned& doubtful) {
  const Four four = take_four(cutter);
  // Below 2^52 the bits of an integer are those of the double 2^52 + integer.
  const __m256i large = _mm256_cmpgt_epi64(four.mantissas, _mm256_set1_epi64x((std::int64_t{1} << 52) - 1));
  const __m256i magic = _mm256_set1_epi64x(0x4330000000000000);
  const __m256d integers =
      _mm256_sub_pd(_mm256_castsi256_pd(_mm256_or_si256(four.mantissas, magic)), _mm256_castsi256_pd(magic));
  const __m256d quotients = _mm256_div_pd(integers, four.powers);
  // Integer and power are exact and the quotient is correctly rounded, so that rounding it again can only
  // go wrong when it lies exactly between two floats. None is so small that the floats are denormal.
  const __m256i rest = _mm256_and_si256(_mm256_castpd_si256(quotients), _mm256_set1_epi64x(0x1fffffff));
  const __m256i middle = _mm256_cmpeq_epi64(rest, _mm256_set1_epi64x(0x10000000));
  doubtful = bits_of(_mm256_or_si256(middle, large));
  const __m256d sign = _mm256_andnot_pd(_mm256_castsi256_pd(four.positive), _mm256_set1_pd(-0.0));
  return _mm256_cvtpd_ps(_mm256_xor_pd(quotients, sign));
}

// Four integers of up to 16 characters. Bits of `doubtful`: those that do not fit 32 bits.
GHOSTSPACE_AVX2_INLINE __m128i four_integers(Cutter& cutter, unsigned& doubtful) {
  const Four four = take_four(cutter);
  const __m256i negative = _mm256_xor_si256(four.positive, _mm256_set1_epi64x(-1));
  const __m256i values = _mm256_sub_epi64(_mm256_xor_si256(four.mantissas, negative), negative);
  const __m256i shifted = _mm256_add_epi64(values, _mm256_set1_epi64x(std::int64_t{1} << 31));
  const __m256i fits = _mm256_cmpeq_epi64(_mm256_srli_epi64(shifted, 32), _mm256_setzero_si256());
  doubtful = bits_of(fits) ^ 0xfu;
  const __m256i low_halves = _mm256_permutevar8x32_epi32(values, _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6));
  return _mm256_castsi256_si128(low_halves);
}

// Moves `run` behind `count` numbers and `size` bytes of the window.
GHOSTSPACE_AVX2_INLINE void pass(NumberRun& run, const Window& w, std::size_t count, unsigned size) {
  const std::uint64_t feeds = _bzhi_u64(w.feeds, size);
  run.line_start = feeds ? run.next + 64 - __builtin_clzll(feeds) : run.line_start;
  run.lines += static_cast<std::size_t>(_mm_popcnt_u64(feeds));
  run.next += size;
  run.count += count;
}

// How many numbers a round reads.
GHOSTSPACE_AVX2_INLINE unsigned round_size(const Window& w) {
  return std::min(static_cast<unsigned>(_mm_popcnt_u64(w.ends)), static_cast<unsigned>(kRound));
}

// Ends a round of which `last_end` is the eighth end, 64 for none.
GHOSTSPACE_AVX2_INLINE void finish_round(NumberRun& run, const Window& w, unsigned last_end) {
  pass(run, w, round_size(w), std::min(last_end, 63u - static_cast<unsigned>(__builtin_clzll(w.ends))));
}

// Up to and with the highest bit; `mask` is not 0.
GHOSTSPACE_AVX2_INLINE std::uint64_t up_to_last(std::uint64_t mask) {
  return ~std::uint64_t{0} >> static_cast<unsigned>(__builtin_clzll(mask));
}

// A window without the end of any number. False where it is not all separators.
GHOSTSPACE_AVX2_INLINE bool pass_blanks(NumberRun& run, const Window& w) {
  if (w.bodies) return false;
  pass(run, w, 0, kWindow);
  return true;
}

// Up to 16 digits in front of `end`, of which 16 bytes can be read.
GHOSTSPACE_AVX2_INLINE std::uint64_t digits_before(const char* end, unsigned count) {
  const __m128i digits = _mm_and_si128(_mm_subs_epu8(load16(end - 16), _mm_set1_epi8('0')), load16(&kKeep[count]));
  const __m128i twos = _mm_maddubs_epi16(digits, _mm_set1_epi16(0x010a));
  const __m128i fours = _mm_madd_epi16(twos, _mm_set1_epi32(0x00010064));
  const __m128i eights = _mm_madd_epi16(_mm_packus_epi32(fours, fours), _mm_set1_epi32(0x00012710));
  const auto both = static_cast<std::uint64_t>(_mm_cvtsi128_si64(eights));
  return (both & 0xffffffffu) * 100000000 + (both >> 32);
}

// How many digits there are from place `at` of the window, which holds another byte behind them.
GHOSTSPACE_AVX2_INLINE unsigned count_digits(const Window& w, unsigned at) {
  return static_cast<unsigned>(_tzcnt_u64(~w.digits >> at));
}

// A number of up to 19 digits, with or without an exponent, that takes the bytes [at, end) of the window.
// False for some that are none, or are rare.
GHOSTSPACE_AVX2_INLINE bool read_single(const char* p, const Window& w, unsigned at, unsigned end, float& value) {
  const bool negative = p[at] == '-';
  at += negative || p[at] == '+';
  const unsigned whole = count_digits(w, at);
  at += whole;
  if (whole > 16) return false;
  std::uint64_t mantissa = digits_before(p + at, whole);
  unsigned places = 0;
  if (p[at] == '.') {
    places = count_digits(w, at + 1);
    at += 1 + places;
    if (places > 19 || (mantissa && whole + places > 19)) return false;
    const std::uint64_t fraction = digits_before(p + at, std::min(places, 16u));
    if (places > 16) mantissa = mantissa * kPowers[places - 16] + digits_before(p + at - 16, places - 16);
    mantissa = mantissa * kPowers[std::min(places, 16u)] + fraction;
  }
  if (whole + places == 0) return false;
  int exponent = -static_cast<int>(places);
  if (at != end) {
    if (p[at] != 'e' && p[at] != 'E') return false;
    ++at;
    const bool down = p[at] == '-';
    at += down || p[at] == '+';
    const unsigned length = count_digits(w, at);
    if (length == 0 || length > 3 || at + length != end) return false;
    const int shift = static_cast<int>(digits_before(p + end, length));
    exponent += down ? -shift : shift;
  }
  if (!scale(mantissa, exponent, value)) return false;
  value = negative ? -value : value;
  return true;
}

// Reads the numbers again for which `hard` has a bit. False where one of them is none.
GHOSTSPACE_AVX2 bool read_hard(const char* p, const Window& w, unsigned hard, float* out) {
  for (; hard; hard = _blsr_u32(hard)) {
    const unsigned index = _tzcnt_u32(hard);
    const auto start = static_cast<unsigned>(_tzcnt_u64(_pdep_u64(std::uint64_t{1} << index, w.starts)));
    const auto end = static_cast<unsigned>(_tzcnt_u64(_pdep_u64(std::uint64_t{1} << index, w.ends)));
    if (read_single(p, w, start, end, out[index])) continue;
    const char* next = p + start;
    if (!read_number(next, out[index]) || next != p + end) return false;
  }
  return true;
}

// The numbers of the window that four_floats cannot read.
GHOSTSPACE_AVX2_INLINE unsigned hard_ones(const Window& w, std::uint64_t faults) {
  const std::uint64_t ends = (w.bodies + faults) & ~w.bodies;  // a carry runs from each fault to the end
  return static_cast<unsigned>(_pext_u64(ends, w.ends));
}

// One round. False, and nothing done, where the window needs read_plain.
GHOSTSPACE_AVX2_INLINE bool read_round(NumberRun& run, float* out) {
  const Window w = look<true>(run.next);
  if (w.ends == 0) return pass_blanks(run, w);
  const std::uint64_t whole = up_to_last(w.ends);
  const std::uint64_t faults = (w.faults | long_runs<17>(w.bodies)) & whole;
  unsigned hard = faults ? hard_ones(w, faults) : 0;
  Cutter cutter{run.next, w.points & whole, w.ends};
  unsigned doubtful[2];
  const __m128 first = four_floats(cutter, doubtful[0]);
  const __m128 second = four_floats(cutter, doubtful[1]);
  _mm_storeu_ps(out + run.count, first);
  _mm_storeu_ps(out + run.count + 4, second);
  hard = _bzhi_u32(hard | doubtful[0] | doubtful[1] << 4, round_size(w));
  if (hard && !read_hard(run.next, w, hard, out + run.count)) return false;
  finish_round(run, w, cutter.last_end);
  return true;
}

// A round with integers of up to 16 characters among them.
GHOSTSPACE_AVX2_INLINE bool read_long_integers(NumberRun& run, const Window& w, std::int32_t* out) {
  Cutter cutter{run.next, w.ends, w.ends};
  unsigned doubtful[2];
  const __m128i first = four_integers(cutter, doubtful[0]);
  const __m128i second = four_integers(cutter, doubtful[1]);
  if (_bzhi_u32(doubtful[0] | doubtful[1] << 4, round_size(w))) return false;
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + run.count), _mm256_set_m128i(second, first));
  finish_round(run, w, cutter.last_end);
  return true;
}

// Two eight-byte lanes, and four.
GHOSTSPACE_AVX2_INLINE __m128i load8x2(const void* low, const void* high) {
  const __m128i first = _mm_loadl_epi64(static_cast<const __m128i*>(low));
  return _mm_castps_si128(_mm_loadh_pi(_mm_castsi128_ps(first), static_cast<const __m64*>(high)));
}

// The digits of four integers of up to eight characters, and where their lanes hold a minus: two that
// follow each other behind `before_a`, two behind `before_c`.
GHOSTSPACE_AVX2_INLINE Pair short_integers(const char* p, unsigned before_a, unsigned a, unsigned b, unsigned before_c,
                                           unsigned c, unsigned d) {
  const std::uint8_t* const table = kKeep.data() + 8;
  const __m256i text = _mm256_set_m128i(load8x2(p + c - 8, p + d - 8), load8x2(p + a - 8, p + b - 8));
  const __m256i keep = _mm256_set_m128i(load8x2(table + (c - before_c), table + (d - c)),
                                        load8x2(table + (a - before_a), table + (b - a)));
  return {_mm256_and_si256(_mm256_subs_epu8(text, _mm256_set1_epi8('0')), keep),
          _mm256_and_si256(_mm256_cmpeq_epi8(text, _mm256_set1_epi8('-')), keep)};
}

GHOSTSPACE_AVX2_INLINE bool read_round(NumberRun& run, std::int32_t* out) {
  const Window w = look<false>(run.next);
  if (w.ends == 0) return pass_blanks(run, w);
  const std::uint64_t whole = up_to_last(w.ends);
  if (w.faults & whole) return false;
  if (long_runs<9>(w.bodies) & whole) {
    return !(long_runs<17>(w.bodies) & whole) && read_long_integers(run, w, out);
  }
  std::uint64_t ends = w.ends;
  const unsigned e0 = pop(ends), e1 = pop(ends), e2 = pop(ends), e3 = pop(ends);
  const unsigned e4 = pop(ends), e5 = pop(ends), e6 = pop(ends), e7 = pop(ends);
  // In this order, packing brings the eight into theirs.
  const Pair a = short_integers(run.next, 0, e0, e1, e3, e4, e5);
  const Pair b = short_integers(run.next, e1, e2, e3, e5, e6, e7);
  const __m256i fours = _mm256_packus_epi32(join_to_four(a.digits), join_to_four(b.digits));
  const __m256i eights = _mm256_madd_epi16(fours, _mm256_set1_epi32(0x00012710));
  const __m256i positive = _mm256_cmpeq_epi32(_mm256_packs_epi32(a.minus, b.minus), _mm256_setzero_si256());
  const __m256i negative = _mm256_xor_si256(positive, _mm256_set1_epi32(-1));
  const __m256i values = _mm256_sub_epi32(_mm256_xor_si256(eights, negative), negative);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + run.count), values);
  finish_round(run, w, e7);
  return true;
}

GHOSTSPACE_AVX2_INLINE void fetch_ahead(const void* p) {
  __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(p) + kAhead));
}

template <class T>
GHOSTSPACE_AVX2_INLINE NumberRun read(const char* begin, const char* end, T* out, std::size_t capacity) {
  NumberRun run{begin, 0, 0, nullptr};
  const char* const guard = find_guard(begin, end);
  if (!guard) return run;
  while (end - run.next >= kWindow && capacity - run.count >= kRound) {
    fetch_ahead(run.next);
    fetch_ahead(out + run.count);
    if (run.next - begin >= kLane && read_round(run, out)) continue;
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
