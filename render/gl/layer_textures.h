#pragma once

#include "render/gl/gpu.h"
#include "render/gl/texture_store.h"
#include "render/scene/layered_material.h"

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// GPU textures of the layers of LayeredMaterials: volumes and cubes. Images are those of a TextureStore.
class LayerTextures {
 public:
  LayerTextures(const Gl& gl, TextureStore& images) : gl_(gl), images_(images) {}

  /// Uploads the texture of a layer, if necessary. Returns its alpha. Call it before the frame is drawn.
  [[nodiscard]] TextureStore::Alpha prepare(const TextureLayer& layer);
  /// Binds the texture of a layer, and its sampler, to a unit. Binds no texture, which samples as black, if it is
  /// missing. Leaves unit 0 active.
  void bind(const TextureLayer& layer, GLuint unit);
  void forget_unused();

  /// Returns the cube texture that the renderer draws for a SceneCube. Makes it if necessary; its faces are black then.
  struct SceneTexture {
    std::weak_ptr<const SceneCube> cube;
    Texture texture;
    int size = 0;
    std::uint64_t changes = 0, request = 0;  // RenderList::changes and SceneCube::request of the picture
    bool drawn = false;
  };
  [[nodiscard]] SceneTexture& scene_texture(const std::shared_ptr<const SceneCube>& cube);

 private:
  struct Volume {
    std::weak_ptr<const Image> image;
    Texture texture;
    TextureStore::Alpha alpha = TextureStore::Alpha::none;
    std::uint64_t version = 0;
  };
  struct Cube {
    std::array<std::weak_ptr<const Image>, 6> faces;
    Texture texture;
    TextureStore::Alpha alpha = TextureStore::Alpha::none;
    std::uint64_t version = 0;  // sum of the versions of the faces
  };
  Volume& volume(const std::shared_ptr<const Image>& image);
  Cube* cube(const TextureLayer& layer);
  void upload(const Image& image, Volume& to);
  /// Uploads the faces of a cube. If `whole`, all of them lie in one image.
  void upload(const std::array<const Image*, 6>& faces, bool whole, Cube& to);

  const Gl& gl_;
  TextureStore& images_;
  std::unordered_map<const Image*, Volume> volumes_;
  std::vector<std::unique_ptr<Cube>> cubes_;
  std::unordered_map<const SceneCube*, SceneTexture> scene_textures_;
};

}  // namespace gs::render
