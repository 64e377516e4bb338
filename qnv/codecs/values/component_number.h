#pragma once

#include "qnv/base/short_number.h"
#include "qnv/codecs/values/block_places.h"
#include "qnv/codecs/values/cube_runs.h"
#include "qnv/container/container.h"

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

/// Returns the numbers of one component.
[[nodiscard]] inline ComponentCounts component_counts(const ValueGrid& grid) {
  const Extent extent = grid.dimensions, cubes = cube_extent(extent);
  return {BlockLayout(extent, level_count(extent)).count(), std::uint64_t{cubes[0]} * cubes[1] * cubes[2]};
}

/// Returns the header of a stream that has only one component and one step.
[[nodiscard]] inline StreamHeader header_of_component(const StreamHeader& header, std::size_t component) {
  StreamHeader one = header;
  if (component > 0) one.grid = header.more_grids[component - 1];
  one.grid.components = 1;
  one.grid.colors = one.grid.luma = false;
  one.more_grids.clear();
  one.steps = {};
  return one;
}

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
