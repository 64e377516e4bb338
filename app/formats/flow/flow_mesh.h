#pragma once

#include "app/formats/common/mesh_asset.h"
#include "app/formats/flow/vector_field.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace gs::app {

/// Streamline: positions with the vectors there.
struct Streamline {
  std::vector<glm::dvec3> points, vectors;
};
/// Limits and density of streamlines.
struct StreamlineOptions {
  std::size_t seeds = 600;           // on an even grid
  std::size_t most_points = 60'000;  // of all lines
  double step = 0.5;                 // in distances of stored vectors
};
/// Follows the vectors forwards and backwards from seeds on an even grid (Runge-Kutta, 4th order). Skips seeds near
/// earlier lines. A line ends at the border, at missing or zero vectors, or when it turns back.
[[nodiscard]] std::vector<Streamline> streamlines_of(const VectorField& field, const StreamlineOptions& options = {});

/// Makes a mesh of arrows on a thinned grid, or of streamlines as tubes, for VoxelComponent::flow of the builder's
/// choice. Colours stand for lengths of vectors; `title` names them. Reports problems to the builder. Throws
/// OutOfBudget.
void build_flow(const qnv::VolumeSource& source, const std::string& title, const Progress& progress,
                MeshBuilder& builder);

/// Reads the vectors of a volume as a mesh. Returns an empty mesh on failure; the diagnostics give the reason.
[[nodiscard]] MeshAsset flow_mesh(const qnv::VolumeSource& source, const VoxelComponent& choice,
                                  const std::string& path, const Progress& progress, const WorldBudget& budget,
                                  Diagnostics& diagnostics);

}  // namespace gs::app
