#pragma once

#include "base/box.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Returns the origin from which positions in `box`, in source coordinates, are stored, so that float32 keeps their
/// precision. On each axis it is the box's middle, rounded to float32, if the box lies far from 0 for its size; else 0.
/// Subtracting the origin from float32 coordinates near it is exact.
[[nodiscard]] glm::dvec3 local_origin(const WideBox& box);

/// Display-referred sRGB colour, 8 bits per component.
struct Rgb8 {
  std::uint8_t r = 204, g = 204, b = 204;  // VRML97 6.27: diffuseColor 0.8
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// Meaning of the vectors of a stream (paper, section 2.1).
enum class Kind : std::uint8_t {
  surface = 0,  // weight = area, direction = outward normal
  volume = 1,   // voxels: weight = gradient magnitude, direction = gradient, towards higher values
};

/// Control point of a volume's transfer function, which is piecewise linear in the value (0..1 over
/// Description::value_range).
struct TransferPoint {
  float value = 0;
  Rgb8 color;
  float opacity = 0;  // 0..1
  friend bool operator==(const TransferPoint&, const TransferPoint&) = default;
};

/// Properties that all vectors of a stream share.
struct Description {
  Kind kind = Kind::surface;
  bool two_sided = false;  // surface: visible from behind too (VRML97 `solid FALSE`)
  /// Source coordinates of the point 0 of all positions, boxes and lattices of the stream. Keeps float32 precise far
  /// from the source's own 0. Source coordinates are origin + position, computed in double.
  glm::dvec3 origin{0};
  Box box;                                    // of the source, relative to `origin`; contains every position
  double total = 0;                           // surface: total area (units^2); volume: sum of all magnitudes
  float spacing = 0;                          // volume: smallest distance between two voxels; surface: 0
  std::pair<float, float> value_range{0, 1};  // volume: values of classes 0 and 255
  std::vector<TransferPoint> transfer;        // volume; sorted by value
  std::vector<std::pair<std::string, std::string>> metadata;  // UTF-8: "title", "author", "units", "source", ...
  friend bool operator==(const Description&, const Description&) = default;
};

/// Octree cube that a splat represents.
struct Cell {
  float edge = 0;    // units of the source; 0 if the splat has no cube
  float offset = 0;  // cube's centre = position - offset * normal
};

class LodStream;
struct SurfacePatches;

/// One JPEG or PNG file of a surface's texture. A picture may have several files; later ones are finer. The file can be
/// shown once its first `enough` bytes are received.
struct PictureFile {
  std::vector<std::byte> bytes;
  std::size_t enough = 1;
};

/// Texture of a surface: the finest file that can be shown, or its received prefix.
struct SurfacePicture {
  std::vector<std::byte> bytes;
  bool whole = false;
  bool repeat_s = true, repeat_t = true;  // VRML97 6.22
};

/// Decoded vectors, or a surface made of them. Each array is empty or has one entry per vector.
/// Units are the source's; positions are relative to `description.origin`. `weights` holds areas (surface, units^2) or
/// gradient magnitudes (volume, value per unit of length). A volume has `classes` (values, 0..255 over value_range). A
/// surface may have `colors`; otherwise all vectors have the colour `color`.
struct Cloud {
  Description description;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  // unit
  std::vector<float> weights;      // > 0
  std::vector<Rgb8> colors;
  std::vector<std::uint8_t> classes;
  std::vector<Cell> cells;  // of splats that came from an octree
  /// Vertex indices, three per triangle, counter-clockwise seen from outside. If not empty, the vectors are vertices of
  /// a surface without gaps.
  std::vector<std::uint32_t> triangles;
  /// Texture coordinates s, t (VRML97 4.6.11) of the last vertices. Their triangles are the last ones; the picture
  /// replaces their colours.
  std::vector<glm::vec2> texture_coordinates;
  std::shared_ptr<const SurfacePicture> picture;
  Rgb8 color;
  /// Source of view-dependent vectors (lod.h), if there are too many vectors to keep in memory. The arrays are then
  /// empty, and every view requests its own cut.
  std::shared_ptr<LodStream> levels;
  /// Displaced surface, of which every view takes its own cut (surface/surface_cut.h). The arrays are then empty.
  std::shared_ptr<const SurfacePatches> patches;

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] bool empty() const { return positions.empty(); }
  /// Returns the index of the first vertex with texture coordinates.
  [[nodiscard]] std::size_t first_textured() const { return positions.size() - texture_coordinates.size(); }
};

}  // namespace gs::qnv
