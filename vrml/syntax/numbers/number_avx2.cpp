#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "vrml/syntax/numbers/number_paths.h"

#if defined(__x86_64__)

#include "vrml/syntax/numbers/number_avx2.h"

namespace gs::vrml::number_paths {
namespace {

// Each round examines the 64 bytes after the last number. Vector compares turn these bytes into bit masks. A few
// operations on the masks give the start, the decimal point and the end of each number. Thus no number waits for the
// previous one. Up to kRound complete numbers of the window are converted at once. Each number has a separate lane of
// bytes, with its last digit in the last byte. Windows with exponents or long numbers take a longer path. read_number
// repeats numbers with uncertain rounding. read_plain handles windows with text that is not a number.
constexpr std::ptrdiff_t kWindow = 64;
constexpr std::size_t kRound = 8;
constexpr std::ptrdiff_t kLane = 16;  // maximum number of bytes that a lane reaches before the window

// Converts integers below 2^52 to doubles: their bits are the lowest bits of the double 2^52 + integer.
GHOSTSPACE_AVX2_INLINE __m256d doubles_of(__m256i integers) {
  const __m256i magic = _mm256_set1_epi64x(0x4330000000000000);
  return _mm256_sub_pd(_mm256_castsi256_pd(_mm256_or_si256(integers, magic)), _mm256_castsi256_pd(magic));
}
GHOSTSPACE_AVX2_INLINE __m256i too_large(__m256i integers) {
  return _mm256_cmpgt_epi64(integers, _mm256_set1_epi64x((std::int64_t{1} << 52) - 1));
}
// Returns the lowest mantissa bits of doubles, which floats drop.
GHOSTSPACE_AVX2_INLINE __m256i rest_of(__m256d doubles) {
  return _mm256_and_si256(_mm256_castpd_si256(doubles), _mm256_set1_epi64x(0x1fffffff));
}
constexpr std::int64_t kMiddle = 0x10000000;
GHOSTSPACE_AVX2_INLINE __m128 signed_floats(__m256d magnitudes, __m256i positive) {
  const __m256d signs = _mm256_andnot_pd(_mm256_castsi256_pd(positive), _mm256_set1_pd(-0.0));
  return _mm256_cvtpd_ps(_mm256_xor_pd(magnitudes, signs));
}

// Reads four floats. Sets a bit of `doubtful` for each float with an uncertain rounding or mantissa.
GHOSTSPACE_AVX2_INLINE __m128 four_floats(Cutter& cutter, unsigned& doubtful) {
  const Four four = cut_four(cutter);
  const __m256d powers = _mm256_setr_pd(kPoints[four.cuts[0].point].power, kPoints[four.cuts[1].point].power,
                                        kPoints[four.cuts[2].point].power, kPoints[four.cuts[3].point].power);
  const __m256d quotients = _mm256_div_pd(doubles_of(four.mantissas), powers);
  // Integer and power are exact, and the quotient is correctly rounded. Therefore a second rounding can be wrong only
  // for a quotient exactly between two floats. No value is small enough to be a denormal float.
  const __m256i middle = _mm256_cmpeq_epi64(rest_of(quotients), _mm256_set1_epi64x(kMiddle));
  doubtful = bits_of(_mm256_or_si256(middle, too_large(four.mantissas)));
  return signed_floats(quotients, four.positive);
}

// Reads four integers of up to 16 characters. Sets a bit of `doubtful` for each integer that does not fit into 32 bits.
GHOSTSPACE_AVX2_INLINE __m128i four_integers(Cutter& cutter, unsigned& doubtful) {
  const Four four = cut_four(cutter);
  const __m256i negative = _mm256_xor_si256(four.positive, _mm256_set1_epi64x(-1));
  const __m256i values = _mm256_sub_epi64(_mm256_xor_si256(four.mantissas, negative), negative);
  const __m256i shifted = _mm256_add_epi64(values, _mm256_set1_epi64x(std::int64_t{1} << 31));
  const __m256i fits = _mm256_cmpeq_epi64(_mm256_srli_epi64(shifted, 32), _mm256_setzero_si256());
  doubtful = bits_of(fits) ^ 0xfu;
  const __m256i low_halves = _mm256_permutevar8x32_epi32(values, _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6));
  return _mm256_castsi256_si128(low_halves);
}

// Moves `run` forward by `count` numbers and `size` bytes of the window.
GHOSTSPACE_AVX2_INLINE void pass(NumberRun& run, const Window& w, std::size_t count, unsigned size) {
  const std::uint64_t feeds = _bzhi_u64(w.feeds, size);
  run.line_start = feeds ? run.next + 64 - __builtin_clzll(feeds) : run.line_start;
  run.lines += static_cast<std::size_t>(_mm_popcnt_u64(feeds));
  run.next += size;
  run.count += count;
}

// Returns the number of numbers that a round converts.
GHOSTSPACE_AVX2_INLINE unsigned round_size(const Window& w) {
  return std::min(static_cast<unsigned>(_mm_popcnt_u64(w.ends)), static_cast<unsigned>(kRound));
}

// Ends a round. `last_end` is the end of the eighth number, or 64 if there are fewer numbers.
GHOSTSPACE_AVX2_INLINE void finish_round(NumberRun& run, const Window& w, unsigned last_end) {
  pass(run, w, round_size(w), std::min(last_end, 63u - static_cast<unsigned>(__builtin_clzll(w.ends))));
}

// Returns a mask of all bits up to the highest bit of `mask`, which must not be 0.
GHOSTSPACE_AVX2_INLINE std::uint64_t up_to_last(std::uint64_t mask) {
  return ~std::uint64_t{0} >> static_cast<unsigned>(__builtin_clzll(mask));
}

// Skips a window in which no number ends. Returns false if it contains other bytes than separators.
GHOSTSPACE_AVX2_INLINE bool pass_blanks(NumberRun& run, const Window& w) {
  if (w.bodies) return false;
  pass(run, w, 0, kWindow - 1);  // leaves one byte: it may be the guard, where read_plain stops
  return true;
}

// Reads the numbers that `doubtful` marks again. Returns false if one of them is not a number.
GHOSTSPACE_AVX2 bool read_again(const char* p, const Window& w, unsigned doubtful, float* out) {
  for (; doubtful; doubtful = _blsr_u32(doubtful)) {
    const unsigned index = _tzcnt_u32(doubtful);
    const char* number = p + _tzcnt_u64(_pdep_u64(std::uint64_t{1} << index, w.starts));
    if (!read_number(number, out[index])) return false;
  }
  return true;
}

// Window with exponents or long numbers. It is cut at the ends of the digits to read.
struct LongCutter {
  const char* p;
  std::uint64_t starts;
  std::uint64_t wholes;
  std::uint64_t ends;  // ends of the mantissa parts to read, at most 16 bytes each
  std::uint64_t marks;  // ends of the mantissas: an `e`, or the end of the number
  std::uint64_t longs;  // starts of numbers with further digits that are not read
};
GHOSTSPACE_AVX2_INLINE Cut cut(LongCutter& cutter) {
  const unsigned end = pop(cutter.ends);
  return {end, end - pop(cutter.starts), end - pop(cutter.wholes)};
}

// Applies the rules of look(); an `e` counts as an end and as a start. Returns false if a body in `whole` is not a
// number.
GHOSTSPACE_AVX2_INLINE bool cut_long(const char* p, const Window& w, std::uint64_t whole, LongCutter& cutter) {
  const __m256i bit = _mm256_set1_epi8(0x20);
  const __m256i low = _mm256_or_si256(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)), bit);
  const __m256i high = _mm256_or_si256(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p + 32)), bit);
  const std::uint64_t marks = equal_mask(low, high, 'e');
  const std::uint64_t bodies = w.bodies & ~marks;
  const std::uint64_t runs = bodies & ~w.dots;
  const std::uint64_t starts = bodies & ~(bodies << 1);
  const std::uint64_t exponents = starts & (marks << 1);
  const std::uint64_t wholes = first_behind(runs, starts);
  const std::uint64_t faults = (w.others & ~marks) | faults_of(w.signs, w.dots, starts, wholes, ~bodies) |
                               (marks & (w.starts | ~bodies >> 1)) | (exponents & long_runs<9>(bodies));
  // An exponent extends to the end of the number and has no decimal point.
  const std::uint64_t exponent_ends = first_behind(runs, exponents);
  const std::uint64_t longs = w.starts & whole & long_runs<17>(bodies);
  if ((faults | (exponent_ends & (marks | w.dots)) | (longs & long_runs<17>(runs))) & whole) return false;
  const std::uint64_t mantissas = w.starts & whole;
  cutter.p = p;
  cutter.starts = mantissas;
  cutter.wholes = first_behind(runs, mantissas);
  cutter.marks = first_behind(bodies, mantissas);
  cutter.ends = (cutter.marks & ~first_behind(bodies, longs)) | longs << 16;
  cutter.longs = longs;
  return true;
}

