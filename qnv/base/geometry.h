#pragma once

#include "base/box.h"
#include "qnv/base/description.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

class ChunkRequests;
class LodStream;
class PatchSurface;
class SplatStream;
class VolumeDetail;
class VolumeSeries;
struct VolumeValues;

/// Octree cube that a vector represents.
struct Cell {
  float edge = 0;    // units of the source; 0 if the vector has no cube
  float offset = 0;  // cube's centre = position - offset * normal
};

/// One JPEG or PNG file with a texture of a surface. A texture may have several files; later files are finer. A file
/// can be decoded after its first `enough` bytes are received.
struct PictureFile {
  std::vector<std::byte> bytes;
  std::size_t enough = 1;
};

/// Texture of a surface: the finest file that can be decoded, or its received prefix.
struct SurfacePicture {
  std::vector<std::byte> bytes;
  bool whole = false;
  bool repeat_s = true, repeat_t = true;  // VRML97 6.22
};

/// Properties that every geometry has.
struct GeometryBase {
  Description description;
  Rgb8 color;                                 // of vectors without their own
  std::shared_ptr<ChunkRequests> requests{};  // requests of views for more of the stream, or null
};

/// Arrays that all decoded vectors have, one entry per vector. Units are the source's; positions are relative to
/// `description.origin`. `weights` holds areas (surface, units^2) or gradient magnitudes (volume, value per unit of
/// length).
struct VectorArrays : GeometryBase {
  VectorArrays() = default;
  /// Makes a geometry without vectors.
  explicit VectorArrays(GeometryBase base) : GeometryBase(std::move(base)) {}

  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  // unit vectors
  std::vector<float> weights;      // > 0
  std::vector<Rgb8> colors;        // one per vector; if empty, all have the colour `color`

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] bool empty() const { return positions.empty(); }
};

/// Surface drawn as splats.
struct Splats : VectorArrays {
  using VectorArrays::VectorArrays;
  std::vector<Cell> cells;  // one per vector if these came from an octree, else empty
};

/// Gaussian splats (3DGS, 2DGS), which views blend in depth order. The vectors are discs of the same splats, for code
/// that handles surfaces: the normal is the shortest axis, and the colour that of degree 0. All arrays have one entry
/// per splat.
struct Gaussians : Splats {
  using Splats::Splats;
  std::vector<glm::vec3> scales;     // standard deviations along the splat's axes, at least 0, in units of the source
  std::vector<glm::vec4> rotations;  // unit quaternions x, y, z, w, from the splat's axes to those of the geometry
  std::vector<float> opacities;      // at the centre, 0..1
  std::vector<glm::vec3> bases;      // display-referred colours of degree 0, black 0 and white 1; may exceed 0..1
  int degree = 0;                    // of the spherical harmonics, 0 to kMaxDegree
  /// Coefficients of degrees 1 to `degree`: harmonic_count(degree) per splat, in the axes of the geometry.
  std::vector<glm::vec3> harmonics;
  bool antialiased = false;  // opacities are for splats that are widened to pixels with equal energy (Mip-Splatting)
  /// Stream from which each view takes its own cut; the arrays are then empty. Null if the arrays have all splats.
  std::shared_ptr<SplatStream> stream;

  /// Reports whether there is nothing to draw.
  [[nodiscard]] bool nothing() const { return empty() && !stream; }

  static constexpr int kMaxDegree = 3;
};
/// Returns the number of coefficients of degrees 1 to `degree`, for each colour.
[[nodiscard]] constexpr std::size_t harmonic_count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 1) - 1);
}

/// Surface without gaps; its vectors are the vertices.
struct IndexedMesh : VectorArrays {
  using VectorArrays::VectorArrays;
  std::vector<std::uint32_t> triangles;  // three vertices each, counter-clockwise seen from outside
  /// Texture coordinates s, t (VRML97 4.6.11) of the last vertices. The last triangles use these vertices; there, the
  /// texture replaces the colours.
  std::vector<glm::vec2> texture_coordinates;
  std::shared_ptr<const SurfacePicture> picture;

  /// Returns the index of the first vertex with texture coordinates.
  [[nodiscard]] std::size_t first_textured() const { return size() - texture_coordinates.size(); }
};

/// Stages of a displaced surface that are shown together. Every view takes its own cut (surface_cut.h).
struct SurfacePatches : GeometryBase {
  std::vector<std::shared_ptr<const PatchSurface>> parts;

  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] Box box() const;
};

/// Splats of which every view requests its own cut, because there are too many to keep in memory.
struct OctreeSplats : GeometryBase {
  /// Takes the description and the colour of the stream, which must not be null.
  explicit OctreeSplats(std::shared_ptr<LodStream> stream);

