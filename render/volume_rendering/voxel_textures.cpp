#include "render/volume_rendering/voxel_textures.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gs::render {
namespace {

void set_sampling(const Gl& gl, GLenum target, GLint filter) {
  for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) gl.TexParameteri(target, name, filter);
  for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    gl.TexParameteri(target, name, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
}

/// Returns pixels as RGBA. Intensities become grey; without alpha, alpha is 255 (X3D Table 41.2).
std::vector<std::uint8_t> rgba_of(const std::vector<std::uint8_t>& pixels, std::uint32_t components) {
  std::vector<std::uint8_t> result(pixels.size() / components * 4);
  std::uint8_t* to = result.data();
  for (std::size_t i = 0; i + components <= pixels.size(); i += components, to += 4) {
    const std::uint8_t* from = pixels.data() + i;
    const bool grey = components < 3;
    to[0] = from[0];
    to[1] = grey ? from[0] : from[1];
    to[2] = grey ? from[0] : from[2];
    to[3] = components % 2 == 0 ? from[components - 1] : 255;
  }
  return result;
}

}  // namespace

VoxelTextures::VoxelTextures(const Gl& gl) : gl_(gl) {
  GLint most = 0;
  gl.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  most_side_ = static_cast<std::uint32_t>(std::max(most, 256));
}

Texture VoxelTextures::upload(const std::vector<std::uint8_t>& voxels, const std::array<std::uint32_t, 3>& size,
                              std::uint32_t components) const {
  static constexpr GLenum kFormats[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
  static constexpr GLint kInternal[] = {GL_R8, GL_RG8, GL_RGB8, GL_RGBA8};
  const PhaseScope phase(gl_.phases, Phase::upload);
  Texture texture = make_texture(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_3D, texture.name());
  set_sampling(gl_, GL_TEXTURE_3D, GL_LINEAR);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.TexImage3D(GL_TEXTURE_3D, 0, kInternal[components - 1], static_cast<GLsizei>(size[0]),
                 static_cast<GLsizei>(size[1]), static_cast<GLsizei>(size[2]), 0, kFormats[components - 1],
                 GL_UNSIGNED_BYTE, voxels.data());
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  return texture;
}

VoxelTextures::Volume& VoxelTextures::volume(const std::shared_ptr<const Image>& image, bool gradients) {
  Volume& entry = volumes_[image.get()];
  const bool fresh = entry.image.expired() || entry.version != image->version;
  if (fresh) {
    entry = {};
    entry.image = image;
    entry.version = image->version;
  }
  if (voxel_counts(*image)[0] == 0 || image->pixels.empty()) return entry;
  if (!fresh && (entry.gradients || !gradients)) return entry;
  const std::vector<std::uint8_t> voxels = upright_voxels(*image, most_side_, entry.size);
  if (fresh) {
    entry.values = upload(voxels, entry.size, image->components);
    entry.ranges = voxel_ranges(voxels, entry.size, image->components);
  }
  if (gradients) entry.gradients = upload(voxel_gradients(voxels, entry.size, image->components), entry.size, 4);
  return entry;
}

GLuint VoxelTextures::table(const std::shared_ptr<const Image>& image) {
  Table& entry = tables_[image.get()];
  if (!entry.image.expired() && entry.version == image->version) return entry.texture.name();
  entry = {};
  entry.image = image;
  entry.version = image->version;
  if (voxel_counts(*image)[0] == 0 || image->pixels.empty()) return 0;
  std::array<std::uint32_t, 3> size{};
  const bool flat = image->slices == 1;
  const std::uint32_t most = flat ? static_cast<std::uint32_t>(gl_.max_texture_size) : most_side_;
  const std::vector<std::uint8_t> rgba = rgba_of(upright_voxels(*image, most, size), image->components);
  if (!flat) {
    entry.texture = upload(rgba, size, 4);
    return entry.texture.name();
  }
  entry.texture = make_texture(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, entry.texture.name());
  set_sampling(gl_, GL_TEXTURE_2D, GL_LINEAR);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(size[0]), static_cast<GLsizei>(size[1]), 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, rgba.data());
  return entry.texture.name();
}

Texture VoxelTextures::block_texture(const std::vector<std::uint8_t>& blocks,
                                     const std::array<std::uint32_t, 3>& size) const {
  Texture texture = upload(blocks, size, 1);
  set_sampling(gl_, GL_TEXTURE_3D, GL_NEAREST);
  return texture;
}

void VoxelTextures::forget_unused() {
  std::erase_if(volumes_, [](const auto& entry) { return entry.second.image.expired(); });
  std::erase_if(tables_, [](const auto& entry) { return entry.second.image.expired(); });
}

}  // namespace gs::render
