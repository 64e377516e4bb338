#pragma once

#include "render/gl/gpu.h"
#include "render/scene/volume_look.h"
#include "render/volume_rendering/voxel_fields.h"

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>

namespace gs::render {

/// GPU textures of the volumes, normals and tables of VolumeLooks. Kept while their images have other owners.
class VoxelTextures {
 public:
  explicit VoxelTextures(const Gl& gl);

  /// Volume with its values; gradients are made at first use.
  struct Volume {
    std::weak_ptr<const Image> image;
    std::uint64_t version = 0;
    std::array<std::uint32_t, 3> size{};
    Texture values, gradients;
    VoxelRanges ranges;
  };
  /// Returns the volume of an image, uploaded if necessary. Its size is 0 if the image is not complete. With
  /// `gradients`, also makes these.
  [[nodiscard]] Volume& volume(const std::shared_ptr<const Image>& image, bool gradients);
  /// Returns the texture of a table in two or three dimensions, as RGBA. Returns 0 if the image is not complete.
  [[nodiscard]] GLuint table(const std::shared_ptr<const Image>& image);
  /// Returns a volume with a byte per block, without interpolation.
  [[nodiscard]] Texture block_texture(const std::vector<std::uint8_t>& blocks,
                                      const std::array<std::uint32_t, 3>& size) const;
  void forget_unused();

 private:
  struct Table {
    std::weak_ptr<const Image> image;
    std::uint64_t version = 0;
    Texture texture;
  };
  Texture upload(const std::vector<std::uint8_t>& voxels, const std::array<std::uint32_t, 3>& size,
                 std::uint32_t components) const;

  const Gl& gl_;
  std::uint32_t most_side_;
  std::unordered_map<const Image*, Volume> volumes_;
  std::unordered_map<const Image*, Table> tables_;
};

}  // namespace gs::render