  std::shared_ptr<LodStream> stream;
};

/// Gradient vectors of a volume.
struct Volume : VectorArrays {
  using VectorArrays::VectorArrays;
  std::vector<std::uint8_t> classes;           // one per vector: values, 0..255 over description.value_range; or empty
  std::vector<Cell> cells;                     // one per vector if these came from an octree, else empty
  std::shared_ptr<const VolumeValues> values;  // decoded values that the vectors come from, or null
  std::shared_ptr<VolumeDetail> detail;        // finer vectors for views, or null if these are all
  std::shared_ptr<VolumeSeries> series;        // all steps of a time series, or null
};

/// Type of the content of a geometry.
template <class T>
concept GeometryContent = std::same_as<T, Splats> || std::same_as<T, IndexedMesh> || std::same_as<T, SurfacePatches> ||
    std::same_as<T, OctreeSplats> || std::same_as<T, Volume> || std::same_as<T, Gaussians>;

/// Decoded geometry, in one of six forms. The default is an empty surface.
class Geometry {
 public:
  Geometry() = default;
  template <GeometryContent T>
  Geometry(T content) : content_(std::move(content)) {}

  /// Returns the content if it has this form, else nullptr.
  template <GeometryContent T>
  [[nodiscard]] const T* as() const {
    return std::get_if<T>(&content_);
  }
  template <GeometryContent T>
  [[nodiscard]] T* as() {
    return std::get_if<T>(&content_);
  }
  template <class Visitor>
  decltype(auto) visit(const Visitor& visitor) const {
    return std::visit(visitor, content_);
  }

  [[nodiscard]] const GeometryBase& base() const {
    return visit([](const GeometryBase& base) -> const GeometryBase& { return base; });
  }
  [[nodiscard]] GeometryBase& base() {
    return std::visit([](GeometryBase& base) -> GeometryBase& { return base; }, content_);
  }
  [[nodiscard]] const Description& description() const { return base().description; }
  [[nodiscard]] const Rgb8& color() const { return base().color; }
  [[nodiscard]] Kind kind() const { return as<Volume>() ? Kind::volume : Kind::surface; }
  /// Returns the number of vectors in the arrays; 0 if the geometry has none.
  [[nodiscard]] std::size_t size() const;
  /// Returns the arrays, or nullptr if the geometry has none.
  [[nodiscard]] VectorArrays* arrays() {
    return std::visit(
        [](auto& content) -> VectorArrays* {
          if constexpr (std::derived_from<std::remove_reference_t<decltype(content)>, VectorArrays>) return &content;
          return nullptr;
        },
        content_);
  }

 private:
  std::variant<Splats, IndexedMesh, SurfacePatches, OctreeSplats, Volume, Gaussians> content_;
};

/// Returns the content of a shared geometry if it has this form, else null. Shares ownership.
template <GeometryContent T>
[[nodiscard]] std::shared_ptr<const T> shared_as(const std::shared_ptr<const Geometry>& geometry) {
  const T* content = geometry ? geometry->as<T>() : nullptr;
  return content ? std::shared_ptr<const T>(geometry, content) : nullptr;
}

/// View of the arrays of a geometry, for code that handles vectors of surfaces and volumes alike. Patches and octree
/// splats have no arrays. The geometry must outlive the view.
struct VectorView {
  VectorView(const GeometryBase& base) : description(base.description), color(base.color) {}
  VectorView(const VectorArrays& all)
      : description(all.description),
        color(all.color),
        positions(all.positions),
        normals(all.normals),
        weights(all.weights),
        colors(all.colors) {}
  VectorView(const Splats& splats) : VectorView(static_cast<const VectorArrays&>(splats)) { cells = splats.cells; }
  VectorView(const Volume& volume) : VectorView(static_cast<const VectorArrays&>(volume)) {
    kind = Kind::volume;
    classes = volume.classes;
    cells = volume.cells;
  }
  VectorView(const Geometry& geometry)
      : VectorView(geometry.visit([](const auto& content) { return VectorView(content); })) {}

  [[nodiscard]] std::size_t size() const { return positions.size(); }

  const Description& description;
  Rgb8 color;
  Kind kind = Kind::surface;
  std::span<const glm::vec3> positions, normals;
  std::span<const float> weights;
  std::span<const Rgb8> colors;           // may be empty
  std::span<const std::uint8_t> classes;  // of a volume; may be empty
  std::span<const Cell> cells;            // may be empty
};

inline std::size_t Geometry::size() const { return VectorView(*this).size(); }

}  // namespace gs::qnv
