#pragma once

#include "qnv/base/geometry.h"
#include "vrml/scene/x3d/language.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Export of oriented vectors to other programs' formats. Each function takes a geometry and returns the bytes of the
/// file, or a message. Runs on any thread. Splat formats omit vectors with non-finite values. A surface vector becomes
/// a flat splat of its area. A volume vector becomes a ball as wide as a voxel, coloured by the transfer function.
/// Without a transfer function it is grey by class, with opacity proportional to magnitude.
namespace gs::app {

/// File that belongs to an exported file and is written beside it, such as a texture.
struct CompanionFile {
  std::string name;  // without folder
  std::vector<std::byte> bytes;
};

struct ExportOptions {
  std::string title = {};                        // title of the object in UTF-8, for formats that store a title
  std::string stream_url = {};                   // VRML97: url field of the QNV instance, for browsers with this node
  std::string name = {};                         // OBJ: name of the file without folder and extension
  std::vector<CompanionFile>* beside = nullptr;  // OBJ: gets the material and the texture; null omits both
};

using Exported = std::variant<std::vector<std::byte>, std::string>;

/// Exports binary little-endian PLY: x y z nx ny nz, red green blue (bytes), area. With triangles, exports a mesh. Axes
/// and units are unchanged. Normals of a volume point away from higher values. Positions, normals and areas round-trip
/// bit for bit.
[[nodiscard]] Exported export_points_ply(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Exports Inria's 3DGS PLY: x y z nx ny nz f_dc f_rest opacity scale rot. The axes are right, down, forward.
[[nodiscard]] Exported export_splats_ply(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Exports Gaussians as export_splats_ply() does, and other geometries as export_points_ply() does.
[[nodiscard]] Exported export_ply(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Exports PlayCanvas SOG, version 2, as a ZIP archive of images. Coordinates are stored as logarithms with 16 bits.
/// Codebooks of 256 numbers hold scales, colours and harmonics. The axes are right, down, forward.
[[nodiscard]] Exported export_sog(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Exports binary glTF 2.0 with KHR_gaussian_splatting (ratified in 2026) as one POINTS primitive.
/// COLOR_0 is for viewers without the extension. Refuses files over 4 GiB.
[[nodiscard]] Exported export_glb_splats(const qnv::Geometry& geometry, const ExportOptions& options = {});
/// Exports binary glTF: a mesh (export_glb_mesh.h) if `geometry` has triangles, else splats.
[[nodiscard]] Exported export_glb(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Export Niantic's SPZ: version 4 (zstd) and version 3 (gzip). The axes are right, up, back. A position
/// has 24 bits, relative to the largest coordinate. Sizes are accurate to 3 %. Both functions refuse input without
/// visible vectors, because SPZ cannot represent it.
[[nodiscard]] Exported export_spz(const qnv::Geometry& geometry, const ExportOptions& options = {});
[[nodiscard]] Exported export_spz3(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Export a VRML97 world for any browser: a PROTO QNV with the interface of the built-in node, and one Shape with an
/// instance. A Viewpoint shows the Shape from the front. The body of the PROTO is a PointSet in the first function; in
/// the second, an IndexedFaceSet with a square for each vector. VRML97 does not light points, so points of a single
/// colour get baked shading by a light above the viewer.
[[nodiscard]] Exported export_vrml97_points(const qnv::Geometry& geometry, const ExportOptions& options = {});
[[nodiscard]] Exported export_vrml97_patches(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Export the world of export_vrml97_points() in X3D: XML, classic VRML and JSON.
[[nodiscard]] Exported export_x3d_points(const qnv::Geometry& geometry, const ExportOptions& options = {});
[[nodiscard]] Exported export_x3dv_points(const qnv::Geometry& geometry, const ExportOptions& options = {});
[[nodiscard]] Exported export_x3dj_points(const qnv::Geometry& geometry, const ExportOptions& options = {});
/// Returns a VRML97 text without errors in an encoding of X3D.
[[nodiscard]] Exported x3d_text(std::span<const std::byte> vrml97, vrml::Grammar grammar);

/// Error of formats that hold triangles only.
inline constexpr std::string_view kNoTriangles =
    "the input has no triangles, only splats or points; expected .ply, .glb, .spz or .sog instead";

/// Exports binary STL: triangles without colours. Coordinates are float32.
[[nodiscard]] Exported export_stl(const qnv::Geometry& geometry, const ExportOptions& options = {});
/// Exports OBJ with normals. Colours of vertices follow the coordinates of `v`. The material and the texture become
/// companion files.
[[nodiscard]] Exported export_obj(const qnv::Geometry& geometry, const ExportOptions& options = {});

/// Bits for the properties that a format keeps.
enum ExportKeeps : unsigned {
  kKeepsTriangles = 1,
  kKeepsColors = 2,
  kKeepsTexture = 4,
  kKeepsShine = 8,
  kNeedsTriangles = 16,  // the format holds nothing else
  kNeedsValues = 32,     // the format holds the values of a volume
  kKeepsGaussians = 64,  // shapes, opacities and spherical harmonics of splats
  kKeepsFilter = 128,    // qnv::Gaussians::antialiased
};

/// Export format.
struct ExportFormat {
  std::string_view name;       // "spz"
  std::string_view extension;  // ".spz"; may have two parts, ".3dgs.ply"
  std::string_view description;
  Exported (*write)(const qnv::Geometry& geometry, const ExportOptions& options);
  unsigned keeps;  // bits of ExportKeeps
  /// Writes the file in pieces, like `write`. Null for formats that are written whole. Returns a message on failure,
  /// and an empty message if `take` returns false.
  std::optional<std::string> (*write_pieces)(const qnv::Geometry& geometry, const ExportOptions& options,
                                             const std::function<bool(std::span<const std::byte>)>& take) = nullptr;
  std::string_view rounding = {};  // message about the rounding of Gaussian splats; empty if they are kept exactly
  std::string_view harmonics_rounding = {};  // appended to `rounding` for splats with harmonics
};

/// Returns all formats. If several formats share an extension, the first one is its default.
[[nodiscard]] std::span<const ExportFormat> export_formats();
/// Returns the properties of `geometry` that a format does not keep, as messages for the user.
[[nodiscard]] std::vector<std::string> export_losses(const ExportFormat& format, const qnv::Geometry& geometry);
/// Returns the format with the longest extension that ends `path`, ignoring case. Returns null if no extension matches.
[[nodiscard]] const ExportFormat* export_format_of(std::string_view path);

}  // namespace gs::app