// Uses plain loads, because a gather instruction is slow on many processors.
GHOSTSPACE_AVX2_INLINE __m256d powers_at(__m128i exponents) {
  alignas(16) std::uint32_t at[4];
  _mm_store_si128(reinterpret_cast<__m128i*>(at), exponents);
  return _mm256_setr_pd(kPowersOfTen[at[0]], kPowersOfTen[at[1]], kPowersOfTen[at[2]], kPowersOfTen[at[3]]);
}

// Reads four floats with exponents, like four_floats(). `cut_off` marks numbers with digits that were not read; their
// values are slightly larger.
GHOSTSPACE_AVX2_INLINE __m128 four_long_floats(const Four& four, __m128i exponents, unsigned cut_off,
                                               unsigned& doubtful) {
  constexpr int last = static_cast<int>(kPowersOfTen.size()) - 1;
  constexpr std::int64_t enough = std::int64_t{1} << 40;  // limits the error of the quotient to 2^13 units
  constexpr std::int64_t margin = 1 << 14;
  const __m128i zero = _mm_setzero_si128();
  const __m128i places = _mm_setr_epi32(static_cast<int>(four.cuts[0].point), static_cast<int>(four.cuts[1].point),
                                        static_cast<int>(four.cuts[2].point), static_cast<int>(four.cuts[3].point));
  const __m128i shift = _mm_sub_epi32(exponents, _mm_max_epi32(_mm_sub_epi32(places, _mm_set1_epi32(1)), zero));
  const __m128i most = _mm_set1_epi32(last);
  const __m128i up = _mm_min_epi32(_mm_max_epi32(shift, zero), most);
  const __m128i down = _mm_min_epi32(_mm_max_epi32(_mm_sub_epi32(zero, shift), zero), most);
  const __m128i far = _mm_cmpgt_epi32(_mm_abs_epi32(shift), most);
  const __m256d products = _mm256_mul_pd(doubles_of(four.mantissas), powers_at(up));
  const __m256d quotients = _mm256_div_pd(products, powers_at(down));
  const __m256i off = _mm256_sub_epi64(rest_of(quotients), _mm256_set1_epi64x(kMiddle));
  const __m256i near = _mm256_and_si256(_mm256_cmpgt_epi64(off, _mm256_set1_epi64x(-margin)),
                                        _mm256_cmpgt_epi64(_mm256_set1_epi64x(margin), off));
  const unsigned few = bits_of(_mm256_cmpgt_epi64(_mm256_set1_epi64x(enough), four.mantissas)) & cut_off;
  doubtful = bits_of(_mm256_or_si256(near, too_large(four.mantissas))) | few |
             static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(far)));
  return signed_floats(quotients, four.positive);
}

