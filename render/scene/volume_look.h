#pragma once

#include "render/image/image.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::render {

/// One step that changes the colour and opacity of a voxel: a volume rendering style (X3D 41.4), or a blend with a
/// second volume.
struct VolumeStep {
  enum class Kind : std::uint8_t { opacity_map, boundary, edge, tone, silhouette, cartoon, shaded, blend };
  /// Weight of a volume in a blend (X3D Table 41.3). Alpha 1 is the opacity of the first volume.
  enum class Weight : std::uint8_t { constant, alpha_1, alpha_2, one_minus_alpha_1, one_minus_alpha_2, table };

  Kind kind = Kind::opacity_map;
  bool lit = false;                      // shaded: lights shade the voxel
  bool has_material = false;             // shaded: `values` hold the material, else voxels have their colour
  bool scatters = false;                 // shaded: voxels without a surface scatter light by the phase function
  bool shadows = false;                  // shaded: voxels between a voxel and a light weaken the light
  std::array<Weight, 2> weights{};       // blend
  std::vector<glm::vec4> values;         // parameters; volume_source.cpp lists them for each kind
  std::shared_ptr<const Image> normals;  // surfaceNormals; null means gradients
  std::array<std::shared_ptr<const Image>, 2> tables;  // transfer function, or weight functions of a blend
  std::shared_ptr<const Image> voxels;                 // blend: the second volume
  std::vector<VolumeStep> inner;                       // blend: styles of the second volume
};

/// Styles of a volume, of a segment or of an isosurface, in order.
struct VolumeChain {
  std::vector<VolumeStep> steps;
  bool projected = false;  // a ProjectionVolumeStyle: voxels take part in VolumeLook::projection
};

/// Appearance of a volume data node (X3D 41.3.3). Voxels fill the box from -0.5 to 0.5 of the item's mesh.
struct VolumeLook {
  enum class Projection : std::uint8_t { maximum, minimum, average };
  static constexpr std::size_t kMaxChains = 16, kMaxSteps = 16, kMaxSurfaces = 64, kMaxTextures = 8, kSegments = 256;

  std::shared_ptr<const Image> voxels;                          // null until the texture has loaded: nothing is drawn
  bool smooth = true;                                           // voxels are interpolated
  glm::vec3 dimensions{1};                                      // of the box, in the space of the node; above 0
  std::shared_ptr<const Image> gradients;                       // given normals that replace those of all gradients
  std::shared_ptr<const Image> segments;                        // segment identifiers, of the size of `voxels`
  std::array<std::uint32_t, kSegments / 32> hidden_segments{};  // bit set: segmentEnabled is FALSE
  /// Chains by segment, or by isosurface. Segments without a chain have the default style. Otherwise, the only chain.
  std::vector<VolumeChain> chains;
  Projection projection = Projection::maximum;
  float threshold = 0;  // intensityThreshold of the projection; 0 means none
  /// Colours of the projected values 0 to 1, with opacities, in one row; null means grey. Not of X3D.
  std::shared_ptr<const Image> projection_colors;
  bool iso_surfaces = false;                  // draws `surfaces` only
  std::vector<float> surfaces;                // values of isosurfaces, ascending
  std::vector<std::uint32_t> surface_chains;  // by surface: index in `chains`
  float least_gradient = 0;                   // surfaceTolerance: surfaces exist where gradients are larger
};

/// Returns the number of voxels along each axis. Returns zeros if the image is not complete.
[[nodiscard]] inline std::array<std::uint32_t, 3> voxel_counts(const Image& image) {
  if (image.slices == 0 || image.components < 1 || image.components > 4 || image.height % image.slices != 0 ||
      image.pixels.size() != std::size_t{image.width} * image.height * image.components)
    return {};
  return {image.width, image.height / image.slices, image.slices};
}

}  // namespace gs::render
