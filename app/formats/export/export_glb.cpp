#include "app/formats/common/byte_order.h"
#include "app/formats/common/ranges.h"
#include "app/formats/common/scene_builder.h"
#include "app/formats/export/export.h"
#include "app/formats/export/export_glb_mesh.h"
#include "app/formats/export/export_vectors.h"
#include "app/formats/gltf/glb.h"
#include "app/formats/splats/splats.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::app {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsignedByte = 5121, kArrayBuffer = 34962, kPoints = 0;
constexpr std::size_t kSplatBytes = 12 + 16 + 12 + 4 + 12 + 4;

/// Builder of the binary buffer. Each attribute has its own view and accessor.
class Attributes {
 public:
  explicit Attributes(const std::vector<ExportSplat>& splats) : splats_(splats) {
    bytes.reserve(splats.size() * kSplatBytes);
  }

  /// Adds an attribute. `put` appends the values of one splat, a multiple of four bytes. Returns the accessor.
  template <class Put>
  OrderedJson& add(const std::string& name, const char* type, int component_type, bool normalized, Put&& put) {
    const std::size_t start = bytes.size();
    for (const ExportSplat& splat : splats_) put(splat);
    views.push_back(
        {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes.size() - start}, {"target", kArrayBuffer}});
    OrderedJson accessor = {
        {"bufferView", views.size() - 1}, {"componentType", component_type}, {"count", splats_.size()}, {"type", type}};
    if (normalized) accessor["normalized"] = true;
    attributes[name] = accessors.size();
    accessors.push_back(std::move(accessor));
    return accessors.back();
  }
  template <class Put>
  OrderedJson& add_floats(const std::string& name, const char* type, Put&& put) {
    return add(name, type, kFloat, false, put);
  }

  std::vector<std::byte> bytes;
  OrderedJson views = OrderedJson::array(), accessors = OrderedJson::array(), attributes = OrderedJson::object();

 private:
  const std::vector<ExportSplat>& splats_;
};

/// Converts display sRGB to linear light (IEC 61966-2-1).
float linear_of_display(float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); }

void add_bounds(const std::vector<ExportSplat>& splats, OrderedJson& accessor) {
  Box box;
  for (const ExportSplat& splat : splats) box.add(splat.position);
  accessor["min"] = {box.lower.x, box.lower.y, box.lower.z};
  accessor["max"] = {box.upper.x, box.upper.y, box.upper.z};
}

void add_all(const ExportSplats& made, Attributes& to) {
  const std::vector<ExportSplat>& splats = made.splats;
  const auto put_vector = [&](const glm::vec3& v) {
    for (int k = 0; k < 3; ++k) put_little(to.bytes, v[k]);
  };
  add_bounds(splats, to.add_floats("POSITION", "VEC3", [&](const ExportSplat& s) { put_vector(s.position); }));
  const std::string prefix = "KHR_gaussian_splatting:";
  to.add_floats(prefix + "ROTATION", "VEC4", [&](const ExportSplat& s) {
    for (int k = 0; k < 4; ++k) put_little(to.bytes, s.rotation[k]);
  });
  to.add_floats(prefix + "SCALE", "VEC3", [&](const ExportSplat& s) { put_vector(s.scale); });
  to.add_floats(prefix + "OPACITY", "SCALAR", [&](const ExportSplat& s) { put_little(to.bytes, s.opacity); });
  to.add_floats(prefix + "SH_DEGREE_0_COEF_0", "VEC3", [&](const ExportSplat& s) { put_vector(s.dc); });
  std::size_t number = 0;
  for (int degree = 1; degree <= made.degree; ++degree)
    for (int n = 0; n <= 2 * degree; ++n, ++number)
      to.add_floats(prefix + "SH_DEGREE_" + std::to_string(degree) + "_COEF_" + std::to_string(n), "VEC3",
                    [&](const ExportSplat& s) {
                      const auto i = static_cast<std::size_t>(&s - splats.data());
                      put_vector(made.harmonics[i * qnv::harmonic_count(made.degree) + number]);
                    });
  to.add("COLOR_0", "VEC4", kUnsignedByte, true, [&](const ExportSplat& s) {
    for (int k = 0; k < 3; ++k)
      put_little(to.bytes, byte_of(linear_of_display(std::clamp(0.5f + kSphericalHarmonic0 * s.dc[k], 0.0f, 1.0f))));
    put_little(to.bytes, byte_of(s.opacity));
  });
}

