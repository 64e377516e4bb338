#pragma once

#include "qnv/base/cloud.h"
#include "qnv/records/record.h"
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

/// A disc as the vertex shader reads it, 16 bytes: coordinates of 20 bits in the box of the cloud, an octahedral normal
/// of 2 x 14, a logarithmic radius of 16 and a colour of 24. 0 for the radius: nothing is drawn.
using SplatCode = std::array<std::uint32_t, 4>;
/// The cube of a disc: a logarithmic edge of 16 bits (0: none), and how far the centre lies off, of 16.
using CellCode = std::uint32_t;

/// What the codes of one cloud mean.
struct SplatCoding {
  // How far a cube's centre may lie from its disc, in edges.
  static constexpr float kOffsetRange = 4;
  glm::vec3 lower{0}, step{0};          // position = lower + code * step; units of the cloud
  glm::vec2 radius{0}, edge{0};         // log2 of the value = x + code * y
  float largest_radius = 0, reach = 0;  // reach: of the largest cube from its disc
};

/// Empty when nothing of the cloud can be drawn: its arrays differ in length, or no disc is finite. Safe for clouds
/// with any numbers in them.
[[nodiscard]] std::optional<SplatCoding> splat_coding(const qnv::Cloud& cloud);
/// Encodes discs `first` and following, as many as `codes` holds.
void encode_splats(const qnv::Cloud& cloud, const SplatCoding& coding, std::size_t first, std::span<SplatCode> codes);
/// Likewise their cubes; the cloud must have some.
void encode_cells(const qnv::Cloud& cloud, const SplatCoding& coding, std::size_t first, std::span<CellCode> codes);

/// Keeps clouds in the memory of the GPU: 16 bytes a disc, 20 with cubes. As long as somebody else holds them, and
/// those that were drawn longest ago make room for others.
///
/// They lie in slabs, large buffers that thousands of clusters of a stream share, so that a cut is uploaded and drawn
/// with a few calls. Shaders read slabs as buffer textures, disc by number.
class SplatStore {
 public:
  struct Slab {
    Buffer codes, cells;                   // SplatCodes; CellCodes, or none
    Texture codes_texture, cells_texture;  // RGBA32UI and R32UI, a texel a disc
    RangeAllocator free;
    std::size_t discs = 0;  // of all clouds
  };
  /// Discs that lie side by side in a slab.
  struct Range {
    std::uint32_t slab = 0, first = 0, count = 0;
  };
  struct Entry {
    std::weak_ptr<const qnv::Cloud> cloud;
    std::optional<SplatCoding> coding;  // none: nothing of it can be drawn
    std::vector<Range> ranges;          // in the order of the discs
    std::size_t discs = 0;
    bool cells = false;
    std::uint64_t used = 0;
  };

  /// `most_bytes`: of the memory of the GPU that is taken, in slabs of about `slab_discs`.
  explicit SplatStore(const Gl& gl, std::size_t most_bytes = std::size_t{1} << 30,
                      std::size_t slab_discs = std::size_t{1} << 18);

  /// Uploads what is not there yet. False when there is no memory for all of it.
  bool add(std::span<const std::shared_ptr<const qnv::Cloud>> clouds);
  /// Where a cloud lies; null when it was not added. Valid until the next call of `add` or `forget_unused`.
  [[nodiscard]] const Entry* find(const qnv::Cloud* cloud) const;
  /// To be called once a frame. Frees the copies of clouds that nobody holds any more.
  void forget_unused();

  [[nodiscard]] const Slab& slab(std::uint32_t number) const { return *slabs_[number]; }
  [[nodiscard]] std::size_t slabs() const { return slabs_.size(); }
  /// Of all discs that are there, and of the slabs that hold them.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::size_t reserved_bytes() const { return reserved_bytes_; }

 private:
  struct Upload {
    const qnv::Cloud* cloud;
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
  std::vector<std::unique_ptr<Slab>> slabs_;  // null: a number to be used again
  std::unordered_map<const qnv::Cloud*, Entry> entries_;
};

/// Chunks of 8-byte records in the memory of the GPU, as they came off the wire; the vertex shader unpacks them.
class SplatRecords {
 public:
  struct Chunk {
    Buffer buffer;
    Texture texture;  // RG32UI, a texel a record
    std::size_t records = 0;
    qnv::RecordFrame frame;
    std::shared_ptr<const qnv::Cloud> sample;  // some of the vectors, to tell how large they are
  };

  /// `palette`: colours by index, up to 256; those that are missing are qnv::Rgb8{}.
  SplatRecords(const Gl& gl, std::span<const qnv::Rgb8> palette, bool two_sided);

  /// Uploads records.size() / 8 records as they are, in one chunk or in several of the same frame. False when the frame
  /// is not valid() or there is no memory.
  bool add(std::span<const std::byte> records, const qnv::RecordFrame& frame);

  [[nodiscard]] const std::vector<Chunk>& chunks() const { return chunks_; }
  [[nodiscard]] const Texture& palette() const { return palette_; }
  [[nodiscard]] bool two_sided() const { return two_sided_; }
  [[nodiscard]] bool colored() const { return colored_; }

 private:
  bool add_chunk(std::span<const std::byte> records, const qnv::RecordFrame& frame);

  const Gl& gl_;
  Texture palette_;
  bool two_sided_, colored_;
  std::vector<Chunk> chunks_;
};

/// How many texels of a buffer a shader can read.
[[nodiscard]] std::size_t most_buffer_texels(const Gl& gl);

/// A view of a buffer for texelFetch.
[[nodiscard]] Texture make_buffer_texture(const Gl& gl, const Buffer& buffer, GLenum format);

/// The normals of all codes, 32 x 64 (theta, phi), so that the vertex shader has the very ones of qnv::normal_of.
[[nodiscard]] Texture make_normal_table(const Gl& gl);

}  // namespace gs::render
