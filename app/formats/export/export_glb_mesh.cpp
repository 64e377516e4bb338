#include "app/formats/export/export_glb_mesh.h"
#include "app/formats/common/byte_order.h"
#include "app/formats/gltf/glb.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

using OrderedJson = nlohmann::ordered_json;

// Constants of glTF 2.0, 5.1.3, 5.11.5, 5.26.
constexpr int kFloats = 5126, kUnsignedBytes = 5121, kIndices = 5125, kVertexBuffer = 34962, kIndexBuffer = 34963,
              kRepeat = 10497, kClamp = 33071;

/// Binary part of a GLB file, with its views and accessors.
struct MeshBuffer {
  std::vector<std::byte> bytes;
  OrderedJson views = OrderedJson::array(), accessors = OrderedJson::array();

  /// Adds a buffer view for the bytes that `put` appends. Pads the buffer to a multiple of four bytes. Returns the
  /// index of the view.
  template <class Put>
  std::size_t add_view(int target, const Put& put) {
    const std::size_t start = bytes.size();
    put();
    OrderedJson view = {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes.size() - start}};
    if (target != 0) view["target"] = target;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    views.push_back(std::move(view));
    return views.size() - 1;
  }
  template <class Put>
  std::size_t add(const char* type, int component, std::size_t count, const Put& put) {
    const std::size_t view = add_view(component == kIndices ? kIndexBuffer : kVertexBuffer, put);
    accessors.push_back({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
    return accessors.size() - 1;
  }
};

/// Converts display sRGB to linear light (IEC 61966-2-1). Viewers multiply the texture with the result.
std::uint8_t linear_byte(std::uint8_t display) {
  const float c = static_cast<float>(display) / 255.0f;
  const float linear = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
  return static_cast<std::uint8_t>(linear * 255 + 0.5f);
}

bool is_png(const std::vector<std::byte>& file) { return !file.empty() && file[0] == std::byte{0x89}; }

/// Builds a primitive. `pictured` selects the triangles with or without texture.
OrderedJson primitive_of(const qnv::IndexedMesh& mesh, bool pictured, MeshBuffer& buffer) {
  const std::size_t border = mesh.first_textured();
  const std::size_t first = pictured ? border : 0, end = pictured ? mesh.size() : border;
  std::vector<std::uint32_t> indices;
  for (const std::uint32_t v : mesh.triangles)
    if ((v >= border) == pictured) indices.push_back(v - static_cast<std::uint32_t>(first));
  if (indices.empty()) return {};
  const auto put_vectors = [&](const std::vector<glm::vec3>& vectors) {
    for (std::size_t v = first; v < end; ++v)
      for (int k = 0; k < 3; ++k) put_little(buffer.bytes, vectors[v][k]);
  };
  OrderedJson attributes;
  const std::size_t positions = buffer.add("VEC3", kFloats, end - first, [&] { put_vectors(mesh.positions); });
  Box box;
  for (std::size_t v = first; v < end; ++v) box.add(mesh.positions[v]);
  buffer.accessors[positions]["min"] = {box.lower.x, box.lower.y, box.lower.z};
  buffer.accessors[positions]["max"] = {box.upper.x, box.upper.y, box.upper.z};
  attributes["POSITION"] = positions;
  attributes["NORMAL"] = buffer.add("VEC3", kFloats, end - first, [&] { put_vectors(mesh.normals); });
  if (pictured) {
    attributes["TEXCOORD_0"] = buffer.add("VEC2", kFloats, end - first, [&] {
      for (const glm::vec2& at : mesh.texture_coordinates) {
        put_little(buffer.bytes, at.x);
        put_little(buffer.bytes, 1 - at.y);  // glTF counts texture rows from the top, VRML97 from the bottom
      }
    });
  } else if (!mesh.colors.empty()) {
    attributes["COLOR_0"] = buffer.add("VEC4", kUnsignedBytes, end - first, [&] {
      for (std::size_t v = first; v < end; ++v)
        for (const std::uint8_t c : {linear_byte(mesh.colors[v].r), linear_byte(mesh.colors[v].g),
                                     linear_byte(mesh.colors[v].b), std::uint8_t{255}})
          buffer.bytes.push_back(static_cast<std::byte>(c));
    });
    buffer.accessors.back()["normalized"] = true;
  }
  const std::size_t triangles = buffer.add("SCALAR", kIndices, indices.size(), [&] {
    for (const std::uint32_t i : indices) put_little(buffer.bytes, i);
  });
  return {{"attributes", std::move(attributes)}, {"indices", triangles}};
}

}  // namespace