OrderedJson document_of(const Attributes& attributes, const glm::dvec3& origin, const ExportOptions& options) {
  OrderedJson document;
  document["asset"] = {{"version", "2.0"}, {"generator", "GhostSpace"}};
  document["scene"] = 0;
  if (attributes.bytes.empty()) {
    document["scenes"] = {OrderedJson::object()};  // glTF forbids empty arrays, so write a scene without nodes.
    return document;
  }
  const char* const extension = "KHR_gaussian_splatting";
  document["extensionsUsed"] = {extension};
  document["scenes"] = {{{"nodes", {0}}}};
  OrderedJson node = {{"mesh", 0}};
  if (!options.title.empty()) node["name"] = options.title;
  if (origin != glm::dvec3(0)) node["translation"] = {origin.x, origin.y, origin.z};
  document["nodes"] = {std::move(node)};
  OrderedJson primitive = {{"mode", kPoints}, {"attributes", attributes.attributes}};
  primitive["extensions"][extension] = {{"kernel", "ellipse"},
                                        {"colorSpace", "srgb_rec709_display"},
                                        {"projection", "perspective"},
                                        {"sortingMethod", "cameraDistance"}};
  OrderedJson mesh;
  mesh["primitives"] = OrderedJson::array({std::move(primitive)});
  document["meshes"] = OrderedJson::array({std::move(mesh)});
  document["buffers"] = {{{"byteLength", attributes.bytes.size()}}};
  document["bufferViews"] = attributes.views;
  document["accessors"] = attributes.accessors;
  return document;
}

}  // namespace

Exported export_glb_splats(const qnv::Geometry& geometry, const ExportOptions& options) {
  constexpr std::size_t kHeaderRoom = 65536;
  const auto* gaussians = geometry.as<qnv::Gaussians>();
  const std::size_t each = kSplatBytes + (gaussians ? 12 * qnv::harmonic_count(gaussians->degree) : 0);
  if (geometry.size() > (std::numeric_limits<std::uint32_t>::max() - kHeaderRoom - options.title.size()) / each)
    return "a GLB file holds no more than 4 GiB: too many vectors (" + std::to_string(geometry.size()) + ")";
  const ExportSplats made = splats_of(geometry, kFromRightUpBack);
  Attributes attributes(made.splats);
  if (!made.splats.empty()) add_all(made, attributes);
  return glb_file(document_of(attributes, geometry.description().origin, options)
                      .dump(-1, ' ', false, OrderedJson::error_handler_t::replace),
                  attributes.bytes);
}

Exported export_glb(const qnv::Geometry& geometry, const ExportOptions& options) {
  const auto* mesh = geometry.as<qnv::IndexedMesh>();
  return mesh && !mesh->triangles.empty() ? export_glb_mesh(*mesh, options) : export_glb_splats(geometry, options);
}

Exported glb_file(std::string text, std::span<const std::byte> binary) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::vector<std::byte> bytes;
  const std::size_t total = 12 + 8 + text.size() + (binary.empty() ? 0 : 8 + binary.size());
  if (total > std::numeric_limits<std::uint32_t>::max()) return "a GLB file holds no more than 4 GiB";
  bytes.reserve(total);
  for (const std::size_t word : {std::size_t{kGlbMagic}, std::size_t{2}, total, text.size(), std::size_t{kJsonChunk}})
    put_little(bytes, static_cast<std::uint32_t>(word));
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), first, first + text.size());
  if (!binary.empty()) {
    put_little(bytes, static_cast<std::uint32_t>(binary.size()));
    put_little(bytes, kBinaryChunk);
    bytes.insert(bytes.end(), binary.begin(), binary.end());
  }
  return bytes;
}

}  // namespace gs::app
