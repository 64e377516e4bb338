#include "render/gl/layer_textures.h"

#include "render/scene/render_list.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace gs::render {
namespace {

using Alpha = TextureStore::Alpha;
using Kind = TextureLayer::Kind;

/// Faces of a cube in the order of OpenGL, as Background::Face. The shader mirrors z, because OpenGL's cubes are
/// left-handed.
constexpr std::array<std::size_t, 6> kCubeFaces = {Background::right,  Background::left,  Background::top,
                                                   Background::bottom, Background::front, Background::back};

bool is_complete(const Image& image) {
  return image.width > 0 && image.height > 0 && image.components >= 1 && image.components <= 4 && image.slices > 0 &&
         image.height % image.slices == 0 &&
         image.pixels.size() == std::size_t{image.width} * image.height * image.components;
}

/// Returns the pixel as RGBA.
std::array<std::uint8_t, 4> rgba_at(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = image.pixels.data() + (std::size_t{y} * image.width + x) * image.components;
  switch (image.components) {
    case 1:
      return {p[0], p[0], p[0], 255};
    case 2:
      return {p[0], p[0], p[0], p[1]};
    case 3:
      return {p[0], p[1], p[2], 255};
    default:
      return {p[0], p[1], p[2], p[3]};
  }
}

/// Part of an image that is one face of a cube, in pixels.
struct Region {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

/// Returns the region of a face, an index of OpenGL. An image that is a whole cube is a strip of faces (Image::cube),
/// or a cross of 4 x 3 faces: left, front, right and back in the second row, top and bottom above and below the front.
Region region_of(const Image& image, std::size_t face, bool whole) {
  if (image.cube && image.slices == 6) {
    const std::uint32_t rows = image.height / 6;
    return {0, static_cast<std::uint32_t>(face) * rows, image.width, rows};
  }
  const std::uint32_t side = image.width / 4;
  if (!whole || side == 0 || image.height / 3 != side) return {0, 0, image.width, image.height};
  static constexpr std::array<std::array<std::uint32_t, 2>, 6> kCross = {
      {{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}};
  return {kCross[face][0] * side, kCross[face][1] * side, side, side};
}

/// Returns a region as an RGBA image of `side` x `side` pixels.
Image square(const Image& image, const Region& region, std::uint32_t side) {
  Image face{side, side, 4, {}};
  face.pixels.resize(std::size_t{side} * side * 4);
  std::uint8_t* to = face.pixels.data();
  const auto at = [&](std::uint32_t first, std::uint32_t size, std::uint32_t i) {
    return first + static_cast<std::uint32_t>(std::uint64_t{i} * size / side);
  };
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      for (const std::uint8_t part : rgba_at(image, at(region.x, region.width, x), at(region.y, region.height, y)))
        *to++ = part;
  return face;
}

Alpha alpha_of_rgba(const Image& rgba) {
  auto result = Alpha::none;
  for (std::size_t i = 3; i < rgba.pixels.size(); i += 4) {
    if (rgba.pixels[i] != 0 && rgba.pixels[i] != 255) return Alpha::blended;
    if (rgba.pixels[i] == 0) result = Alpha::cut_out;
  }
  return result;
}

bool is_panorama(const Image& image) { return image.width >= 4 && image.width == 2 * std::uint64_t{image.height}; }

/// Returns a face of a cube, an index of OpenGL, of a panorama. The columns of a panorama are longitudes, its rows
/// latitudes. Its centre lies in the direction +Z, and +X lies to the right of it.
Image face_of_panorama(const Image& image, std::size_t face, std::uint32_t side) {
  constexpr double kPi = 3.14159265358979323846;
  Image result{side, side, 4, {}};
  result.pixels.resize(std::size_t{side} * side * 4);
  std::uint8_t* to = result.pixels.data();
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column) {
      const double s = 2 * (column + 0.5) / side - 1, t = 2 * (row + 0.5) / side - 1;
      const std::array<std::array<double, 3>, 6> directions = {
          {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}}};
      const auto& [x, y, mirrored_z] = directions[face];
      const double u = 0.5 + std::atan2(x, -mirrored_z) / (2 * kPi),
                   v = std::acos(y / std::hypot(x, y, mirrored_z)) / kPi;
      const auto at = [](double part, std::uint32_t size) {
        return std::min(static_cast<std::uint32_t>(std::max(part, 0.0) * size), size - 1);
      };
      for (const std::uint8_t part : rgba_at(image, at(u, image.width), at(v, image.height))) *to++ = part;
    }
  return result;
}

}  // namespace

