#pragma once

#include "app/insitu/bricks/pyramid.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

// Zarr 3 container with an OME-Zarr 0.5 image, generated in memory: its metadata, the names of its files, and the bytes
// of its chunks.
namespace gs::app::insitu {

/// Description of a grid for its metadata.
struct ZarrGrid {
  std::string field, unit;
  std::array<double, 3> origin{}, spacing{1, 1, 1};  // of level 0
};

/// File of a container: metadata of the group, metadata of a level, or a chunk.
struct ZarrName {
  std::string container;
  std::optional<std::uint32_t> level;  // nullopt for the group
  std::optional<Chunk> chunk;
};
/// Parses a path such as "heat.000120.zarr/0/c.0.1.0". Returns nullopt for other paths. Safe for untrusted texts.
[[nodiscard]] std::optional<ZarrName> parse_zarr_name(std::string_view path);

/// Returns the metadata of the group, with those of all levels.
[[nodiscard]] std::string zarr_group(const Pyramid& pyramid, const ZarrGrid& grid);
/// Returns the metadata of a level.
[[nodiscard]] std::string zarr_level(const Pyramid& pyramid, const ZarrGrid& grid, std::uint32_t level);
/// Encodes the values of a chunk, after rounding them within `error`.
[[nodiscard]] std::string encode_chunk(std::span<float> values, float error);

}  // namespace gs::app::insitu
