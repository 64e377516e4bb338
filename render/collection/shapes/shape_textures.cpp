#include "render/collection/shapes/shape_resources.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cstring>
#include <utility>

// Part of ShapeResources for textures of X3D: volumes, cubes of the scene, layered materials, TextureBackgrounds.
namespace gs::render {
namespace {

// Bytes per voxel: the image and the renderer's copy.
constexpr std::size_t kVoxelBytes = 8;

/// Returns the volume of a PixelTexture3D: components, width, height and depth, then one number per voxel.
Image volume_of(const vrml::MFInt32& words) {
  constexpr std::size_t kHeader = 4;
  constexpr std::int32_t kMaxSide = 4096;
  if (words.size() < kHeader) return {};
  const auto side_of = [&](std::size_t i) { return words[i] > 0 && words[i] <= kMaxSide ? words[i] : 0; };
  const auto components = static_cast<std::size_t>(std::clamp(words[0], 0, 4));
  const auto width = static_cast<std::size_t>(side_of(1)), height = static_cast<std::size_t>(side_of(2)),
             depth = static_cast<std::size_t>(side_of(3));
  if (components == 0 || width * height * depth == 0 || width * height * depth > words.size() - kHeader) return {};
  Image image{static_cast<std::uint32_t>(width),
              static_cast<std::uint32_t>(height * depth),
              static_cast<std::uint32_t>(components),
              {}};
  image.slices = static_cast<std::uint32_t>(depth);
  image.pixels.resize(width * height * depth * components);
  std::uint8_t* to = image.pixels.data();
  for (std::size_t z = 0; z < depth; ++z)
    for (std::size_t row = height; row-- > 0;)  // the file begins at the bottom, an Image at the top
      for (std::size_t x = 0; x < width; ++x) {
        const auto word = static_cast<std::uint32_t>(words[kHeader + (z * height + row) * width + x]);
        for (std::size_t c = components; c-- > 0;) *to++ = static_cast<std::uint8_t>(word >> (8 * c));
      }
  return image;
}

/// Returns a volume with the images as slices. Images that differ from the first in size or components are black.
Image stacked(const std::vector<std::shared_ptr<const Image>>& images) {
  const auto first = std::find_if(images.begin(), images.end(), [](const auto& image) { return image != nullptr; });
  if (first == images.end()) return {};
  const Image& like = **first;
  Image volume{like.width, static_cast<std::uint32_t>(like.height * images.size()), like.components, {}};
  volume.slices = static_cast<std::uint32_t>(images.size());
  volume.pixels.resize(like.pixels.size() * images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Image* image = images[i].get();
    if (image && image->width == like.width && image->height == like.height && image->components == like.components)
      std::memcpy(volume.pixels.data() + i * like.pixels.size(), image->pixels.data(), like.pixels.size());
  }
  return volume;
}

}  // namespace

std::shared_ptr<const Image> ShapeResources::volume_of_pixels(const vrml::SceneGraph& scene, vrml::NodeId id) {
  const auto& words = scene.get<vrml::MFInt32>(id, "image");
  MeshCache::VolumeEntry& entry = meshes_.volumes[&scene.node(id)];
  if (entry.image && entry.source.shares_with(words)) return entry.image;
  entry = {};
  entry.source = words;
  entry.share = Share(budget_, Resource::pixels);
  if (!entry.share.grow(words.size() * kVoxelBytes)) {
    report_limit("PixelTexture3D: " + budget_->refusal(Resource::pixels), scene, id);
    return nullptr;
  }
  Image image = volume_of(words);
  if (!image.empty()) entry.image = std::make_shared<const Image>(std::move(image));
  return entry.image;
}

std::shared_ptr<const Image> ShapeResources::volume_of_textures(const vrml::SceneGraph& scene, vrml::NodeId id) {
  constexpr std::size_t kMaxSlices = 2048;
  std::vector<std::shared_ptr<const Image>> slices;
  std::uint64_t version = 0, pixels = 0;
  for (const vrml::NodeId one : scene.get<vrml::MFNode>(id, "texture")) {
    if (slices.size() >= kMaxSlices) break;
    const vrml::NodeId texture = scene.resolve(one);
    slices.push_back(texture ? image_of_texture(scene, texture) : nullptr);
    if (!slices.back()) continue;
    version += slices.back()->version;
    pixels = std::max<std::uint64_t>(pixels, std::uint64_t{slices.back()->width} * slices.back()->height);
  }
  MeshCache::VolumeEntry& entry = meshes_.volumes[&scene.node(id)];
  if (entry.image && entry.slices == slices && entry.version == version) return entry.image;
  entry = {};
  entry.share = Share(budget_, Resource::pixels);
  if (!entry.share.grow(pixels * slices.size() * kVoxelBytes)) {
    report_limit("ComposedTexture3D: " + budget_->refusal(Resource::pixels), scene, id);
    return nullptr;
  }
  Image image = stacked(slices);
  entry.slices = std::move(slices);
  entry.version = version;
  if (!image.empty()) entry.image = std::make_shared<const Image>(std::move(image));
  return entry.image;
}

std::shared_ptr<const SceneCube> ShapeResources::scene_cube(const vrml::SceneGraph& scene, vrml::NodeId id) {
  constexpr int kMaxSize = 1024;
  std::shared_ptr<SceneCube>& cube = meshes_.scene_cubes[&scene.node(id)];
  if (!cube) cube = std::make_shared<SceneCube>();
  cube->size = std::clamp(scene.get<vrml::SFInt32>(id, "size"), 1, kMaxSize);
  const std::string_view update = scene.get<vrml::SFString>(id, "update").view();
  cube->update = update == "ALWAYS"            ? SceneCube::Update::always
                 : update == "NEXT_FRAME_ONLY" ? SceneCube::Update::next_frame_only
                                               : SceneCube::Update::none;
  ++cube->request;
  return cube;
}

std::shared_ptr<const LayeredMaterial> ShapeResources::keep(LayeredMaterial material) {
  constexpr std::size_t kLatest = 64;
  std::erase_if(layered_, [](const auto& one) { return one.expired(); });
  for (const auto& one : layered_)
    if (auto known = one.lock(); known && *known == material) return known;
  if (layered_.size() >= kLatest) layered_.erase(layered_.begin());
  auto made = std::make_shared<const LayeredMaterial>(std::move(material));
  layered_.push_back(made);
  return made;
}

void ShapeResources::fit_layers(DrawItem& item, const glm::vec3& scale) {
  using Coordinates = TextureLayer::Coordinates;
  if (!item.layered || !item.mesh) return;
  const auto depends = [&](const TextureLayer& layer) {
    return layer.coordinates == Coordinates::box ||
           (layer.coordinates == Coordinates::position && scale != glm::vec3(1));
  };
  if (std::none_of(item.layered->layers.begin(), item.layered->layers.end(), depends)) return;
  LayeredMaterial fitted = *item.layered;
  for (TextureLayer& layer : fitted.layers) {
    if (!depends(layer)) continue;
    if (layer.coordinates == Coordinates::position) {
      layer.transform = glm::scale(layer.transform, scale);
      continue;
    }
    const glm::vec3 size = glm::max(item.mesh->bounds.size(), glm::vec3(1e-30f));
    layer.transform = glm::translate(glm::scale(layer.transform, 1.0f / size), -item.mesh->bounds.lower);
    layer.coordinates = Coordinates::position;
  }
  item.layered = keep(std::move(fitted));
}

void ShapeResources::add_faces(Background& background, const vrml::SceneGraph& scene, const NodeView& node) {
  for (std::size_t face = 0; face < Background::kFaces; ++face) {
    const auto* given = node.find<vrml::SFNode>(BackgroundFields::back_texture + static_cast<int>(face));
    vrml::NodeId texture = given ? vrml::meant_node(scene, *given, vrml::Role::texture) : vrml::NodeId{};
    if (texture && scene.node(texture).type->read_as == NodeKind::multi_texture) {
      const auto& textures = scene.get<vrml::MFNode>(texture, "texture");
      texture = textures.empty() ? vrml::NodeId{} : vrml::meant_node(scene, textures[0], vrml::Role::texture);
    }
    if (texture) background.panorama[face] = image_of_texture(scene, texture);
  }
}

}  // namespace gs::render
