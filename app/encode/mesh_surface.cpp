#include "app/encode/mesh_surface.h"

#include "vrml/mesh/face_set.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

/// Returns the faces as in a node of the mesh's scene, which has the default values of all other fields.
vrml::FaceSet face_set_of(const Geometry& geometry, const WorldBudget& budget) {
  vrml::FaceSet faces;
  faces.coord_index = geometry.coord_index;
  faces.points = geometry.positions;
  faces.normal = {geometry.normals, true, geometry.normal_index};
  faces.color = {geometry.colors, geometry.color_per_vertex, {}};
  faces.texture_coordinate = {geometry.texture_coordinates, true, geometry.texture_index};
  faces.convex = geometry.convex;
  faces.solid = geometry.solid;
  faces.crease_angle = geometry.crease_angle;
  faces.budget = budget;
  return faces;
}

glm::vec3 vector_of(const vrml::Color& color) { return {color.r, color.g, color.b}; }

/// Parts that limits removed, by the reason.
class LimitReports {
 public:
  void add(const std::string& why) {
    for (auto& [known, count] : parts_)
      if (known == why) return void(++count);
    parts_.emplace_back(why, 1);
  }
  void report(const std::string& path, Diagnostics& diagnostics) const {
    for (const auto& [why, count] : parts_) {
      const std::string others = count > 1 ? " (and " + std::to_string(count - 1) + " more)" : "";
      diagnostics.add({Severity::error, path, {}, why + "; left out" + others});
    }
  }

 private:
  std::vector<std::pair<std::string, std::size_t>> parts_;
};

}  // namespace

MeshSurface mesh_surface(MeshAsset asset, const std::string& path, const WorldBudget& budget,
                         Diagnostics& diagnostics) {
  MeshSurface surface;
  LimitReports reports;
  for (MeshPart& part : asset.parts) {
    if (part.geometry.kind != Geometry::Kind::faces) continue;
    vrml::Mesh mesh = vrml::make_mesh(face_set_of(part.geometry, budget));
    Share share(budget, Resource::meshes);
    const bool allowed = share.grow(mesh.cost());
    if ((!allowed || mesh.limited) && !budget->stopped()) reports.add(budget->refusal(Resource::meshes));
    surface.face_colors |= !part.geometry.color_per_vertex && !part.geometry.colors.empty();
    part.geometry = {};
    const std::size_t triangles = mesh.indices.size() / 3;
    if (!allowed || triangles == 0) continue;
    if (surface.parts.size() >= budget->limit(Resource::items)) {
      reports.add(budget->refusal(Resource::items));
    } else if (triangles > budget->limit(Resource::triangles) - surface.summary.triangles) {
      reports.add(budget->refusal(Resource::triangles));
    } else {
      const Look& look = asset.looks[part.look].look;
      const qnv::Shine shine = look.lit ? qnv::Shine{vector_of(look.specular), look.shininess} : qnv::Shine{};
      surface.summary.add(mesh, glm::dmat4(1), shine);
      const glm::vec3 color = look.lit ? vector_of(look.diffuse) + vector_of(look.emissive) : glm::vec3(1);
      surface.parts.push_back({std::move(mesh), color});
      surface.shares.push_back(std::move(share));
    }
    if (budget->stopped()) break;
  }
  reports.report(path, diagnostics);
  surface.shares.push_back(std::move(asset.memory));
  if (asset.color_key) surface.color_key = read_color_key(color_key_text(*asset.color_key));
  return surface;
}

bool for_each_triangle(const MeshSurface& surface, const qnv::TriangleSink& sink, const glm::dvec3& origin) {
  for (const MeshSurface::Part& part : surface.parts) {
    const SurfaceCorners corners(part.mesh, glm::dmat4(1), part.color, origin);
    TriangleBatches batches(sink);
    const bool wanted = corners.each([&](std::uint32_t index) { return corners.corner(index); },
                                     [&](const auto& triangle) { return batches.add_finite(triangle); });
    if (!wanted || !batches.flush()) return false;
  }
  return true;
}

}  // namespace gs::app
