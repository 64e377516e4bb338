#pragma once

#include "qnv/base/cloud.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Clouds of oriented vectors as files of other programs. All functions: a cloud in, the bytes of the file or a
/// message out; any thread. Values that no file can hold (not finite) are left out by formats of splats. A
/// surface's vectors are discs of their area; those of a volume are balls as wide as a voxel, coloured by the
/// transfer function, or, where there is none, grey by class and as opaque as their magnitude is large.
namespace gs::app {

struct ExportOptions {
  std::string title;       // what formats with a place for it call the object; UTF-8
  std::string stream_url;  // VRML97: the .qnv stream that the QNV instance names, for browsers that know the node
};

using Exported = std::variant<std::vector<std::byte>, std::string>;

/// PLY points, binary little-endian: x y z nx ny nz, red green blue (bytes), area; with the triangles between them,
/// where there are some, a mesh. Axes and units as they are; the normals of a volume point away from higher values.
/// Positions, normals and areas come back bit for bit.
[[nodiscard]] Exported export_points_ply(const qnv::Cloud& cloud, const ExportOptions& options = {});

/// Inria's 3DGS PLY of degree 0: x y z nx ny nz f_dc opacity scale rot. Axes: right, down, forward.
[[nodiscard]] Exported export_splats_ply(const qnv::Cloud& cloud, const ExportOptions& options = {});

/// glTF 2.0 binary with KHR_gaussian_splatting (release candidate of April 2026), one POINTS primitive; COLOR_0
/// for viewers that do not know the extension. Refuses clouds of more than 4 GiB.
[[nodiscard]] Exported export_glb_splats(const qnv::Cloud& cloud, const ExportOptions& options = {});
/// The same of clouds without triangles; else the mesh that they make (export_glb_mesh.h).
[[nodiscard]] Exported export_glb(const qnv::Cloud& cloud, const ExportOptions& options = {});

/// Niantic's SPZ, version 4 (zstd) or 3 (gzip), degree 0. Axes: right, up, back. Positions to 24 bits of the
/// largest coordinate, sizes to 6 %. Refuses clouds with no vector to show, which the format cannot say.
[[nodiscard]] Exported export_spz(const qnv::Cloud& cloud, const ExportOptions& options = {});
[[nodiscard]] Exported export_spz3(const qnv::Cloud& cloud, const ExportOptions& options = {});

/// A VRML97 world that any browser shows: PROTO QNV, with the interface of our node, whose body is a PointSet,
/// or an IndexedFaceSet of a square for each vector; and a Shape with it, seen as a whole from the front. Points cannot
/// be lit: those of a cloud of one colour carry the shading of a light from above the viewer.
[[nodiscard]] Exported export_vrml97_points(const qnv::Cloud& cloud, const ExportOptions& options = {});
[[nodiscard]] Exported export_vrml97_patches(const qnv::Cloud& cloud, const ExportOptions& options = {});

/// One way to write a cloud.
struct ExportFormat {
  std::string_view name;       // "spz"
  std::string_view extension;  // ".spz"; may have two parts, ".3dgs.ply"
  std::string_view description;
  Exported (*write)(const qnv::Cloud& cloud, const ExportOptions& options);
};

/// The table of all; the first of several with one extension is what the extension alone means.
[[nodiscard]] std::span<const ExportFormat> export_formats();
/// The format with the longest extension that ends `path`, in any case of letters; null where there is none.
[[nodiscard]] const ExportFormat* export_format_of(std::string_view path);
[[nodiscard]] const ExportFormat* export_format_named(std::string_view name);

}  // namespace gs::app
