#include "qnv/codecs/displaced/tessellation/surface_cut.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::qnv {
namespace {

bool outside(const PatchSurface::Bounds& bounds, const LodView& view) {
  for (const glm::vec4& plane : view.planes) {
    const glm::vec3 normal(plane);
    const float length = glm::length(normal);
    if (length > 0 && glm::dot(normal, bounds.center) + plane.w < -bounds.radius * length * 1.0001f) return true;
  }
  return false;
}

/// Reports whether `eye` is behind every triangle of a patch.
bool faces_away(const PatchSurface::Bounds& bounds, const glm::vec3& eye) {
  if (!(bounds.cosine > 0)) return false;
  const glm::vec3 to = bounds.center - eye;
  const float distance = glm::length(to);
  if (!(distance > bounds.radius)) return false;
  constexpr float kTurnMargin = 0.01f;  // radians; margin for rounding errors
  const float along = std::clamp(glm::dot(bounds.axis, to) / distance, -1.0f, 1.0f);
  const float turned =
      std::acos(along) + std::acos(std::min(bounds.cosine, 1.0f)) + std::asin(bounds.radius / distance) + kTurnMargin;
  return turned < 1.570796f;
}

/// Returns how often an edge must be halved until its pieces are as short as the view requires. The result may be
/// fractional.
float detail_of(const PatchSurface::Edge& edge, const LodView& view) {
  const float distance = std::max(glm::length(edge.center - view.eye) - edge.radius, 0.0f);
  const float pieces = edge.length * view.pixels / (distance * view.error_pixels);
  if (!(pieces > 1)) return 0;
  return std::log2(std::min(pieces, 1e9f));
}

int level_of(float detail) { return static_cast<int>(std::ceil(detail)); }

std::size_t vertices_of(float detail) {
  const std::size_t n = std::size_t{1} << level_of(detail);
  return n * n / 2 + 1;  // adjacent patches share edge vertices
}

struct PartDetails {
  std::vector<float> edges, patches;
  std::vector<std::uint32_t> seen;
};

}  // namespace

SurfaceCut cut_surface(const SurfacePatches& surface, const LodView& view) {
  SurfaceCut cut;
  std::vector<PartDetails> parts(surface.parts.size());
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const PatchSurface& part = *surface.parts[s];
    PartDetails& details = parts[s];
    const auto deepest = static_cast<float>(part.level());
    for (const PatchSurface::Edge& edge : part.edges())
      details.edges.push_back(std::min(detail_of(edge, view), deepest));
    for (std::size_t p = 0; p < part.size(); ++p) {
      details.patches.push_back(
          std::max({details.edges[part.edge(p, 0)], details.edges[part.edge(p, 1)], details.edges[part.edge(p, 2)]}));
      const PatchSurface::Bounds& bounds = part.bounds(p);
      if (!outside(bounds, view) && !(view.leave_backs && faces_away(bounds, view.eye)))
        details.seen.push_back(static_cast<std::uint32_t>(p));
    }
  }
  const auto vertices = [&](float less) {
    std::size_t sum = 0;
    for (const PartDetails& part : parts)
      for (const std::uint32_t p : part.seen) sum += vertices_of(std::max(part.patches[p] - less, 0.0f));
    return sum;
  };
  float less = 0;
  cut.vertices = vertices(0);
  if (view.budget > 0 && cut.vertices > view.budget) {
    float low = 0, high = displaced::kDeepestPatch;
    for (int i = 0; i < 16; ++i) {
      const float middle = (low + high) / 2;
      (vertices(middle) > view.budget ? low : high) = middle;
    }
    less = high;
    cut.vertices = vertices(less);
  }
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const PatchSurface& part = *surface.parts[s];
    PartDetails& details = parts[s];
    if (less > 0)
      for (auto* values : {&details.edges, &details.patches})
        for (float& detail : *values) detail = std::max(detail - less, 0.0f);
    for (const std::uint32_t p : details.seen) {
      PatchCut& one = cut.patches.emplace_back();
      one.part = static_cast<std::uint32_t>(s);
      one.patch = p;
      one.detail = details.patches[p];
      one.level = static_cast<std::uint8_t>(level_of(one.detail));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t e = part.edge(p, k);
        const PatchSurface::Edge& edge = part.edges()[e];
        int level = one.level;
        for (const std::uint32_t beside : {edge.owner, edge.other})
          if (beside != displaced::kNone) level = std::max(level, level_of(details.patches[beside]));
        one.edge_levels[k] = static_cast<std::uint8_t>(level);
        one.edge_details[k] = details.edges[e];
      }
    }
  }
  return cut;
}

PatchCut cut_patch(const SurfacePatches& surface, std::uint32_t part_number, std::uint32_t patch, const LodView& view) {
  const PatchSurface& part = *surface.parts[part_number];
  const auto deepest = static_cast<float>(part.level());
  const auto of_edge = [&](std::uint32_t edge) { return std::min(detail_of(part.edges()[edge], view), deepest); };
  const auto of_patch = [&](std::uint32_t p) {
    return std::max({of_edge(part.edge(p, 0)), of_edge(part.edge(p, 1)), of_edge(part.edge(p, 2))});
  };
  PatchCut cut;
  cut.part = part_number;
  cut.patch = patch;
  cut.detail = of_patch(patch);
  cut.level = static_cast<std::uint8_t>(level_of(cut.detail));
  for (std::size_t k = 0; k < 3; ++k) {
    const PatchSurface::Edge& edge = part.edges()[part.edge(patch, k)];
    int level = cut.level;
    for (const std::uint32_t beside : {edge.owner, edge.other})
      if (beside != displaced::kNone) level = std::max(level, level_of(of_patch(beside)));
    cut.edge_levels[k] = static_cast<std::uint8_t>(level);
    cut.edge_details[k] = of_edge(part.edge(patch, k));
  }
  return cut;
}

SurfaceCut even_cut(const SurfacePatches& surface, std::size_t most_triangles) {
  SurfaceCut cut;
  std::size_t patches = 0;
  for (const auto& part : surface.parts) patches += part->size();
  int level = 0;
  while (level < displaced::kDeepestPatch && patches << 2 * (level + 1) <= most_triangles) ++level;
  for (std::size_t s = 0; s < surface.parts.size(); ++s) {
    const auto here = static_cast<std::uint8_t>(std::min(level, surface.parts[s]->level()));
    for (std::size_t p = 0; p < surface.parts[s]->size(); ++p) {
      PatchCut& one = cut.patches.emplace_back();
      one.part = static_cast<std::uint32_t>(s);
      one.patch = static_cast<std::uint32_t>(p);
      one.detail = here;
      one.level = here;
      one.edge_levels = {here, here, here};
      one.edge_details = {one.detail, one.detail, one.detail};
      cut.vertices += vertices_of(one.detail);
    }
  }
  return cut;
}

}  // namespace gs::qnv
