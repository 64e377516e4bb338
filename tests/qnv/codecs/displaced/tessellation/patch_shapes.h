#pragma once

#include "qnv/codecs/displaced/subdivision.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/displaced/tessellation/patch_surface.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <glm/common.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

// Displaced surfaces with random numbers, for tests of cuts and drawing.
namespace gs::qnv {

/// Returns a rough surface of a mesh's triangles, `depth` levels deep, with creases at edges with numbers that `every`
/// divides (0: none).
inline displaced::Surface rough_surface(const displaced::SurfaceMesh& mesh, int depth, std::size_t every = 0,
                                        bool colored = false) {
  displaced::StageHeader stage;
  stage.depth = depth;
  stage.colored = colored;
  stage.base.bits = 10;
  stage.base.triangles = mesh.triangles;
  Box box;
  for (const glm::vec3& p : mesh.positions) box.add(p);
  const displaced::Frame frame(box);
  for (const glm::vec3& p : mesh.positions)
    stage.base.vertices.push_back(glm::clamp(glm::ivec3(frame.inside(p) * 1024.0f), 0, 1023));
  const displaced::Patches patches(mesh.triangles, static_cast<std::uint32_t>(mesh.positions.size()));
  if (every > 0)
    for (std::size_t e = 0; e < patches.edges().size(); ++e)
      stage.base.creases.push_back(e % every == 0 && patches.edges()[e].other != displaced::kNone);
  displaced::Surface surface(stage);
  std::mt19937 random(7);
  for (int level = 0; level <= depth; ++level) {
    displaced::NumberArray& numbers = surface.numbers(0, level).normal;
    const std::uint32_t most = 17u >> level | 1u;
    for (std::size_t v = 0; v < numbers.size(); ++v)
      numbers[v] = static_cast<std::int16_t>(random() % (2 * most + 1)) - static_cast<std::int16_t>(most);
    if (!colored) continue;
    for (displaced::NumberArray& channel : surface.colors(level))
      for (std::size_t v = 0; v < channel.size(); ++v) channel[v] = static_cast<std::int16_t>(random() % 5) - 2;
  }
  return surface;
}

/// Evaluates all received numbers of `surface` at a level, and makes a surface of them.
inline std::shared_ptr<const PatchSurface> patch_surface(const displaced::Surface& surface, int level, const Box& box) {
  const std::vector<glm::vec3> places = surface.positions(level);
  std::vector<std::uint32_t> normals;
  for (const glm::vec3& normal : displaced::slot_normals(surface.patches(), surface.slots(), level, places))
    normals.push_back(pack_direction(normal));
  const std::vector<Rgb8> colors = surface.vertex_colors(level);
  return PatchSurface::make(surface, level, box, {places, {}, normals, colors, nullptr, nullptr});
}

inline SurfacePatches patches_of(const displaced::Surface& surface, int level) {
  return {{}, {patch_surface(surface, level, Box{glm::vec3(-1), glm::vec3(1)})}};
}

}  // namespace gs::qnv
