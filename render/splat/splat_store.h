#pragma once

#include "qnv/base/geometry.h"
#include "render/gl/gpu.h"
#include "render/gl/range_allocator.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Splat in the vertex shader's format, 16 bytes. Bits: 3 x 20 for a position in the box of the splats, 2 x 14 for an
/// octahedral normal, 16 for a logarithmic radius (0 means invisible), 24 for a colour.
using SplatCode = std::array<std::uint32_t, 4>;
/// Cube of a splat. Bits: 16 for a logarithmic edge (0 means that it has no cube), 16 for the offset of its centre.
using CellCode = std::uint32_t;

/// Parameters that decode the codes of one geometry's splats.
struct SplatCoding {
  // Maximum distance of a cube's centre from its splat, in edge lengths.
  static constexpr float kOffsetRange = 4;
  glm::vec3 lower{0}, step{0};  // position = lower + code * step, in units of the geometry
  glm::vec2 radius{0}, edge{0};  // log2 of radius or edge: x + code * y
  float largest_radius = 0, reach = 0;  // reach: maximum distance of a point of a cube from its splat
};

/// Returns the parameters for the splats of a geometry. Returns nullopt if its arrays differ in length or no splat is
/// finite. Accepts any numbers.
[[nodiscard]] std::optional<SplatCoding> splat_coding(const qnv::Splats& splats);
/// Encodes codes.size() splats, from index `first` on.
void encode_splats(const qnv::Splats& splats, const SplatCoding& coding, std::size_t first, std::span<SplatCode> codes);
/// Encodes the cubes of codes.size() splats, from index `first` on. The splats must have cubes.
void encode_cells(const qnv::Splats& splats, const SplatCoding& coding, std::size_t first, std::span<CellCode> codes);

/// Splats in GPU memory: 16 bytes per splat, 20 with cubes. Keeps them while they have other owners. If memory is full,
/// frees those that were unused for the longest time.
///
/// The memory consists of slabs. A slab is a large buffer that thousands of clusters of a stream share, so that a cut
/// needs few calls to upload and draw. Shaders read slabs as buffer textures, indexed by splat.
class SplatStore {
 public:
  struct Slab {
    Buffer codes, cells;  // SplatCodes, and CellCodes if there are cubes
    Texture codes_texture, cells_texture;  // RGBA32UI and R32UI, one texel per splat
    RangeAllocator free;
    std::size_t discs = 0;  // splats of all geometries in the slab
  };
  /// Range of splats in a slab.
  struct Range {
    std::uint32_t slab = 0, first = 0, count = 0;
  };
  struct Entry {
    std::weak_ptr<const qnv::Splats> splats;
    std::optional<SplatCoding> coding;  // nullopt if no splat can be drawn
    std::vector<Range> ranges;  // ranges of the splats, in their order
    std::size_t discs = 0;
    bool cells = false;
    std::uint64_t used = 0;
  };

  /// Creates an empty store. It uses at most `most_bytes` of GPU memory, in slabs of about `slab_discs` splats.
  explicit SplatStore(const Gl& gl, std::size_t most_bytes = std::size_t{1} << 30,
                      std::size_t slab_discs = std::size_t{1} << 18);

  /// Uploads the splats that are not in the store. Returns false if memory does not suffice for all of them.
  bool add(std::span<const std::shared_ptr<const qnv::Splats>> sets);
  /// Returns the entry of splats. Returns null if they were not added. Valid until the next `add` or `forget_unused`.
  [[nodiscard]] const Entry* find(const qnv::Splats* splats) const;
  /// Frees splats that have no other owners. Call it once per frame.
  void forget_unused();

  [[nodiscard]] const Slab& slab(std::uint32_t number) const { return *slabs_[number]; }
  [[nodiscard]] std::size_t slabs() const { return slabs_.size(); }
  /// Returns the bytes of all stored splats. `reserved_bytes` returns those of the slabs.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t reserved_bytes() const { return reserved_bytes_; }

 private:
  struct Upload {
    const qnv::Splats* splats;
    Entry* entry;
  };
  bool place(Entry& entry);
  std::optional<Range> take(std::size_t discs, bool cells);
  bool make_slab(bool cells);
  bool make_room();
  void drop_empty_slabs();
  void give_back(const Entry& entry);
  void upload(std::span<const Upload> uploads);

  const Gl& gl_;
  std::size_t most_bytes_, slab_discs_, bytes_ = 0, reserved_bytes_ = 0;
  std::uint64_t frame_ = 0;
  std::vector<std::unique_ptr<Slab>> slabs_;  // a null slab's index can be reused
  std::unordered_map<const qnv::Splats*, Entry> entries_;
};

/// Returns the maximum number of texels of a buffer texture.
[[nodiscard]] std::size_t most_buffer_texels(const Gl& gl);

/// Returns a buffer texture of a buffer, for texelFetch.
[[nodiscard]] Texture make_buffer_texture(const Gl& gl, const Buffer& buffer, GLenum format);

}  // namespace gs::render
