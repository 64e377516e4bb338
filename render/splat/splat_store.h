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

/// Splat as the vertex shader reads it, 16 bytes. Bits: 3 x 20 for coordinates in the box of the point set; 2 x 14 for
/// an octahedral normal. Then 16 for a logarithmic radius (0 means invisible) and 24 for a colour.
using SplatCode = std::array<std::uint32_t, 4>;
/// Cube of a splat: a logarithmic edge of 16 bits (0 means none), and the offset of its centre, 16 bits.
using CellCode = std::uint32_t;

/// Decoding parameters of one point set's codes.
struct SplatCoding {
  // Maximum distance of a cube's centre from its splat, in edges.
  static constexpr float kOffsetRange = 4;
  glm::vec3 lower{0}, step{0};          // position = lower + code * step; units of the point set
  glm::vec2 radius{0}, edge{0};         // log2 of the value = x + code * y
  float largest_radius = 0, reach = 0;  // reach: of the largest cube from its splat
};

/// Returns nullopt if nothing of the point set can be drawn: its arrays differ in length, or no splat is finite.
/// Accepts any numbers.
[[nodiscard]] std::optional<SplatCoding> splat_coding(const qnv::Splats& splats);
/// Encodes codes.size() splats from index `first`.
void encode_splats(const qnv::Splats& splats, const SplatCoding& coding, std::size_t first, std::span<SplatCode> codes);
/// Encodes the cubes of these splats; the point set must have cubes.
void encode_cells(const qnv::Splats& splats, const SplatCoding& coding, std::size_t first, std::span<CellCode> codes);

/// Caches point sets in GPU memory, 16 bytes per splat, 20 with cubes, while other owners hold them. The least recently
/// drawn point sets make room for others.
///
/// Slabs are large buffers that thousands of clusters of a stream share. A cut thus needs few calls to upload and draw.
/// Shaders read slabs as buffer textures, indexed by splat.
class SplatStore {
 public:
  struct Slab {
    Buffer codes, cells;                   // SplatCodes; CellCodes, or none
    Texture codes_texture, cells_texture;  // RGBA32UI and R32UI, one texel per splat
    RangeAllocator free;
    std::size_t discs = 0;  // of all point sets
  };
  /// Consecutive splats in a slab.
  struct Range {
    std::uint32_t slab = 0, first = 0, count = 0;
  };
  struct Entry {
    std::weak_ptr<const qnv::Splats> splats;
    std::optional<SplatCoding> coding;  // nullopt if nothing of it can be drawn
    std::vector<Range> ranges;          // in the order of the splats
    std::size_t discs = 0;
    bool cells = false;
    std::uint64_t used = 0;
  };

  /// `most_bytes` limits GPU memory, which is allocated in slabs of about `slab_discs` splats.
  explicit SplatStore(const Gl& gl, std::size_t most_bytes = std::size_t{1} << 30,
                      std::size_t slab_discs = std::size_t{1} << 18);

  /// Uploads point sets that are not yet cached. Returns false if memory does not suffice for all.
  bool add(std::span<const std::shared_ptr<const qnv::Splats>> sets);
  /// Returns the location of a point set; null if it was not added. Valid until the next `add` or `forget_unused`.
  [[nodiscard]] const Entry* find(const qnv::Splats* splats) const;
  /// Frees copies of point sets without other owners; call it once per frame.
  void forget_unused();

  [[nodiscard]] const Slab& slab(std::uint32_t number) const { return *slabs_[number]; }
  [[nodiscard]] std::size_t slabs() const { return slabs_.size(); }
  /// Return the bytes of all cached splats, and of the slabs that hold them.
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
  std::vector<std::unique_ptr<Slab>> slabs_;  // null means a reusable number
  std::unordered_map<const qnv::Splats*, Entry> entries_;
};

/// Returns the maximum number of texels of a buffer texture.
[[nodiscard]] std::size_t most_buffer_texels(const Gl& gl);

/// Returns a buffer texture for texelFetch.
[[nodiscard]] Texture make_buffer_texture(const Gl& gl, const Buffer& buffer, GLenum format);

}  // namespace gs::render
