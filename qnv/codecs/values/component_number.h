#pragma once

#include "qnv/base/short_number.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::values {

// Payloads of a stream with several components. The first number of a payload, which is a block or a cube, counts those
// of all components. FORMAT.md, "Components".

/// Numbers of blocks and of cubes of one component.
struct ComponentCounts {
  std::uint64_t blocks = 0, cubes = 0;
};

/// Payload of one component.
struct ComponentPayload {
  std::size_t component = 0;
  std::vector<std::byte> payload;  // with the number in its component
};

/// Returns the payload of the first component as that of another one. `count` is the number of blocks or cubes.
[[nodiscard]] inline std::vector<std::byte> with_component(std::span<const std::byte> payload, std::size_t component,
                                                           std::uint64_t count) {
  const std::uint64_t number = take_wide_number(payload).value_or(0);
  std::vector<std::byte> out;
  put_number(out, number + component * count);
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}

/// Splits the component off. Returns nullopt if the number is truncated. Safe for untrusted bytes.
[[nodiscard]] inline std::optional<ComponentPayload> without_component(std::span<const std::byte> payload,
                                                                       std::uint64_t count) {
  const auto number = take_wide_number(payload);
  if (!number || count == 0) return std::nullopt;
  ComponentPayload out;
  out.component = static_cast<std::size_t>(*number / count);
  put_number(out.payload, *number % count);
  out.payload.insert(out.payload.end(), payload.begin(), payload.end());
  return out;
}

}  // namespace gs::qnv::values
