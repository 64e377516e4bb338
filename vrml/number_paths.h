#pragma once

#include "vrml/number.h"

#include <cstddef>
#include <cstdint>

/// The code paths behind parse_floats and parse_integers; for those two, and for their tests. Both paths
/// give the same NumberRun and the same numbers for the same text.
namespace gs::vrml::number_paths {

/// Byte by byte; for every processor.
[[nodiscard]] NumberRun floats_portable(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun integers_portable(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

/// True where the processor has what the AVX2 path needs.
[[nodiscard]] bool has_avx2();

/// Eight numbers at a time. Call only where has_avx2(). They write nothing behind out[capacity - 1], but
/// may leave rubbish behind the last number of the run.
[[nodiscard]] NumberRun floats_avx2(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun integers_avx2(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

/// The last byte in front of `end` that cannot be part of a number, so that a loop over the characters of
/// a number that starts in front of it needs no other bound. Null when the last 128 bytes have none: such
/// a text is rubbish, and is left to the slow path.
[[nodiscard]] const char* find_guard(const char* begin, const char* end);

/// Goes on with `run` byte by byte until it has `target` numbers, comes to `guard`, or must stop.
void read_plain(NumberRun& run, const char* guard, float* out, std::size_t target);
void read_plain(NumberRun& run, const char* guard, std::int32_t* out, std::size_t target);

}  // namespace gs::vrml::number_paths
