#include "app/formats/export/export.h"
#include "app/formats/export/export_volume.h"
#include "app/formats/splats/splats.h"
#include "qnv/base/shine.h"

#include <algorithm>
#include <string>

namespace gs::app {
namespace {

constexpr std::string_view kSpzRounding = "SPZ rounds splats: sizes to 3 %, opacities to 0.2 %, colours to 0.4 %";
constexpr std::string_view kSpzHarmonics = ", harmonics to 0.4 % between -1 and 1";
constexpr std::string_view kSogRounding = "SOG rounds splats: 16 bits per coordinate, 256 values for sizes and colours";
constexpr std::string_view kSogHarmonics = ", a palette of harmonics";

constexpr ExportFormat kExportFormats[] = {
    {"ply", ".ply", "PLY: a mesh or points with normals, colours and areas; Gaussian splats as .3dgs.ply", export_ply,
     kKeepsTriangles | kKeepsColors | kKeepsGaussians | kKeepsFilter},
    {"points-ply", ".points.ply", "PLY mesh or points; Gaussian splats as opaque discs", export_points_ply,
     kKeepsTriangles | kKeepsColors},
    {"3dgs-ply", ".3dgs.ply", "Gaussian splats as PLY (Inria), with everything", export_splats_ply,
     kKeepsColors | kKeepsGaussians | kKeepsFilter},
    {"glb", ".glb", "glTF binary: a mesh with its picture, or splats (KHR_gaussian_splatting)", export_glb,
     kKeepsTriangles | kKeepsColors | kKeepsTexture | kKeepsGaussians},
    {"glb-splats", ".splats.glb", "glTF binary with KHR_gaussian_splatting", export_glb_splats,
     kKeepsColors | kKeepsGaussians},
    {"stl", ".stl", "STL mesh, binary, without colours", export_stl, kKeepsTriangles | kNeedsTriangles},
    {"obj", ".obj", "OBJ mesh with colours, and its material and texture beside it", export_obj,
     kKeepsTriangles | kKeepsColors | kKeepsTexture | kKeepsShine | kNeedsTriangles},
    {"spz", ".spz", "Gaussian splats as SPZ version 4 (zstd)", export_spz,
     kKeepsColors | kKeepsGaussians | kKeepsFilter, nullptr, kSpzRounding, kSpzHarmonics},
    {"spz3", ".v3.spz", "Gaussian splats as SPZ version 3 (gzip)", export_spz3,
     kKeepsColors | kKeepsGaussians | kKeepsFilter, nullptr, kSpzRounding, kSpzHarmonics},
    {"sog", ".sog", "Gaussian splats as SOG version 2 (PlayCanvas)", export_sog,
     kKeepsColors | kKeepsGaussians | kKeepsFilter, nullptr, kSogRounding, kSogHarmonics},
    {"vrml97", ".wrl", "VRML97 for any browser: scenes and meshes with all nodes; vectors as points",
     export_vrml97_points, kKeepsColors},
    {"vrml97-patches", ".patches.wrl", "VRML97 for any browser: a square for each vector", export_vrml97_patches,
     kKeepsColors},
    {"nrrd", ".nrrd", "NRRD: the values of a volume", export_nrrd, kNeedsValues, write_nrrd},
    {"vti", ".vti", "VTK ImageData: the values of a volume", export_vti, kNeedsValues, write_vti},
    {"nifti", ".nii", "NIfTI-1: the values of a volume", export_nifti, kNeedsValues, write_nifti},
    {"nifti-gz", ".nii.gz", "NIfTI-1 with gzip: the values of a volume", export_nifti_gz, kNeedsValues, write_nifti_gz},
    {"fits", ".fits", "FITS: the values of a volume", export_fits, kNeedsValues, write_fits},
    {"x3d", ".x3d", "X3D XML: as .wrl", export_x3d_points, kKeepsColors},
    {"x3dv", ".x3dv", "X3D classic VRML: as .wrl", export_x3dv_points, kKeepsColors},
    {"x3dj", ".x3dj", "X3D JSON: as .wrl", export_x3dj_points, kKeepsColors},
};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool ends_with(std::string_view path, std::string_view extension) {
  if (path.size() < extension.size()) return false;
  return std::equal(extension.begin(), extension.end(), path.end() - static_cast<std::ptrdiff_t>(extension.size()),
                    [](char a, char b) { return a == lower(b); });
}

}  // namespace

std::vector<std::string> export_losses(const ExportFormat& format, const qnv::Geometry& geometry) {
  std::vector<std::string> losses;
  const auto* mesh = geometry.as<qnv::IndexedMesh>();
  const auto* volume = geometry.as<qnv::Volume>();
  const qnv::VectorView vectors(geometry);
  if ((format.keeps & kNeedsValues) != 0) return losses;
  const auto lacks = [&](ExportKeeps property) { return (format.keeps & property) == 0; };
  if (mesh && !mesh->triangles.empty() && lacks(kKeepsTriangles))
    losses.push_back(std::to_string(mesh->triangles.size() / 3) +
                     " triangles become splats at their vertices; .ply, .glb, .obj and .stl keep triangles");
  if (mesh && mesh->picture && lacks(kKeepsTexture))
    losses.push_back(lacks(kKeepsColors) ? "the texture is left out; .glb and .obj keep it"
                                         : "the texture becomes colours of vertices; .glb and .obj keep it");
  const bool colored = !vectors.colors.empty() || vectors.color != qnv::Rgb8{};
  if (lacks(kKeepsColors) && colored && !(mesh && mesh->picture))
    losses.push_back("colours are left out; .ply, .glb and .obj keep them");
  if (lacks(kKeepsShine) && qnv::shine_of(vectors.description) != qnv::Shine{})
    losses.push_back("the specular colour of the material is left out");
  const auto* gaussians = geometry.as<qnv::Gaussians>();
  if (gaussians && lacks(kKeepsGaussians))
    for (const auto& [key, value] : vectors.description.metadata)
      if (key == kSplatsAsDiscs)
        losses.push_back("splats become " + value + "; .ply, .spz, .sog and .splats.glb keep them");
  if (gaussians && gaussians->antialiased && lacks(kKeepsFilter) && !lacks(kKeepsGaussians))
    losses.emplace_back(
        "the flag for antialiased drawing (Mip-Splatting) is not kept, so small splats become more opaque"
        "; .ply, .spz and .sog keep it");
  if (gaussians && !format.rounding.empty())
    losses.push_back(std::string(format.rounding) +
                     (gaussians->degree > 0 ? std::string(format.harmonics_rounding) : std::string()));
  if (volume && !volume->classes.empty()) losses.push_back("the values of the voxels become colours");
  return losses;
}

std::span<const ExportFormat> export_formats() { return kExportFormats; }

const ExportFormat* export_format_of(std::string_view path) {
  const ExportFormat* best = nullptr;
  for (const ExportFormat& format : kExportFormats)
    if (ends_with(path, format.extension) && (!best || format.extension.size() > best->extension.size()))
      best = &format;
  return best;
}

}  // namespace gs::app