TextureStore::Alpha LayerTextures::prepare(const TextureLayer& layer) {
  switch (layer.kind) {
    case Kind::image: {
      const auto* entry = layer.image ? images_.find(layer.image) : nullptr;
      return entry ? entry->alpha : Alpha::none;
    }
    case Kind::volume:
      return layer.image ? volume(layer.image).alpha : Alpha::none;
    case Kind::cube: {
      const Cube* found = cube(layer);
      return found ? found->alpha : Alpha::none;
    }
    case Kind::scene_cube:
      return Alpha::none;
  }
  return Alpha::none;
}

void LayerTextures::bind(const TextureLayer& layer, GLuint unit) {
  const auto bind_to = [&](GLenum target, GLuint name) {
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.BindTexture(target, name);
    gl_.ActiveTexture(GL_TEXTURE0);
    images_.bind_sampler(layer.sampling, unit);
  };
  switch (layer.kind) {
    case Kind::image: {
      const auto* entry = layer.image ? images_.find(layer.image) : nullptr;
      return entry ? images_.bind(*entry, layer.sampling, unit) : bind_to(GL_TEXTURE_2D, 0);
    }
    case Kind::volume:
      return bind_to(GL_TEXTURE_3D, layer.image ? volume(layer.image).texture.name() : 0);
    case Kind::cube: {
      const Cube* found = cube(layer);
      return bind_to(GL_TEXTURE_CUBE_MAP, found ? found->texture.name() : 0);
    }
    case Kind::scene_cube:
      return bind_to(GL_TEXTURE_CUBE_MAP, layer.scene_cube ? scene_texture(layer.scene_cube).texture.name() : 0);
  }
}

LayerTextures::Volume& LayerTextures::volume(const std::shared_ptr<const Image>& image) {
  Volume& entry = volumes_[image.get()];
  if (entry.image.expired() || entry.version != image->version) {
    entry = {};
    entry.image = image;
    entry.version = image->version;
    if (is_complete(*image)) upload(*image, entry);
  }
  return entry;
}

void LayerTextures::upload(const Image& image, Volume& to) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  // Larger sides than the driver permits are sampled coarser.
  constexpr std::uint32_t kMaxSide = 2048;
  const std::uint32_t most = std::min(kMaxSide, static_cast<std::uint32_t>(gl_.max_texture_size));
  const std::uint32_t rows = image.height / image.slices;
  const std::uint32_t width = std::min(image.width, most), height = std::min(rows, most),
                      depth = std::min(image.slices, most);
  Image rgba{width, height * depth, 4, {}};
  rgba.pixels.resize(std::size_t{width} * height * depth * 4);
  std::uint8_t* next = rgba.pixels.data();
  const auto scaled = [](std::uint32_t i, std::uint32_t from, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::uint64_t{i} * from / count);
  };
  for (std::uint32_t z = 0; z < depth; ++z)
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x)
        for (const std::uint8_t part : rgba_at(image, scaled(x, image.width, width),
                                               scaled(z, image.slices, depth) * rows + scaled(y, rows, height)))
          *next++ = part;
  to.alpha = alpha_of_rgba(rgba);
  to.texture = make_texture(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_3D, to.texture.name());
  gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
  gl_.TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, static_cast<GLsizei>(width), static_cast<GLsizei>(height),
                 static_cast<GLsizei>(depth), 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba.pixels.data());
}