GHOSTSPACE_AVX2 bool read_long_floats(NumberRun& run, const Window& w, std::uint64_t whole, float* out) {
  LongCutter cutter;
  if (!cut_long(run.next, w, whole, cutter)) return false;
  std::uint64_t ends = w.ends;
  ShortCut cuts[8];
  for (ShortCut& c : cuts) {
    c.end = pop(ends);
    const unsigned length = c.end - pop(cutter.marks);  // length of the exponent, including its `e`
    c.keep = std::max(length, 1u) - 1;
  }
  const __m256i exponents = eight_integers(run.next, cuts);
  const auto cut_off = static_cast<unsigned>(_pext_u64(cutter.longs, cutter.starts));
  unsigned doubtful[2] = {};
  const unsigned count = round_size(w);
  _mm_storeu_ps(out + run.count,
                four_long_floats(cut_four(cutter), _mm256_castsi256_si128(exponents), cut_off, doubtful[0]));
  if (count > 4) {
    _mm_storeu_ps(out + run.count + 4, four_long_floats(cut_four(cutter), _mm256_extracti128_si256(exponents, 1),
                                                        cut_off >> 4, doubtful[1]));
  }
  const unsigned again = _bzhi_u32(doubtful[0] | doubtful[1] << 4, count);
  if (again && !read_again(run.next, w, again, out + run.count)) return false;
  finish_round(run, w, cuts[7].end);
  return true;
}

// Reads one round. Returns false and changes nothing if the window needs read_plain.
GHOSTSPACE_AVX2_INLINE bool read_round(NumberRun& run, float* out) {
  const Window w = look<true>(run.next);
  if (w.ends == 0) return pass_blanks(run, w);
  const std::uint64_t whole = up_to_last(w.ends);
  if ((w.faults | long_runs<17>(w.bodies)) & whole) return read_long_floats(run, w, whole, out);
  Cutter cutter{run.next, w.wholes & whole, w.ends};
  unsigned doubtful[2];
  const __m128 first = four_floats(cutter, doubtful[0]);
  const __m128 second = four_floats(cutter, doubtful[1]);
  _mm_storeu_ps(out + run.count, first);
  _mm_storeu_ps(out + run.count + 4, second);
  const unsigned again = _bzhi_u32(doubtful[0] | doubtful[1] << 4, round_size(w));
  if (again && !read_again(run.next, w, again, out + run.count)) return false;
  finish_round(run, w, cutter.last_end);
  return true;
}

// Reads a round with integers of up to 16 characters.
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

GHOSTSPACE_AVX2_INLINE bool read_round(NumberRun& run, std::int32_t* out) {
  const Window w = look<false>(run.next);
  if (w.ends == 0) return pass_blanks(run, w);
  const std::uint64_t whole = up_to_last(w.ends);
  if (w.faults & whole) return false;
  if (long_runs<9>(w.bodies) & whole) {
    return !(long_runs<17>(w.bodies) & whole) && read_long_integers(run, w, out);
  }
  std::uint64_t ends = w.ends;
  ShortCut cuts[8];
  unsigned last_end = 0;
  for (ShortCut& c : cuts) {
    c.end = pop(ends);
    c.keep = c.end - last_end;
    last_end = c.end;
  }
  const __m256i values = eight_integers(run.next, cuts);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + run.count), values);
  finish_round(run, w, last_end);
  return true;
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
