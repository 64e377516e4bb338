#include "qnv/container/step_table.h"

#include "base/bytes.h"
#include "qnv/base/short_number.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace gs::qnv {
namespace {

// Equal distances of times are stored as the first time and the distance.
bool even(const std::vector<double>& times) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (times[i] != times[0] + static_cast<double>(i) * (times[1] - times[0])) return false;
  return true;
}

}  // namespace

std::vector<std::byte> encode_step_table(const StepTable& steps) {
  std::vector<std::byte> out;
  ByteWriter write(out);
  write.integer(static_cast<std::uint16_t>(steps.times.size()));
  const bool same = even(steps.times);
  write.integer(static_cast<std::uint8_t>(same ? 0 : 1));
  if (same) {
    write.f64(steps.times[0]);
    write.f64(steps.times[1] - steps.times[0]);
  } else {
    for (const double time : steps.times) write.f64(time);
  }
  for (const std::uint32_t count : steps.chunks) put_number(out, count);
  return out;
}

std::optional<StepTable> decode_step_table(std::span<const std::byte> section, std::size_t components) {
  constexpr std::size_t kHead = 3;
  ByteReader read(section);
  const auto count = read.integer<std::uint16_t>();
  const auto form = read.integer<std::uint8_t>();
  if (!read.good() || count < 2 || count > kMaxSteps || count * components > kMaxStepComponents || form > 1)
    return std::nullopt;
  StepTable steps;
  const std::size_t numbers = form == 0 ? 2 : count;
  if (read.left() < numbers * sizeof(double)) return std::nullopt;
  for (std::size_t i = 0; i < numbers; ++i) steps.times.push_back(read.f64());
  if (form == 0) {
    const double first = steps.times[0], distance = steps.times[1];
    steps.times.clear();
    for (std::size_t i = 0; i < count; ++i) steps.times.push_back(first + static_cast<double>(i) * distance);
  }
  if (!std::ranges::all_of(steps.times, [](double time) { return std::isfinite(time); }) ||
      std::ranges::adjacent_find(steps.times, std::greater_equal<>()) != steps.times.end())
    return std::nullopt;
  std::span<const std::byte> rest = section.subspan(kHead + numbers * sizeof(double));
  for (std::size_t i = 0; i < count * components; ++i) {
    const auto chunks = take_wide_number(rest);
    if (!chunks || *chunks > 0xffffffff) return std::nullopt;
    steps.chunks.push_back(static_cast<std::uint32_t>(*chunks));
  }
  return steps;
}

}  // namespace gs::qnv
