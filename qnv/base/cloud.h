#pragma once

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

/// An axis-aligned box; empty when lower > upper.
struct Box {
  glm::vec3 lower{std::numeric_limits<float>::infinity()};
  glm::vec3 upper{-std::numeric_limits<float>::infinity()};

  [[nodiscard]] bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  void add(const glm::vec3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  [[nodiscard]] glm::vec3 size() const { return upper - lower; }
  friend bool operator==(const Box&, const Box&) = default;
};

/// The same of places as a source has them.
struct WideBox {
  glm::dvec3 lower{std::numeric_limits<double>::infinity()};
  glm::dvec3 upper{-std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  void add(const glm::dvec3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
};

/// From where the coordinates of what lies in a box are to count, so that float32 keeps them: along an axis on which
/// the box lies far from 0 for its size, its middle, which is a float32 itself; else 0. What float32 kept of the places
/// about such an origin it keeps of the differences, too, without rounding.
[[nodiscard]] glm::dvec3 local_origin(const WideBox& box);

/// Display-referred sRGB, 8 bits a component.
struct Rgb8 {
  std::uint8_t r = 204, g = 204, b = 204;  // VRML97 6.27: diffuseColor 0.8
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// What vectors stand for (paper, section 2.1).
enum class Kind : std::uint8_t {
  surface = 0,  // discs: weight is an area, direction the outward normal
  volume = 1,   // voxels: weight is the magnitude of the gradient, direction the gradient's, towards higher values
};

/// How a volume's vectors are shown: a point of a piecewise linear function of the value (0..1 over
/// Description::value_range).
struct TransferPoint {
  float value = 0;
  Rgb8 color;
  float opacity = 0;  // 0..1
  friend bool operator==(const TransferPoint&, const TransferPoint&) = default;
};

/// What a stream says about all of its vectors.
struct Description {
  Kind kind = Kind::surface;
  bool two_sided = false;  // surface: seen from behind too (VRML97 `solid FALSE`)
  /// Where 0 of all positions, boxes and lattices lies, in the space of the source: what is far from that one's own 0
  /// keeps its details in float32 so. Places of the source are origin + position, in double.
  glm::dvec3 origin{0};
  Box box;                                    // of the source, from `origin`; every position lies in it
  double total = 0;                           // surface: integrated area (units^2); volume: sum of all magnitudes
  float spacing = 0;                          // volume: smallest distance of two voxels; surface: 0
  std::pair<float, float> value_range{0, 1};  // volume: the values that classes 0 and 255 stand for
  std::vector<TransferPoint> transfer;        // volume; sorted by value
  std::vector<std::pair<std::string, std::string>> metadata;  // UTF-8: "title", "author", "units", "source", ...
  friend bool operator==(const Description&, const Description&) = default;
};

/// The cube that a disc stands for, when it was cut from one.
struct Cell {
  float edge = 0;    // units of the source; 0: no cube
  float offset = 0;  // the centre is the disc's position - offset * normal
};

class LodStream;
struct SurfacePatches;

/// One file of the picture of a textured surface, JPEG or PNG; of several the finer ones are larger. To show the
/// surface with as much of it as has come `enough` bytes from its front on are needed.
struct PictureFile {
  std::vector<std::byte> bytes;
  std::size_t enough = 1;
};

/// The picture of a textured surface: its finest file that can be shown, or as much of its front as has come.
struct SurfacePicture {
  std::vector<std::byte> bytes;
  bool whole = false;
  bool repeat_s = true, repeat_t = true;  // VRML97 6.22
};

/// Quantised normal vectors, decoded: one entry a vector in every array that is not empty.
///
/// Units are the source's, places count from `description.origin`. `weights` is the area of the disc (units^2) or the
/// magnitude of the gradient (value per unit of length). A volume has `classes` (its value, 0..255 over value_range), a
/// surface may have `colors`; without them it has the colour `color`.
struct Cloud {
  Description description;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  // unit
  std::vector<float> weights;      // > 0
  std::vector<Rgb8> colors;
  std::vector<std::uint8_t> classes;
  std::vector<Cell> cells;  // of discs that came from an octree
  /// Three numbers of vectors a triangle, counter-clockwise seen from outside: where there are some, the vectors are
  /// the vertices of a surface, which is closed between them however near it is seen.
  std::vector<std::uint32_t> triangles;
  /// Of the last vertices, s and t (VRML97 4.6.11): their triangles, which are the last ones, show the picture in place
  /// of colours.
  std::vector<glm::vec2> texture_coordinates;
  std::shared_ptr<const SurfacePicture> picture;
  Rgb8 color;
  /// Where the vectors come from when there are too many, or too many too small, to keep all of them: then the
  /// arrays are empty, and every view takes its own cut (lod.h).
  std::shared_ptr<LodStream> levels;
  /// The same of a displaced surface: then the arrays are empty, and every view takes its own cut
  /// (surface/surface_cut.h).
  std::shared_ptr<const SurfacePatches> patches;

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] bool empty() const { return positions.empty(); }
  /// The first vertex that has texture coordinates.
  [[nodiscard]] std::size_t first_textured() const { return positions.size() - texture_coordinates.size(); }
};

}  // namespace gs::qnv