LayerTextures::Cube* LayerTextures::cube(const TextureLayer& layer) {
  std::array<std::shared_ptr<const Image>, 6> faces = layer.faces;
  if (layer.image) faces.fill(layer.image);
  std::uint64_t version = 0;
  std::array<const Image*, 6> images{};
  for (std::size_t i = 0; i < 6; ++i) {
    if (faces[i] && is_complete(*faces[i])) images[i] = faces[i].get();
    if (images[i]) version += images[i]->version;
  }
  const auto same = [&](const std::unique_ptr<Cube>& one) {
    for (std::size_t i = 0; i < 6; ++i)
      if (one->faces[i].lock() != (images[i] ? faces[i] : nullptr)) return false;
    return true;
  };
  if (std::all_of(images.begin(), images.end(), [](const Image* image) { return image == nullptr; })) return nullptr;
  auto known = std::find_if(cubes_.begin(), cubes_.end(), same);
  if (known == cubes_.end()) {
    cubes_.push_back(std::make_unique<Cube>());
    known = std::prev(cubes_.end());
    for (std::size_t i = 0; i < 6; ++i)
      if (images[i]) (*known)->faces[i] = faces[i];
  } else if ((*known)->version == version && (*known)->texture) {
    return known->get();
  }
  (*known)->version = version;
  upload(images, layer.image != nullptr, **known);
  return known->get();
}

void LayerTextures::upload(const std::array<const Image*, 6>& faces, bool whole, Cube& to) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  constexpr std::uint32_t kMaxSide = 2048;
  const std::uint32_t most = std::min(kMaxSide, static_cast<std::uint32_t>(gl_.max_texture_size));
  std::uint32_t side = 1;
  const bool panorama = whole && faces[0] && is_panorama(*faces[0]);
  for (std::size_t i = 0; i < 6; ++i) {
    if (!faces[kCubeFaces[i]]) continue;
    const Region region = region_of(*faces[kCubeFaces[i]], i, whole);
    side = std::max(side, std::min(most, panorama ? region.width / 4 : std::max(region.width, region.height)));
  }
  to.alpha = Alpha::none;
  to.texture = make_texture(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_CUBE_MAP, to.texture.name());
  for (std::size_t i = 0; i < 6; ++i) {
    const Image* image = faces[kCubeFaces[i]];
    Image face{side, side, 4, std::vector<std::uint8_t>(std::size_t{side} * side * 4, 0)};
    if (image) face = panorama ? face_of_panorama(*image, i, side) : square(*image, region_of(*image, i, whole), side);
    if (const Alpha alpha = alpha_of_rgba(face); image && alpha != Alpha::none && to.alpha != Alpha::blended)
      to.alpha = alpha;
    const auto target = static_cast<GLenum>(GL_TEXTURE_CUBE_MAP_POSITIVE_X + i);
    for (GLint level = 0;; ++level) {
      const auto width = static_cast<GLsizei>(face.width);
      gl_.TexImage2D(target, level, GL_RGBA8, width, width, 0, GL_RGBA, GL_UNSIGNED_BYTE, face.pixels.data());
      if (face.width <= 1) break;
      Image half = halved(face);
      face = std::move(half);
    }
  }
}

LayerTextures::SceneTexture& LayerTextures::scene_texture(const std::shared_ptr<const SceneCube>& cube) {
  SceneTexture& entry = scene_textures_[cube.get()];
  const int size = std::clamp(cube->size, 1, std::min(2048, gl_.max_texture_size));
  if (!entry.cube.expired() && entry.size == size) return entry;
  entry = {};
  entry.cube = cube;
  entry.size = size;
  entry.texture = make_texture(gl_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_CUBE_MAP, entry.texture.name());
  gl_.TexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, 0);
  const std::vector<std::uint8_t> black(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4, 0);
  for (GLenum face = 0; face < 6; ++face)
    gl_.TexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, 0, GL_RGBA8, size, size, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                   black.data());
  return entry;
}

void LayerTextures::forget_unused() {
  std::erase_if(volumes_, [](const auto& entry) { return entry.second.image.expired(); });
  std::erase_if(cubes_, [](const std::unique_ptr<Cube>& cube) {
    return std::all_of(cube->faces.begin(), cube->faces.end(), [](const auto& face) { return face.expired(); });
  });
  std::erase_if(scene_textures_, [](const auto& entry) { return entry.second.cube.expired(); });
}

}  // namespace gs::render
