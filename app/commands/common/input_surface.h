#pragma once

#include "app/commands/common/vectors_of.h"
#include "qnv/base/shine.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace gs::app {

/// Triangles of an input. The input must outlive it.
struct InputSurface {
  qnv::TriangleSource source;
  std::size_t triangles = 0;  // number before subdivision; 0 for an isosurface
  bool two_sided = false;
  glm::dvec3 origin{0};                          // origin of the triangle coordinates
  const render::RenderList* textured = nullptr;  // render list, if some Shapes have textures; else null
  std::optional<qnv::Shine> shine;
  std::shared_ptr<std::string> problem = std::make_shared<std::string>();  // error, if reading the triangles fails
};

/// Returns the triangles of a world, of a mesh, or of a volume with `isovalue`. Returns nullopt for other inputs.
[[nodiscard]] std::optional<InputSurface> input_surface(const OpenedInput& input, std::optional<double> isovalue,
                                                        ProgressBar& progress);
/// Returns an isosurface. At the border of the volume it is open and shows its inside.
[[nodiscard]] InputSurface isosurface_of(const qnv::VolumeSource& volume, double isovalue, ProgressBar& progress);

/// Returns the triangles of a surface. Passing them on during the stage "reading" advances `progress`.
[[nodiscard]] qnv::TriangleSource with_progress(const InputSurface& surface, Progress& progress);

/// Returns the maximum number of triangles that indexed_mesh() joins.
[[nodiscard]] std::size_t most_joined_triangles(const Limits& limits);
/// Joins the triangles of a surface to a mesh. Corners that are equal in all properties share a vertex. Keeps the
/// texture if one image can represent all textures; otherwise, its colours become colours of vertices. Deterministic.
[[nodiscard]] std::variant<qnv::IndexedMesh, qnv::EncodeError> indexed_mesh(const InputSurface& surface,
                                                                            std::size_t most_triangles,
                                                                            ProgressBar& progress);

}  // namespace gs::app
