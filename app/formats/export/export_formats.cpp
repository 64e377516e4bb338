#include "app/formats/export/export.h"

#include <algorithm>

namespace gs::app {
namespace {

constexpr ExportFormat kExportFormats[] = {
    {"ply", ".ply", "PLY points with normals, colours and areas", export_points_ply},
    {"3dgs-ply", ".3dgs.ply", "Gaussian splats as PLY (Inria), degree 0", export_splats_ply},
    {"glb", ".glb", "glTF binary: a mesh with its picture, or splats (KHR_gaussian_splatting)", export_glb},
    {"glb-splats", ".splats.glb", "glTF binary with KHR_gaussian_splatting", export_glb_splats},
    {"spz", ".spz", "Gaussian splats as SPZ version 4 (zstd)", export_spz},
    {"spz3", ".v3.spz", "Gaussian splats as SPZ version 3 (gzip)", export_spz3},
    {"vrml97", ".wrl", "VRML97 for any browser: points", export_vrml97_points},
    {"vrml97-patches", ".patches.wrl", "VRML97 for any browser: a square for each vector", export_vrml97_patches},
};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool ends_with(std::string_view path, std::string_view extension) {
  if (path.size() < extension.size()) return false;
  return std::equal(extension.begin(), extension.end(), path.end() - static_cast<std::ptrdiff_t>(extension.size()),
                    [](char a, char b) { return a == lower(b); });
}

}  // namespace

std::span<const ExportFormat> export_formats() { return kExportFormats; }

const ExportFormat* export_format_of(std::string_view path) {
  const ExportFormat* best = nullptr;
  for (const ExportFormat& format : kExportFormats)
    if (ends_with(path, format.extension) && (!best || format.extension.size() > best->extension.size()))
      best = &format;
  return best;
}

}  // namespace gs::app
