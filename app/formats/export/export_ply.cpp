#include "app/formats/common/byte_order.h"
#include "app/formats/export/export.h"
#include "app/formats/export/export_vectors.h"
#include "app/formats/splats/splats.h"

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {
namespace {

/// Appends text.
void put_text(std::vector<std::byte>& to, std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  to.insert(to.end(), first, first + text.size());
}

/// Returns the PLY type of coordinates. With an origin other than 0, float32 would lose precision, so the type is
/// double.
const char* place_type(const glm::dvec3& origin) { return origin != glm::dvec3(0) ? "double" : "float"; }

void put_header(std::vector<std::byte>& to, std::size_t count, const glm::dvec3& origin,
                const std::vector<std::string>& properties, std::size_t faces = 0, std::string_view comment = {}) {
  put_text(to, "ply\nformat binary_little_endian 1.0\ncomment GhostSpace\n" + std::string(comment) + "element vertex " +
                   std::to_string(count) + "\n");
  for (const char* axis : {" x", " y", " z"}) put_text(to, std::string("property ") + place_type(origin) + axis + "\n");
  for (const std::string& property : properties) put_text(to, "property " + property + "\n");
  if (faces > 0) put_text(to, "element face " + std::to_string(faces) + "\nproperty list uchar uint vertex_indices\n");
  put_text(to, "end_header\n");
}

void put_place(std::vector<std::byte>& to, const glm::dvec3& origin, const glm::vec3& position) {
  const bool wide = origin != glm::dvec3(0);
  for (int k = 0; k < 3; ++k) {
    if (wide)
      put_little(to, origin[k] + static_cast<double>(position[k]));
    else
      put_little(to, position[k]);
  }
}

void put_vector(std::vector<std::byte>& to, const glm::vec3& v) {
  put_little(to, v.x);
  put_little(to, v.y);
  put_little(to, v.z);
}

}  // namespace

Exported export_points_ply(const qnv::Geometry& geometry, const ExportOptions&) {
  const ExportVectors exported(geometry);
  const glm::dvec3& origin = geometry.description().origin;
  constexpr std::size_t kRowBytes = 43, kFaceBytes = 13, kHeaderRoom = 512;
  const auto* mesh = geometry.as<qnv::IndexedMesh>();
  const std::size_t faces = mesh ? mesh->triangles.size() / 3 : 0;
  std::vector<std::byte> bytes;
  bytes.reserve(kHeaderRoom + exported.size() * kRowBytes + faces * kFaceBytes);
  put_header(bytes, exported.size(), origin,
             {"float nx", "float ny", "float nz", "uchar red", "uchar green", "uchar blue", "float area"}, faces);
  for (std::size_t i = 0; i < exported.size(); ++i) {
    const ExportVector item = exported[i];
    put_place(bytes, origin, item.position);
    put_vector(bytes, item.normal);
    put_little(bytes, item.color.r);
    put_little(bytes, item.color.g);
    put_little(bytes, item.color.b);
    put_little(bytes, item.area);
  }
  for (std::size_t i = 0; i < 3 * faces; ++i) {
    if (i % 3 == 0) put_little(bytes, std::uint8_t{3});
    put_little(bytes, mesh->triangles[i]);
  }
  return bytes;
}

Exported export_splats_ply(const qnv::Geometry& geometry, const ExportOptions&) {
  const ExportSplats made = splats_of(geometry, kFromRightDownForward);
  const std::vector<ExportSplat>& splats = made.splats;
  const std::size_t per = qnv::harmonic_count(made.degree);
  const glm::dvec3 origin = geometry.description().origin * glm::dvec3(kFromRightDownForward);
  constexpr std::size_t kRowBytes = 80, kHeaderRoom = 2048;
  std::vector<std::byte> bytes;
  bytes.reserve(kHeaderRoom + splats.size() * (kRowBytes + 12 * per));
  std::vector<std::string> properties{"float nx",     "float ny",     "float nz",
                                      "float f_dc_0", "float f_dc_1", "float f_dc_2"};
  for (std::size_t k = 0; k < 3 * per; ++k) properties.push_back("float f_rest_" + std::to_string(k));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    properties.push_back(std::string("float ") + name);
  put_header(bytes, splats.size(), origin, properties, 0, made.antialiased ? "comment antialiased 1\n" : "");
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const ExportSplat& splat = splats[i];
    put_place(bytes, origin, splat.position);
    put_vector(bytes, splat.normal);
    put_vector(bytes, splat.dc);
    for (int channel = 0; channel < 3; ++channel)
      for (std::size_t k = 0; k < per; ++k) put_little(bytes, made.harmonics[i * per + k][channel]);
    put_little(bytes, std::log(splat.opacity / (1 - splat.opacity)));
    for (int k = 0; k < 3; ++k) put_little(bytes, std::log(splat.scale[k]));
    for (const float q : {splat.rotation.w, splat.rotation.x, splat.rotation.y, splat.rotation.z}) put_little(bytes, q);
  }
  return bytes;
}

Exported export_ply(const qnv::Geometry& geometry, const ExportOptions& options) {
  return geometry.as<qnv::Gaussians>() ? export_splats_ply(geometry, options) : export_points_ply(geometry, options);
}

}  // namespace gs::app
