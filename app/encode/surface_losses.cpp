#include "app/encode/surface_losses.h"

#include "app/encode/surface_triangles.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <set>

namespace gs::app {
namespace {

bool has_holes(const render::Image& image) {
  if (!image.has_alpha()) return false;
  for (std::size_t i = image.components - 1; i < image.pixels.size(); i += image.components)
    if (image.pixels[i] != 255) return true;
  return false;
}

std::string shapes(std::size_t count) { return std::to_string(count) + (count == 1 ? " Shape" : " Shapes"); }

}  // namespace

std::vector<std::string> surface_losses(const render::RenderList& list) {
  std::size_t transparent = 0, glowing = 0, thin = 0;
  std::set<const render::Image*> known, seen_through;
  for (const render::DrawItem& item : list.items) {
    if (!has_surface(item)) {
      thin += item.mesh && !item.mesh->positions.empty() ? 1 : 0;
      continue;
    }
    transparent += item.material.transparency > 0 ? 1 : 0;
    glowing += item.material.lit && item.material.emissive != glm::vec3(0) ? 1 : 0;
    const render::Image* image = shows_picture(item) ? item.texture.image.get() : nullptr;
    if (image && known.insert(image).second && has_holes(*image)) seen_through.insert(image);
  }
  std::vector<std::string> losses;
  const auto add = [&](std::size_t count, const std::string& what) {
    if (count > 0) losses.push_back(what);
  };
  add(transparent, shapes(transparent) + " lose transparency and become opaque");
  add(seen_through.size(), "transparent parts of " + std::to_string(seen_through.size()) + " textures become opaque");
  add(glowing, shapes(glowing) + " with emissiveColor no longer glow; the colour is kept");
  add(thin, shapes(thin) + " of lines or points are left out");
  add(list.splats.size(), shapes(list.splats.size()) + " of splats or volumes are left out");
  add(list.lights.size(), std::to_string(list.lights.size()) + " lights are left out");
  add(list.sounds.size(), std::to_string(list.sounds.size()) + " sounds are left out");
  add(list.viewpoints.size(), std::to_string(list.viewpoints.size()) + " Viewpoints are left out");
  return losses;
}

}  // namespace gs::app
