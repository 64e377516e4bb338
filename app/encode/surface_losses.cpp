#include "app/encode/surface_losses.h"

#include "app/encode/surface_triangles.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <set>
#include <utility>

namespace gs::app {
namespace {

bool has_holes(const render::Image& image) {
  if (!image.has_alpha()) return false;
  for (std::size_t i = image.components - 1; i < image.pixels.size(); i += image.components)
    if (image.pixels[i] != 255) return true;
  return false;
}

/// Losses of a scene, in the order in which they are reported.
class LossList {
 public:
  /// Adds "1 Shape BECOMES ..." or "2 Shapes BECOME ...", unless the count is 0.
  void add(std::size_t count, const std::string& noun, const char* one, const char* many) {
    if (count > 0)
      losses_.push_back(std::to_string(count) + " " + noun + (count == 1 ? " " : "s ") + (count == 1 ? one : many));
  }
  void add_left_out(std::size_t count, const std::string& noun) { add(count, noun, "is left out", "are left out"); }
  [[nodiscard]] std::vector<std::string> take() { return std::move(losses_); }

 private:
  std::vector<std::string> losses_;
};

}  // namespace

std::vector<std::string> surface_losses(const render::RenderList& list) {
  std::size_t transparent = 0, glowing = 0, thin = 0, volumes = list.splats.size();
  std::set<const render::Image*> known, seen_through;
  for (const render::DrawItem& item : list.items) {
    if (item.volume) {
      ++volumes;
      continue;
    }
    if (!has_surface(item)) {
      thin += item.mesh && !item.mesh->positions.empty() ? 1 : 0;
      continue;
    }
    transparent += item.material.transparency > 0 ? 1 : 0;
    glowing += item.material.lit && item.material.emissive != glm::vec3(0) ? 1 : 0;
    const render::Image* image = shows_picture(item) ? item.texture.image.get() : nullptr;
    if (image && known.insert(image).second && has_holes(*image)) seen_through.insert(image);
  }
  LossList losses;
  losses.add(transparent, "transparent Shape", "becomes opaque", "become opaque");
  losses.add(seen_through.size(), "texture", "loses its transparent parts", "lose their transparent parts");
  losses.add(glowing, "Shape", "with emissiveColor no longer glows", "with emissiveColor no longer glow");
  losses.add(thin, "Shape", "of lines or points is left out", "of lines or points are left out");
  losses.add(volumes, "Shape", "of splats or voxels is left out", "of splats or voxels are left out");
  losses.add_left_out(list.lights.size(), "light");
  losses.add_left_out(list.sounds.size(), "sound");
  losses.add_left_out(list.viewpoints.size(), "Viewpoint");
  return losses.take();
}

}  // namespace gs::app
