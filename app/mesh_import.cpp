#include "app/mesh_import.h"

#include "app/gunzip.h"

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

using vrml::Severity;

std::vector<std::byte> unpacked(std::span<const std::byte> bytes, vrml::Diagnostics& diagnostics,
                                const std::string& file) {
  std::vector<std::byte> out;
  const auto problem = gunzip(bytes, kMaxUnpacked, [&](std::string_view piece) {
    const auto* first = reinterpret_cast<const std::byte*>(piece.data());
    out.insert(out.end(), first, first + piece.size());
    return true;
  });
  if (problem) diagnostics.add({Severity::error, file, {}, *problem});
  return out;
}

}  // namespace

std::unique_ptr<vrml::SceneGraph> import_mesh(const ContentType& type, const std::string& path,
                                              std::span<const std::byte> bytes, vrml::Diagnostics& diagnostics,
                                              const ReadFile& read_file) {
  if (bytes.empty()) {
    diagnostics.add({Severity::error, path, {}, "the file is empty; expected " + std::string(type.name)});
    return nullptr;
  }
  const std::size_t errors = diagnostics.errors();
  std::vector<std::byte> packed;
  if (is_gzip(bytes)) {
    packed = unpacked(bytes, diagnostics, path);
    if (!packed.empty()) bytes = packed;
  }
  auto scene = std::make_unique<vrml::SceneGraph>(path);
  type.import(bytes, *scene, diagnostics, read_file);
  if (!scene->roots().empty()) return scene;
  if (diagnostics.errors() == errors)
    diagnostics.add({Severity::error, path, {}, "holds nothing to show; read as " + std::string(type.name)});
  return nullptr;
}

}  // namespace gs::app
