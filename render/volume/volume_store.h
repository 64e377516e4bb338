#pragma once

#include "qnv/base/geometry.h"
#include "render/gl/gpu.h"
#include "render/gl/range_allocator.h"
#include "render/volume/volume_model.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gs::render {

/// Vector of a volume in the vertex shader's format, 16 bytes. Bits: 3 x 20 for a position in the box of the volume, 2
/// x 10 for an octahedral normal (or kNoNormal), 16 for a logarithmic weight (0 means zero), 24 for a colour, 8 for the
/// class.
using VolumeCode = std::array<std::uint32_t, 4>;

/// Parameters that decode the codes of one volume.
struct VolumeCoding {
  static constexpr std::uint32_t kLargestPosition = 0xFFFFF, kLargestNormal = 1022, kNoNormal = 1023,
                                 kLargestWeight = 0xFFFF;
  glm::vec3 lower{0}, step{0};  // position = lower + code * step, node space
  glm::vec2 weight{0};  // log2 of the weight: x + code * y
};

/// Returns the parameters for the first `count` vectors of a volume. Accepts any numbers.
[[nodiscard]] VolumeCoding volume_coding(const qnv::Volume& volume, std::size_t count);
/// Encodes codes.size() vectors, from index `first` on.
void encode_volume_codes(const qnv::Volume& volume, const VolumeCoding& coding, std::size_t first,
                         std::span<VolumeCode> codes);
/// Volume and its model, shared with other owners.
struct SharedVolume {
  std::shared_ptr<const qnv::Volume> volume;
  std::shared_ptr<const VolumeModel> model;
};

/// Vectors of volumes in GPU memory, 20 bytes each. One buffer texture holds all, so that several volumes can be drawn
/// in one order. The number of vectors of a volume is that of the spacings in its model. Keeps data while the volumes
/// have other owners. Runs on the thread of its context.
class VolumeStore {
 public:
  /// Creates an empty store that uses at most `most_bytes` of GPU memory.
  explicit VolumeStore(const Gl& gl, std::size_t most_bytes = std::size_t{1} << 30);

  struct Place {
    std::size_t first = 0;  // texel of the volume's vector 0
    VolumeCoding coding;
  };
  /// Uploads the volumes that are not in the store. Returns their locations, in order. Returns an empty list if memory
  /// does not suffice. Valid until the next call.
  std::vector<Place> place(std::span<const SharedVolume> volumes);
  /// Frees the data of volumes that have no other owners. Call it once per frame.
  void forget_unused();

  [[nodiscard]] const Texture& codes() const { return codes_; }  // texture format GL_RGBA32UI
  [[nodiscard]] const Texture& spacings() const { return spacings_; }  // texture format GL_R32F
  [[nodiscard]] std::size_t bytes() const { return capacity_ * kBytes; }

  static constexpr std::size_t kBytes = sizeof(VolumeCode) + sizeof(float);

 private:
  struct Entry {
    std::weak_ptr<const qnv::Volume> volume;
    std::weak_ptr<const VolumeModel> model;
    std::size_t first = 0, count = 0;
    VolumeCoding coding;
    std::uint64_t used = 0;
  };

  Entry* find(const SharedVolume& volume);
  Entry* add(const SharedVolume& volume);
  bool resize(std::size_t capacity);
  void upload(const qnv::Volume& volume, const Entry& entry);
  void upload_spacings(const qnv::Volume& volume, const VolumeModel& model, const Entry& entry);

  const Gl& gl_;
  std::size_t most_, capacity_ = 0;  // numbers of vectors
  std::uint64_t frame_ = 0;
  Buffer code_buffer_, spacing_buffer_;
  Texture codes_, spacings_;
  RangeAllocator free_{0};
  std::vector<Entry> entries_;
};

}  // namespace gs::render
