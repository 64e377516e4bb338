#pragma once

#include "app/insitu/bricks/pyramid.h"
#include "app/insitu/bricks/quantise.h"
#include "base/noncopyable.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Zarr 3 container with an OME-Zarr 0.5 image, generated in memory: its metadata, the names of its files, and the bytes
// of its chunks.
namespace gs::app::insitu {

/// Description of a grid for its metadata and its chunks.
struct ZarrGrid {
  std::string field, unit;
  std::array<double, 3> origin{}, spacing{1, 1, 1};  // of level 0
  CodeScale codes;     // scale of codes of 16 bits; if the step is 0, values are stored as floats
  float rounding = 0;  // maximum error of rounded floats
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

/// Encoder of chunks. Keeps its memory for the next chunk. One thread at a time.
class ChunkEncoder : NonCopyable {
 public:
  ChunkEncoder();
  ~ChunkEncoder();
  /// Function that stores the values of layers of a chunk, from the layer `first` on.
  using ReadLayers = std::function<void(std::uint32_t first, std::span<float> values)>;
  /// Encodes a chunk of this shape, in the form that zarr_level() describes. For codes, reads few layers at a time.
  [[nodiscard]] std::string encode(const GridIndex& shape, const ReadLayers& read, const ZarrGrid& grid);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  std::vector<float> values_;
  std::vector<std::int16_t> codes_;
  std::vector<std::uint8_t> shuffled_;
  std::string packed_;
};

}  // namespace gs::app::insitu