Exported export_glb_mesh(const qnv::IndexedMesh& mesh, const ExportOptions& options) {
  constexpr std::size_t kVertexBytes = 12 + 12 + 8, kRoom = std::size_t{1} << 20;
  const std::size_t about =
      mesh.size() * kVertexBytes + mesh.triangles.size() * 4 + (mesh.picture ? mesh.picture->bytes.size() : 0) + kRoom;
  if (about > std::numeric_limits<std::uint32_t>::max())
    return "a GLB file holds no more than 4 GiB: too many triangles (" + std::to_string(mesh.triangles.size() / 3) +
           ")";
  MeshBuffer buffer;
  buffer.bytes.reserve(about);
  OrderedJson materials = OrderedJson::array(), primitives = OrderedJson::array(), document;
  document["asset"] = {{"version", "2.0"}, {"generator", "GhostSpace"}};
  document["scene"] = 0;
  document["scenes"] = {{{"nodes", {0}}}};
  OrderedJson node = {{"mesh", 0}};
  if (!options.title.empty()) node["name"] = options.title;
  const glm::dvec3& origin = mesh.description.origin;
  if (origin != glm::dvec3(0)) node["translation"] = {origin.x, origin.y, origin.z};
  document["nodes"] = {std::move(node)};
  for (const bool pictured : {false, true}) {
    OrderedJson primitive = primitive_of(mesh, pictured, buffer);
    if (primitive.is_null()) continue;
    OrderedJson surface = {{"metallicFactor", 0}, {"roughnessFactor", 1}};
    if (pictured && mesh.picture) {
      const std::vector<std::byte>& file = mesh.picture->bytes;
      const std::size_t view =
          buffer.add_view(0, [&] { buffer.bytes.insert(buffer.bytes.end(), file.begin(), file.end()); });
      document["images"] = {{{"bufferView", view}, {"mimeType", is_png(file) ? "image/png" : "image/jpeg"}}};
      document["samplers"] = {
          {{"wrapS", mesh.picture->repeat_s ? kRepeat : kClamp}, {"wrapT", mesh.picture->repeat_t ? kRepeat : kClamp}}};
      document["textures"] = {{{"sampler", 0}, {"source", 0}}};
      surface["baseColorTexture"] = {{"index", 0}};
    } else if (mesh.colors.empty()) {
      const qnv::Rgb8& c = mesh.color;
      const auto part = [](std::uint8_t v) { return static_cast<float>(linear_byte(v)) / 255.0f; };
      surface["baseColorFactor"] = {part(c.r), part(c.g), part(c.b), 1};
    }
    OrderedJson material = {{"pbrMetallicRoughness", std::move(surface)}};
    if (mesh.description.two_sided) material["doubleSided"] = true;
    primitive["material"] = materials.size();
    materials.push_back(std::move(material));
    primitives.push_back(std::move(primitive));
  }
  if (primitives.empty()) return "no triangles to write";
  document["meshes"] = {{{"primitives", std::move(primitives)}}};
  document["materials"] = std::move(materials);
  document["buffers"] = {{{"byteLength", buffer.bytes.size()}}};
  document["bufferViews"] = std::move(buffer.views);
  document["accessors"] = std::move(buffer.accessors);
  return glb_file(document.dump(-1, ' ', false, OrderedJson::error_handler_t::replace), buffer.bytes);
}

}  // namespace gs::app
