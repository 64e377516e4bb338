#include "app/formats/export/export.h"
#include "vrml/printing/print_scene.h"
#include "vrml/syntax/parser.h"

#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

Exported x3d_text(std::span<const std::byte> vrml97, vrml::Grammar grammar) {
  vrml::SceneGraph scene("world.wrl");
  Diagnostics diagnostics;
  const std::string_view text(reinterpret_cast<const char*>(vrml97.data()), vrml97.size());
  if (vrml::parse(text, scene, diagnostics) != vrml::ParseOutcome::complete || diagnostics.errors() > 0)
    return "the world has too many nodes or values for X3D";
  std::vector<std::byte> bytes;
  vrml::print_scene(scene, {grammar}, [&](std::string_view piece) {
    const auto part = std::as_bytes(std::span(piece));
    bytes.insert(bytes.end(), part.begin(), part.end());
    return true;
  });
  return bytes;
}

namespace {

template <vrml::Grammar kGrammar>
Exported export_points(const qnv::Geometry& geometry, const ExportOptions& options) {
  Exported world = export_vrml97_points(geometry, options);
  const auto* const bytes = std::get_if<std::vector<std::byte>>(&world);
  return bytes ? x3d_text(*bytes, kGrammar) : world;
}

}  // namespace

Exported export_x3d_points(const qnv::Geometry& geometry, const ExportOptions& options) {
  return export_points<vrml::Grammar::x3d_xml>(geometry, options);
}

Exported export_x3dv_points(const qnv::Geometry& geometry, const ExportOptions& options) {
  return export_points<vrml::Grammar::x3d_classic>(geometry, options);
}

Exported export_x3dj_points(const qnv::Geometry& geometry, const ExportOptions& options) {
  return export_points<vrml::Grammar::x3d_json>(geometry, options);
}

}  // namespace gs::app
