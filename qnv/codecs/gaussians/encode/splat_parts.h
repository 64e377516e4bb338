#pragma once

#include "qnv/codecs/gaussians/encode/chunk_store.h"
#include "qnv/codecs/shared/gaussian_source.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::gaussians {

/// Division of space into boxes with similar numbers of splats: a k-d tree of axis-aligned planes.
class SpaceCells {
 public:
  /// Divides space until each box has at most `most` of the positions, unless too many coincide along an axis.
  SpaceCells(std::vector<glm::vec3> positions, std::size_t most);

  [[nodiscard]] std::size_t size() const { return cells_; }
  [[nodiscard]] std::size_t cell_of(const glm::vec3& position) const;

 private:
  struct Plane {
    int axis = -1;  // -1 for a cell
    float at = 0;
    std::uint32_t below = 0, above = 0;  // indices of planes; for a cell, `below` is its number
  };
  std::uint32_t divide(std::span<glm::vec3> positions, std::size_t most);

  std::vector<Plane> planes_;
  std::size_t cells_ = 0;
};

/// Splats of one part of a scene, in a store.
struct StoredPart {
  struct Block {
    std::uint64_t offset = 0;
    std::uint32_t splats = 0;
  };
  std::vector<Block> blocks;
  std::size_t splats = 0;
};

/// Splats of one cell, consecutive in a store.
struct CellBlock {
  std::uint64_t offset = 0;
  std::uint32_t cell = 0, splats = 0;
};

/// Writer of splats to a store, by cells. One thread.
class PartWriter {
 public:
  PartWriter(const SpaceCells& cells, int degree, SharedStore& store);

  /// Adds splats. Returns false if the store is full.
  [[nodiscard]] bool add(const Gaussians& splats);
  /// Returns all blocks. The blocks of a cell are in the order of its splats. Returns nullopt if the store is full.
  [[nodiscard]] std::optional<std::vector<CellBlock>> finish();

 private:
  bool flush(std::size_t cell);

  const SpaceCells& cells_;
  std::size_t per_;  // coefficients of a splat
  SharedStore& store_;
  std::vector<std::vector<float>> open_;  // one per cell
  std::vector<CellBlock> done_;
};

/// Returns the parts of a scene, in the order of the cells. A part has the splats of one cell, at most `most`; a cell
/// with more splats has several parts. Parts depend only on the order of the splats of each cell.
[[nodiscard]] std::vector<StoredPart> parts_of(std::vector<CellBlock> blocks, int degree, std::size_t most);

/// Reads the splats of a part with their box. Returns nullopt if the store cannot be read.
[[nodiscard]] std::optional<Gaussians> read_part(const StoredPart& part, int degree, const SharedStore& store);

}  // namespace gs::qnv::gaussians
